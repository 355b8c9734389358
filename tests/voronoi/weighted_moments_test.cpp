// Moments weighted by a density against closed forms and against those for ρ = 1.
#include "voroform/voronoi/weighted_moments.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include "support/voronoi_sites.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/planar_region.hpp"

namespace voroform::voronoi {
namespace {

// x₀^a·x₁^b·x₂^c as a density.
template <int M>
DensityValues<M> monomial(std::array<int, 3> powers) {
  return [powers](std::span<const Vec<M>> points, std::span<double> out) {
    for (std::size_t k = 0; k < points.size(); ++k) {
      out[k] = 1;
      for (int axis = 0; axis < M; ++axis) out[k] *= std::pow(points[k][axis], powers[static_cast<std::size_t>(axis)]);
    }
  };
}

// ∫ of the monomial over the box.
template <int M>
double boxIntegral(std::array<int, 3> powers, const Box<M>& box) {
  double result = 1;
  for (int axis = 0; axis < M; ++axis) {
    const int power = powers[static_cast<std::size_t>(axis)] + 1;
    result *= (std::pow(box.max()[axis], power) - std::pow(box.min()[axis], power)) / power;
  }
  return result;
}

// Mass, first and second moment of the box about the site, by the binomial formula on ‖x − s‖².
template <int M>
Moments<M> boxMoments(const std::array<int, 3>& powers, const Box<M>& box, const Vec<M>& site) {
  Moments<M> result;
  result.mass = boxIntegral(powers, box);
  for (int axis = 0; axis < M; ++axis) {
    std::array<int, 3> once = powers;
    std::array<int, 3> twice = powers;
    once[static_cast<std::size_t>(axis)] += 1;
    twice[static_cast<std::size_t>(axis)] += 2;
    const double first = boxIntegral(once, box);
    result.first[axis] = first - site[axis] * result.mass;
    result.second += boxIntegral(twice, box) - 2 * site[axis] * first + site[axis] * site[axis] * result.mass;
  }
  return result;
}

// Sums over all cells about one common point.
template <int M>
Moments<M> total(const std::vector<Moments<M>>& moments, const std::vector<Vec<M>>& sites) {
  Moments<M> sum;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Moments<M>& cell = moments[i];
    sum.mass += cell.mass;
    sum.first += cell.first + cell.mass * sites[i];
    sum.second += cell.second + 2 * sites[i].dot(cell.first) + cell.mass * sites[i].squaredNorm();
  }
  return sum;
}

template <int M>
void expectNear(const Moments<M>& actual, const Moments<M>& expected, double tolerance) {
  EXPECT_NEAR(actual.mass, expected.mass, tolerance);
  EXPECT_LT((actual.first - expected.first).norm(), tolerance);
  EXPECT_NEAR(actual.second, expected.second, tolerance);
}

// All monomials of the degree in M variables.
template <int M>
std::vector<std::array<int, 3>> monomialsOfDegree(int degree) {
  std::vector<std::array<int, 3>> result;
  for (int a = 0; a <= degree; ++a) {
    for (int b = 0; a + b <= degree; ++b) {
      const int c = degree - a - b;
      if (M == 3 || c == 0) result.push_back({a, b, c});
    }
  }
  return result;
}

struct SpatialCells {
  std::vector<Vec3> sites;
  Diagram diagram;
  ClippedDiagram clipped;
};

SpatialCells cellsIn(const implicit::ImplicitFunction& f, std::vector<Vec3> sites) {
  SpatialCells cells{std::move(sites), {}, {}};
  cells.diagram = buildDiagram(cells.sites, testing::domainOf(f), {});
  cells.clipped = clip(cells.diagram, f, {.cap = CapKind::flat}, {});
  return cells;
}

TEST(WeightedMoments, OfCubesAreExactForDensitiesUpToTheirDegree) {
  // Away from the box's edges each cell of a lattice is a unit cube, cut or whole.
  const auto form = implicit::box(Vec3::Constant(4));
  const SpatialCells cells = cellsIn(*form, testing::latticeSites(4, 0, 0));
  for (int degree = 0; degree <= kQuadratureDegree<3> - 2; ++degree) {
    for (const auto& powers : monomialsOfDegree<3>(degree)) {
      const WeightedMoments<3> weighted = weightedMoments(cells.diagram, cells.clipped, monomial<3>(powers), {});
      int inner = 0;
      for (std::size_t i = 0; i < cells.sites.size(); ++i) {
        const Vec3& site = cells.sites[i];
        if (site.cwiseAbs().maxCoeff() > 1) continue;
        ++inner;
        const Box3 cube(site - Vec3::Constant(0.5), site + Vec3::Constant(0.5));
        expectNear(weighted.moments[i], boxMoments<3>(powers, cube, site), 1e-13);
        EXPECT_NEAR(weighted.volumes[i], 1, 1e-13);
      }
      EXPECT_EQ(inner, 8);
    }
  }
  // The degree is not understated: one more is not exact.
  const std::array<int, 3> beyond = {kQuadratureDegree<3> - 1, 0, 0};
  const WeightedMoments<3> weighted = weightedMoments(cells.diagram, cells.clipped, monomial<3>(beyond), {});
  double error = 0;
  for (std::size_t i = 0; i < cells.sites.size(); ++i) {
    const Vec3& site = cells.sites[i];
    if (site.cwiseAbs().maxCoeff() > 1) continue;
    const Box3 cube(site - Vec3::Constant(0.5), site + Vec3::Constant(0.5));
    error = std::max(error, std::abs(weighted.moments[i].second - boxMoments<3>(beyond, cube, site).second));
  }
  EXPECT_GT(error, 1e-9);
}

TEST(WeightedMoments, OfSpatialCellsAddUpToTheSolid) {
  const auto form = implicit::transformed(implicit::box(Vec3(2, 2, 2)), Mat3::Identity(), Vec3(0.3, -0.2, 0.1));
  // Flat caps cut off the box's edges: the sums are compared with unweighted ones of the same solid.
  const SpatialCells cells = cellsIn(*form, testing::sitesInside(*form, 300, 4));
  const auto plain = siteMoments(cells.diagram, cells.clipped, {});
  const Moments<3> sum = total<3>(plain, cells.sites);
  // With ρ = 1 + 2x the mass is the unweighted mass and first moment; with ρ = ‖x‖² it is the second moment.
  const auto linear = [](std::span<const Vec3> points, std::span<double> out) {
    for (std::size_t k = 0; k < points.size(); ++k) out[k] = 1 + 2 * points[k].x();
  };
  const auto quadratic = [](std::span<const Vec3> points, std::span<double> out) {
    for (std::size_t k = 0; k < points.size(); ++k) out[k] = points[k].squaredNorm();
  };
  const auto massOf = [&](const DensityValues<3>& density) {
    return total<3>(weightedMoments(cells.diagram, cells.clipped, density, {}).moments, cells.sites).mass;
  };
  EXPECT_NEAR(massOf(linear), sum.mass + 2 * sum.first.x(), 1e-12);
  EXPECT_NEAR(massOf(quadratic), sum.second, 1e-12);
}

TEST(WeightedMoments, AreTheUnweightedOnesForDensityOne) {
  const auto form = implicit::torus(1, 0.4);
  const SpatialCells cells = cellsIn(*form, testing::sitesInside(*form, 500, 2));
  const auto plain = siteMoments(cells.diagram, cells.clipped, {});
  const WeightedMoments<3> weighted = weightedMoments(cells.diagram, cells.clipped, monomial<3>({0, 0, 0}), {});
  ASSERT_EQ(weighted.moments.size(), plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    expectNear(weighted.moments[i], plain[i], 1e-14);
    EXPECT_NEAR(weighted.volumes[i], plain[i].mass, 1e-14);
  }
}

TEST(WeightedMoments, AreTheSameBitsForAnyNumberOfThreads) {
  const auto form = implicit::torus(1, 0.4);
  const SpatialCells cells = cellsIn(*form, testing::sitesInside(*form, 2000, 3));
  RunContext one;
  one.threads = 1;
  const auto a = weightedMoments(cells.diagram, cells.clipped, monomial<3>({2, 0, 1}), one);
  const auto b = weightedMoments(cells.diagram, cells.clipped, monomial<3>({2, 0, 1}), {});
  EXPECT_EQ(std::memcmp(a.moments.data(), b.moments.data(), a.moments.size() * sizeof(Moments<3>)), 0);
  EXPECT_EQ(a.volumes, b.volumes);
}

struct PlanarCells {
  std::vector<Vec2> sites;
  PlanarDiagram diagram;
  PlanarClip clip;
};

PlanarCells cellsIn(const mesh::PlanarRegion& region, std::size_t count) {
  PlanarCells cells;
  for (std::uint64_t i = 0; cells.sites.size() < count; ++i) {
    const Vec2 p = randomInBox(7, RandomStream::test, i, region.bounds());
    if (region.contains(p)) cells.sites.push_back(p);
  }
  cells.diagram = buildPlanarDiagram(cells.sites, region.bounds(), {});
  cells.clip = clipPlanar(cells.diagram, region, {});
  return cells;
}

TEST(WeightedPlanarMoments, AddUpToThoseOfTheRegionForDensitiesUpToTheirDegree) {
  // A square with a square hole: cells along the hole need not be convex.
  const std::vector<std::vector<Vec2>> rings = {{{-1, -1}, {2, -1}, {2, 2}, {-1, 2}}, {{0, 0}, {0, 1}, {1, 1}, {1, 0}}};
  const mesh::PlanarRegion region(rings);
  const PlanarCells cells = cellsIn(region, 60);
  const Box2 outer(Vec2(-1, -1), Vec2(2, 2));
  const Box2 hole(Vec2(0, 0), Vec2(1, 1));
  for (int degree = 0; degree <= kQuadratureDegree<2> - 2; ++degree) {
    for (const auto& powers : monomialsOfDegree<2>(degree)) {
      const WeightedMoments<2> weighted = weightedMoments(cells.diagram, cells.clip, monomial<2>(powers), {});
      const Moments<2> all = boxMoments<2>(powers, outer, Vec2::Zero());
      const Moments<2> less = boxMoments<2>(powers, hole, Vec2::Zero());
      expectNear(total<2>(weighted.moments, cells.sites),
                 {all.mass - less.mass, all.first - less.first, all.second - less.second}, 1e-12);
    }
  }
  const std::array<int, 3> beyond = {kQuadratureDegree<2> - 1, 0, 0};
  const WeightedMoments<2> weighted = weightedMoments(cells.diagram, cells.clip, monomial<2>(beyond), {});
  EXPECT_GT(
      std::abs(total<2>(weighted.moments, cells.sites).second - boxMoments<2>(beyond, outer, Vec2::Zero()).second +
               boxMoments<2>(beyond, hole, Vec2::Zero()).second),
      1e-9);
}

TEST(WeightedPlanarMoments, AreTheUnweightedOnesForDensityOne) {
  const mesh::PlanarRegion region = mesh::starRegion();
  const PlanarCells cells = cellsIn(region, 200);
  const auto plain = planarMoments(cells.diagram, cells.clip, {});
  const WeightedMoments<2> weighted = weightedMoments(cells.diagram, cells.clip, monomial<2>({0, 0, 0}), {});
  for (std::size_t i = 0; i < plain.size(); ++i) {
    expectNear(weighted.moments[i], plain[i], 1e-12);
    EXPECT_NEAR(weighted.volumes[i], plain[i].mass, 1e-12);
  }
}

}  // namespace
}  // namespace voroform::voronoi
