// Planar Voronoi diagrams clipped by regions: known values, definitions, slow references, degenerate sites.
#include "voroform/voronoi/planar.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/planar.hpp"
#include "support/planar_checks.hpp"
#include "voroform/core/error.hpp"

namespace voroform::voronoi {
namespace {

using mesh::PlanarRegion;
using testing::clipSites;
using ::testing::ElementsAre;
using testing::expectPartition;
using testing::PlanarResult;
using testing::Rings;

constexpr double kRounding = 1e-12;

double energyOf(const PlanarResult& result) {
  double sum = 0;
  for (const auto& cell : result.moments) sum += cell.second;
  return sum;
}

// Sites of a square lattice with the spacing, n × n of them around the origin.
std::vector<Vec2> squareLattice(int n, double spacing) {
  std::vector<Vec2> sites;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) sites.push_back(spacing * (Vec2(i, j) - Vec2::Constant(0.5 * (n - 1))));
  }
  return sites;
}

TEST(PlanarDiagram, VerticesAreCentersOfEmptyCircles) {
  auto sites = testing::sitesInBox(300, 1, Box2(Vec2(-1, -1), Vec2(1, 1)));
  // Pairs so close that triangles over them are too flat for floating point.
  for (std::size_t i = 0; i < 300; i += 10) sites.push_back(sites[i] + Vec2(1e-10, 0.7e-10));
  const PlanarDiagram diagram = buildPlanarDiagram(sites, Box2(Vec2(-1, -1), Vec2(1, 1)), {});
  const auto at = [&](Index site) -> const Vec2& { return diagram.sites[static_cast<std::size_t>(site)]; };
  for (std::size_t v = 0; v < diagram.vertices.size(); ++v) {
    const Vec2& center = diagram.vertices[v];
    const auto& [a, b, c] = diagram.vertexSites[v];
    EXPECT_GT(testing::cross(at(b) - at(a), at(c) - at(a)), 0);
    const double radius = (at(a) - center).norm();
    EXPECT_NEAR((at(b) - center).norm(), radius, 1e-9 * radius);
    EXPECT_NEAR((at(c) - center).norm(), radius, 1e-9 * radius);
    for (const Vec2& site : diagram.sites) EXPECT_GE((site - center).norm(), radius * (1 - 1e-9));
  }
}

TEST(PlanarDiagram, RowsAreConvexPolygonsAroundTheirSites) {
  const auto sites = testing::sitesInBox(300, 2, Box2(Vec2(-1, -1), Vec2(1, 1)));
  const PlanarDiagram diagram = buildPlanarDiagram(sites, Box2(Vec2(-1, -1), Vec2(1, 1)), {});
  ASSERT_EQ(diagram.siteCount, 300);
  for (Index site = 0; site < diagram.siteCount; ++site) {
    const auto edges = diagram.edgesOf(site);
    ASSERT_GE(edges.size(), 3U);
    for (std::size_t k = 0; k < edges.size(); ++k) {
      const auto vertexAt = [&](std::size_t edge, bool last) {
        const auto e = static_cast<std::size_t>(edges[edge % edges.size()]);
        EXPECT_TRUE(diagram.edgeSites[e][0] == site || diagram.edgeSites[e][1] == site);
        EXPECT_LT(diagram.edgeSites[e][0], diagram.edgeSites[e][1]);
        return diagram.edgeVertices[e][(diagram.edgeSites[e][0] == site) == last ? 1 : 0];
      };
      EXPECT_EQ(vertexAt(k, true), vertexAt(k + 1, false));
      const Vec2& from = diagram.vertices[static_cast<std::size_t>(vertexAt(k, false))];
      const Vec2& to = diagram.vertices[static_cast<std::size_t>(vertexAt(k, true))];
      const Vec2& center = diagram.sites[static_cast<std::size_t>(site)];
      EXPECT_GT(testing::cross(from - center, to - center), 0);
    }
  }
  for (std::size_t v = 0; v < diagram.vertices.size(); ++v) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index edge = diagram.vertexEdges[v][k];
      if (edge == kNone) continue;
      const auto& ends = diagram.edgeVertices[static_cast<std::size_t>(edge)];
      EXPECT_TRUE(ends[0] == static_cast<Index>(v) || ends[1] == static_cast<Index>(v));
      for (const Index site : diagram.edgeSites[static_cast<std::size_t>(edge)]) {
        EXPECT_NE(site, diagram.vertexSites[v][k]);
      }
    }
  }
}

