// Random polygons with holes and random sites: the cells fill the region, agree with a slow reference, and move with
// it.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/planar.hpp"
#include "support/planar_checks.hpp"

namespace voroform::voronoi {
namespace {

using mesh::PlanarRegion;
using testing::clipSites;
using testing::expectPartition;
using testing::PlanarResult;
using testing::Rings;

constexpr double kRounding = 1e-12;

// Sites in and around the region.
std::vector<Vec2> sitesAround(const PlanarRegion& region, std::size_t count, std::uint64_t seed) {
  const Vec2 margin = 0.2 * region.bounds().sizes();
  return testing::sitesInBox(count, seed, Box2(region.bounds().min() - margin, region.bounds().max() + margin));
}

template <class Map>
Rings mapped(Rings rings, const Map& map) {
  for (auto& ring : rings) {
    for (Vec2& point : ring) point = map(point);
  }
  return rings;
}

template <class Map>
std::vector<Vec2> mapped(std::vector<Vec2> points, const Map& map) {
  for (Vec2& point : points) point = map(point);
  return points;
}

TEST(PlanarProperty, CellsFillTheRegionAndAgreeWithTheReference) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const PlanarRegion region(testing::jaggedRings(seed));
    const std::size_t counts[] = {1, 3, 20, 100};
    const auto sites = sitesAround(region, counts[seed % 4], seed + 1000);
    const PlanarResult result = clipSites(sites, region);
    expectPartition(result, region, kRounding);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const Moments<2> reference = testing::referenceMoments(sites, i, region);
      EXPECT_NEAR(result.moments[i].mass, reference.mass, 1e-10) << seed << " " << i;
      EXPECT_LE((result.moments[i].first - reference.first).norm(), 1e-9) << seed << " " << i;
      EXPECT_NEAR(result.moments[i].second, reference.second, 1e-8) << seed << " " << i;
    }
  }
}

TEST(PlanarProperty, ManyCellsFillARegionOfManyEdges) {
  testing::Draws draws(5);
  const PlanarRegion region(Rings{testing::jaggedRing({0, 0}, 1, 7, 3000, draws)});
  for (const std::size_t count : {10, 1000, 20000}) {
    expectPartition(clipSites(sitesAround(region, count, count), region), region, 1e-11);
  }
}

// Powers of two scale without rounding: the same cells with the same bits. From 2⁻⁶⁰ to 2⁶⁰.
TEST(PlanarProperty, ScalingByAPowerOfTwoChangesNothing) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const Rings rings = testing::jaggedRings(seed);
    const PlanarRegion region(rings);
    const auto sites = sitesAround(region, 200, seed);
    const PlanarResult result = clipSites(sites, region);
    for (const double scale : {std::ldexp(1.0, -60), std::ldexp(1.0, -7), std::ldexp(1.0, 60)}) {
      const auto scaled = [&](const Vec2& p) { return Vec2(scale * p); };
      const PlanarRegion other(mapped(rings, scaled));
      const PlanarResult copy = clipSites(mapped(sites, scaled), other);
      EXPECT_EQ(copy.tessellation.loopVertices, result.tessellation.loopVertices);
      EXPECT_EQ(copy.tessellation.loopOffsets, result.tessellation.loopOffsets);
      EXPECT_EQ(copy.tessellation.neighbors, result.tessellation.neighbors);
      EXPECT_EQ(copy.clip.inside, result.clip.inside);
      for (std::size_t i = 0; i < sites.size(); ++i) {
        EXPECT_NEAR(copy.moments[i].mass / (scale * scale), result.moments[i].mass, kRounding);
      }
    }
  }
}

TEST(PlanarProperty, CellsMoveWithTheRegion) {
  testing::Draws draws(77);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Rings rings = testing::jaggedRings(seed);
    const PlanarRegion region(rings);
    const auto sites = sitesAround(region, 100, seed);
    const PlanarResult result = clipSites(sites, region);
    const Eigen::Rotation2Dd rotation(2 * std::numbers::pi * draws.next());
    const Vec2 shift = draws.inBox(Box2(Vec2(-100, -100), Vec2(100, 100)));
    const auto move = [&](const Vec2& p) { return Vec2(rotation * p + shift); };
    const PlanarRegion moved(mapped(rings, move));
    const PlanarResult other = clipSites(mapped(sites, move), moved);
    expectPartition(other, moved, 1e-11);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      EXPECT_NEAR(other.moments[i].mass, result.moments[i].mass, 1e-10);
      EXPECT_LE((other.moments[i].first - rotation * result.moments[i].first).norm(), 1e-9);
      EXPECT_NEAR(other.moments[i].second, result.moments[i].second, 1e-8);
      EXPECT_EQ(other.clip.touchesBoundary(static_cast<Index>(i)), result.clip.touchesBoundary(static_cast<Index>(i)));
    }
  }
}

// Sites and regions on a coarse grid: every coincidence happens by chance.
TEST(PlanarProperty, CoincidencesOnAGridAreHarmless) {
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    testing::Draws draws(seed + 5000);
    const auto onGrid = [](const Vec2& p) { return Vec2(2 * p.array().round() / 2); };
    Rings rings = {mapped(testing::jaggedRing({0, 0}, 5, 12, 8 + static_cast<int>(6 * draws.next()), draws), onGrid)};
    if (draws.next() < 0.5) rings.push_back(mapped(testing::jaggedRing({0, 0}, 1.5, 3.5, 6, draws), onGrid));
    if (mesh::findFault(rings)) continue;
    const PlanarRegion region(rings);
    std::vector<Vec2> sites;
    for (int y = -12; y <= 12; ++y) {
      for (int x = -12; x <= 12; ++x) {
        if (draws.next() < 0.4) sites.emplace_back(x, y);
      }
    }
    const PlanarResult result = clipSites(sites, region);
    expectPartition(result, region, kRounding);
    for (std::size_t i = 0; i < sites.size(); i += 7) {
      EXPECT_NEAR(result.moments[i].mass, testing::referenceMoments(sites, i, region).mass, 1e-10);
    }
  }
}

}  // namespace
}  // namespace voroform::voronoi