TEST(PlanarDiagram, RefusesBadSites) {
  const Box2 domain(Vec2(-1, -1), Vec2(1, 1));
  const auto messageOf = [&](const std::vector<Vec2>& sites) -> std::string {
    try {
      buildPlanarDiagram(sites, domain, {});
    } catch (const MethodError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(messageOf({}), "a Voronoi diagram needs at least one site");
  EXPECT_EQ(messageOf({{0, 0}, {1, 0}, {0.5, 0}, {1, 0}, {0, 1}}), "two sites coincide (1 and 3)");
  EXPECT_EQ(messageOf({{0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0}}), "site 1 is not finite or too far away");
  EXPECT_EQ(messageOf({{0, std::numeric_limits<double>::infinity()}}), "site 0 is not finite or too far away");
  EXPECT_EQ(messageOf({{0, 0}, {1e-300, 0}, {5e60, 1}}), "");
}

TEST(PlanarClip, RefusesARegionBeyondTheDomain) {
  const PlanarDiagram diagram = buildPlanarDiagram(std::vector<Vec2>{{0, 0}}, Box2(Vec2(-1, -1), Vec2(1, 1)), {});
  EXPECT_THROW(clipPlanar(diagram, mesh::squareRegion(), {}), MethodError);
}

TEST(PlanarMoments, OneSiteHasTheSquaresEnergy) {
  const PlanarRegion square = mesh::squareRegion();
  for (const Vec2& site : {Vec2(0, 0), Vec2(3, -2), Vec2(10, 10), Vec2(40, 7)}) {
    const PlanarResult result = clipSites({site}, square);
    const double energy = 400 * (400 + 400) / 12.0 + 400 * site.squaredNorm();
    EXPECT_NEAR(result.moments[0].mass, 400, 400 * kRounding);
    EXPECT_NEAR(result.moments[0].second, energy, energy * kRounding);
    EXPECT_LE((result.moments[0].first + 400 * site).norm(), 400 * 50 * kRounding);
    ASSERT_EQ(result.tessellation.loopCount(), 1U);
    EXPECT_EQ(result.tessellation.loop(0).size(), 4U);
    expectPartition(result, square, kRounding);
  }
}

TEST(PlanarMoments, CellsOfAHexagonalLatticeHaveTheBestRegularity) {
  std::vector<Vec2> sites;
  for (int j = -12; j <= 12; ++j) {
    for (int i = -12; i <= 12; ++i) sites.emplace_back(i + 0.5 * (j & 1), std::sqrt(3.0) / 2 * j);
  }
  const PlanarRegion square = mesh::squareRegion();
  const PlanarResult result = clipSites(sites, square);
  expectPartition(result, square, kRounding);
  const double regularity = 5 / (36 * std::sqrt(3.0));
  int interior = 0;
  for (Index site = 0; site < result.diagram.siteCount; ++site) {
    if (result.clip.touchesBoundary(site)) continue;
    const auto& cell = result.moments[static_cast<std::size_t>(site)];
    if (cell.mass == 0) continue;
    ++interior;
    EXPECT_NEAR(cell.second / (2 * cell.mass * cell.mass), regularity, kRounding);
    EXPECT_NEAR(cell.mass, std::sqrt(3.0) / 2, kRounding);
  }
  EXPECT_GT(interior, 350);
}

TEST(PlanarMoments, GradientAgreesWithDifferences) {
  const PlanarRegion region(testing::jaggedRings(7));
  ASSERT_GT(region.ringCount(), 2U);
  std::vector<Vec2> sites = testing::sitesInside(region, 40, 1);
  const PlanarResult result = clipSites(sites, region);
  const double step = 1e-5;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const double before = sites[i][axis];
      sites[i][axis] = before + step;
      const double above = energyOf(clipSites(sites, region));
      sites[i][axis] = before - step;
      const double below = energyOf(clipSites(sites, region));
      sites[i][axis] = before;
      // Differences lose 16 − 5 digits of the energy, about 100; their own error is of the order of step².
      EXPECT_NEAR((above - below) / (2 * step), -2 * result.moments[i].first[axis], 1e-7);
    }
  }
}

TEST(PlanarTessellation, SplitsACellThatTheRegionDivides) {
  // A U: the middle site's cell holds a piece of either arm, the lower sites the rest.
  const PlanarRegion region(Rings{{{-3, 0}, {3, 0}, {3, 8}, {1, 8}, {1, 2}, {-1, 2}, {-1, 8}, {-3, 8}}});
  const PlanarResult result = clipSites({{0, 6}, {0, 1}}, region);
  expectPartition(result, region, kRounding);
  EXPECT_EQ(result.tessellation.endLoop(0) - result.tessellation.firstLoop(0), 2U);
  EXPECT_NEAR(result.moments[0].mass, 2 * 2 * 4.5, kRounding);
  EXPECT_EQ(result.tessellation.endLoop(1) - result.tessellation.firstLoop(1), 1U);
  EXPECT_THAT(neighborPairs(result.diagram, result.clip), ElementsAre(std::array<Index, 2>{0, 1}));
}

TEST(PlanarTessellation, KeepsHolesAsClockwiseLoops) {
  const PlanarRegion region(
      Rings{{{-9, -9}, {9, -9}, {9, 9}, {-9, 9}}, {{1, 1}, {2, 1}, {1, 2}}, {{-2, -2}, {-1, -2}, {-2, -1}}});
  const PlanarResult result = clipSites({{0, 0}}, region);
  expectPartition(result, region, kRounding);
  ASSERT_EQ(result.tessellation.loopCount(), 3U);
  int clockwise = 0;
  for (std::size_t l = 0; l < 3; ++l) {
    std::vector<Vec2> loop;
    for (const Index v : result.tessellation.loop(l)) {
      loop.push_back(result.tessellation.vertices[static_cast<std::size_t>(v)]);
    }
    if (testing::signedArea(loop) < 0) ++clockwise;
  }
  EXPECT_EQ(clockwise, 2);
}

TEST(PlanarClip, LeavesSitesOutsideWithoutACell) {
  const PlanarRegion square = mesh::squareRegion();
  // Far beyond the nearer site, and beside the region with a part of it.
  const PlanarResult result = clipSites({{0, 0}, {100, 0}, {9, 0}, {0, 15}}, square);
  expectPartition(result, square, kRounding);
  EXPECT_EQ(result.moments[1].mass, 0);
  EXPECT_EQ(result.moments[1].second, 0);
  EXPECT_EQ(result.tessellation.firstLoop(1), result.tessellation.endLoop(1));
  EXPECT_FALSE(result.clip.touchesBoundary(1));
  EXPECT_GT(result.moments[3].mass, 1);
}

// The lattice's walls lie on the region's edges, its corners on the cells' corners, on walls and in cells.
TEST(PlanarClip, TakesWallsThatLieOnTheRegionsEdges) {
  const std::vector<Vec2> lattice = squareLattice(20, 1);  // walls at integers, ±10 included; all corners cocircular
  for (const Rings& rings : std::vector<Rings>{
           {{{-10, -10}, {10, -10}, {10, 10}, {-10, 10}}},
           // An L whose inner corner is a corner of four cells; the sites beyond it are without cells.
           {{{-10, -10}, {10, -10}, {10, 2}, {-3, 2}, {-3, 10}, {-10, 10}}},
           // A hole along walls, and one from corner to corner of cells.
           {{{-10, -10}, {10, -10}, {10, 10}, {-10, 10}}, {{-4, -4}, {-4, 3}, {3, 3}, {3, -4}}},
           {{{-10, -10}, {10, -10}, {10, 10}, {-10, 10}}, {{0, -5}, {-5, 0}, {0, 5}, {5, 0}}},
           // A slit along a wall, of no cell's width; teeth with their ends on walls, corners and sites.
           {{{-10, -10}, {10, -10}, {10, 10}, {-10, 10}}, {{-4, 0}, {-4.25, 0.25}, {4.25, 0.25}, {4, 0}}},
           {{{-10, -10}, {10, -10}, {10, 10}, {5, 0}, {4.5, 10}, {3.5, 0.5}, {2, 10}, {1.25, 3}, {-10, 10}}},
       }) {
    const PlanarRegion region(rings);
    const PlanarResult result = clipSites(lattice, region);
    expectPartition(result, region, kRounding);
    for (std::size_t i = 0; i < lattice.size(); ++i) {
      const Moments<2> reference = testing::referenceMoments(lattice, i, region);
      EXPECT_NEAR(result.moments[i].mass, reference.mass, 1e-10);
      EXPECT_NEAR(result.moments[i].second, reference.second, 1e-10);
    }
  }
  const PlanarResult result = clipSites(lattice, mesh::squareRegion());
  EXPECT_NEAR(energyOf(result), 400 / 6.0, 400 * kRounding);
}

// The same, turned, so that all coincidences hold up to rounding only.
TEST(PlanarClip, TakesWallsThatNearlyLieOnTheRegionsEdges) {
  const std::vector<Vec2> lattice = squareLattice(20, 1);
  const Rings rings = {{{-10, -10}, {10, -10}, {10, 2}, {-3, 2}, {-3, 10}, {-10, 10}},
                       {{0, -5}, {-5, 0}, {0, 0}, {5, 0}}};
  for (int turn = 0; turn < 60; ++turn) {
    const Eigen::Rotation2Dd rotation(0.1 + 0.7 * turn);
    const Vec2 shift = turn % 2 * Vec2(1000.0 / 3, -200.0 / 7);
    std::vector<Vec2> sites;
    for (const Vec2& site : lattice) sites.push_back(rotation * site + shift);
    Rings turned = rings;
    for (auto& ring : turned) {
      for (Vec2& point : ring) point = rotation * point + shift;
    }
    const PlanarRegion region(turned);
    const PlanarResult result = clipSites(sites, region);
    expectPartition(result, region, 1e-11);
    EXPECT_NEAR(energyOf(result), region.area() / 6, 0.2 * region.area());
  }
}

TEST(PlanarClip, TakesSitesOnALine) {
  const PlanarRegion square = mesh::squareRegion();
  for (const Vec2& direction : {Vec2(1, 0), Vec2(0, 1), Vec2(1, 1), Vec2(0.3, -0.7)}) {
    std::vector<Vec2> sites;
    for (int k = 0; k <= 20; ++k) sites.push_back((k - 10) * direction);
    const PlanarResult result = clipSites(sites, square);
    expectPartition(result, square, kRounding);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      EXPECT_NEAR(result.moments[i].mass, testing::referenceMoments(sites, i, square).mass, 1e-10);
    }
  }
  const PlanarResult columns = clipSites({{-5, 0}, {5, 0}, {0, 0}}, square);
  EXPECT_NEAR(columns.moments[2].mass, 5 * 20, 100 * kRounding);
}

TEST(PlanarClip, TakesSitesOnOneCircleAndInOnePlace) {
  const PlanarRegion star = mesh::starRegion();
  std::vector<Vec2> circle;
  for (int k = 0; k < 60; ++k) {
    circle.emplace_back(std::cos(std::numbers::pi / 30 * k), std::sin(std::numbers::pi / 30 * k));
  }
  expectPartition(clipSites(circle, star), star, kRounding);
  // All sites in one small corner, a millionth of the region.
  expectPartition(clipSites(testing::sitesInBox(500, 4, Box2(Vec2(1, 1), Vec2(1, 1) + Vec2::Constant(1e-5))), star),
                  star, 1e-9);
  // Sites on the region's corners and on its edges.
  std::vector<Vec2> corners(star.points().begin(), star.points().end());
  for (std::size_t k = 0; k < 10; ++k) {
    corners.push_back(0.5 * (star.points()[k] + star.points()[static_cast<std::size_t>(star.next(k))]));
  }
  expectPartition(clipSites(corners, star), star, kRounding);
}

TEST(PlanarClip, GivesTheSameBitsForAnyNumberOfThreads) {
  const PlanarRegion star = mesh::starRegion();
  const auto sites = testing::sitesInside(star, 5000, 9);
  RunContext one;
  one.threads = 1;
  RunContext four;
  four.threads = 4;
  const PlanarResult a = clipSites(sites, star, one);
  const PlanarResult b = clipSites(sites, star, four);
  EXPECT_EQ(a.tessellation.loopVertices, b.tessellation.loopVertices);
  EXPECT_EQ(a.tessellation.vertices, b.tessellation.vertices);
  for (std::size_t i = 0; i < sites.size(); ++i) EXPECT_EQ(a.moments[i].second, b.moments[i].second);
}

}  // namespace
}  // namespace voroform::voronoi
