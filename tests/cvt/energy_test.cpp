// The CVT energy and its gradient against independent integration and differences.
#include "voroform/cvt/energy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "support/half_space_cell.hpp"
#include "support/voronoi_sites.hpp"
#include "voroform/core/error.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::cvt {
namespace {

constexpr voronoi::ClipOptions kExact = {.rootTolerance = 1e-13};

TEST(OptimalEnergy, IsThatOfTruncatedOctahedra) {
  // ∫‖x − center‖² dx of one truncated octahedron is 3·G₃·V^(5/3), by the definition of G₃.
  const double regularity = 19 / (192 * std::cbrt(2.0));
  EXPECT_NEAR(optimalEnergy<3>(1, 1), 3 * regularity, 1e-15);
  EXPECT_NEAR(optimalEnergy<3>(1000, 8), 1000 * 3 * regularity * std::pow(8.0 / 1000, 5.0 / 3), 1e-15);
  // Units⁵, and n^(−2/3) for one volume.
  EXPECT_NEAR(optimalEnergy<3>(50, 3 * 8), 32 * optimalEnergy<3>(50, 3), 1e-12);
  EXPECT_NEAR(optimalEnergy<3>(8 * 50, 3), optimalEnergy<3>(50, 3) / 4, 1e-13);
}

TEST(Energy, OfALatticeIsThatOfItsCubes) {
  // A cube of edge s has ∫‖x − center‖² dx = s⁵/4. All caps are flat, but those at the box's edges cut off a piece.
  const int n = 8;
  const auto sites = testing::latticeSites(n, 0, 0);
  const auto form = implicit::box(Vec3::Constant(n));
  const Evaluation evaluation = evaluateEnergy(sites, *form, kExact, {});
  int whole = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Eigen::Array3d beyond = sites[i].array().abs() - 0.5 * (n - 1) + 0.5;
    const auto sides = (beyond > 0.25).count();
    if (sides > 1) continue;
    ++whole;
    EXPECT_NEAR(evaluation.moments[i].mass, 1, 1e-10);
    EXPECT_NEAR(evaluation.moments[i].second, 0.25, 1e-10);
    EXPECT_LT(evaluation.moments[i].first.norm(), 1e-10);
  }
  EXPECT_EQ(whole, 6 * 6 * 6 + 6 * 6 * 6);
  EXPECT_EQ(evaluation.emptyCells, 0);
}

TEST(Energy, AgreesWithSampling) {
  const auto form = implicit::sphere(1);
  const auto sites = testing::sitesInside(*form, 3000, 1);
  // Quasi-random quadrature of min‖x − xᵢ‖² over the ball.
  constexpr std::uint64_t kSamples = 40000;
  double volume = 0;
  double energy = 0;
  for (std::uint64_t k = 0; k < kSamples; ++k) {
    const Vec3 p = quasiRandomInBox(1, k, form->bounds());
    if (form->value(p) >= 0) continue;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& site : sites) nearest = std::min(nearest, (site - p).squaredNorm());
    volume += 1;
    energy += nearest;
  }
  const double weight = form->bounds().volume() / kSamples;
  const Evaluation evaluation = evaluateEnergy(sites, *form, kExact, {});
  // Flat caps are inscribed, so both are a little less.
  EXPECT_LT(evaluation.volume, volume * weight);
  EXPECT_NEAR(evaluation.volume, volume * weight, 0.03 * volume * weight);
  EXPECT_LT(evaluation.energy, energy * weight);
  EXPECT_NEAR(evaluation.energy, energy * weight, 0.05 * energy * weight);
}

TEST(Energy, OfABoxsCellsAgreesWithHalfSpaceClipping) {
  const auto form = implicit::box(Vec3(2, 2, 2));
  const Box3 box(Vec3::Constant(-1), Vec3::Constant(1));
  const auto sites = testing::sitesInBox(300, 2, box);
  const Evaluation evaluation = evaluateEnergy(sites, *form, kExact, {});
  int compared = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const testing::HalfSpaceCell cell = testing::referenceCell(sites, i, box);
    if (cell.boxFaces() > 1) continue;
    ++compared;
    const testing::ReferenceMoments expected = cell.moments();
    const Vec3 offset = expected.centroid - sites[i];
    const double second = expected.secondMoment + expected.volume * offset.squaredNorm();
    EXPECT_NEAR(evaluation.moments[i].mass, expected.volume, 1e-9 * expected.volume);
    EXPECT_LT((evaluation.moments[i].first - expected.volume * offset).norm(),
              1e-9 * expected.volume * std::cbrt(expected.volume));
    EXPECT_NEAR(evaluation.moments[i].second, second, 1e-9 * second);
  }
  EXPECT_GT(compared, 150);
  double energy = 0;
  double volume = 0;
  double squaredMoves = 0;
  for (const auto& site : evaluation.moments) {
    energy += site.second;
    volume += site.mass;
    squaredMoves += (site.first / site.mass).squaredNorm();
  }
  EXPECT_NEAR(evaluation.energy, energy, 1e-12 * energy);
  EXPECT_NEAR(evaluation.volume, volume, 1e-12 * volume);
  EXPECT_NEAR(evaluation.rmsMove, std::sqrt(squaredMoves / 300) / std::cbrt(volume / 300), 1e-12);
}

// Central differences of E by the coordinates of one site.
Vec3 energyDifferences(std::vector<Vec3> sites, std::size_t i, double step, const implicit::ImplicitFunction& f) {
  Vec3 result;
  const Vec3 place = sites[i];
  for (Index axis = 0; axis < 3; ++axis) {
    double energies[2];
    for (const int side : {0, 1}) {
      sites[i] = place + (side == 0 ? -step : step) * Vec3::Unit(axis);
      energies[side] = evaluateEnergy(sites, f, kExact, {}).energy;
    }
    result[axis] = (energies[1] - energies[0]) / (2 * step);
  }
  return result;
}

// The gradient's error at the first sites, in units of 2mh: of interior ones and of ones whose cell has a cap.
struct GradientErrors {
  double interior = 0;  // largest
  double boundary = 0;  // root mean square
  int interiorCount = 0;
  int boundaryCount = 0;
};

GradientErrors gradientErrors(const std::vector<Vec3>& sites, const implicit::ImplicitFunction& f, std::size_t count) {
  const Evaluation evaluation = evaluateEnergy(sites, f, kExact, {});
  const voronoi::Diagram diagram = voronoi::buildDiagram(sites, siteDomain(f), {});
  const auto clipped = voronoi::clip(diagram, f, kExact, {});
  // A site's energy also lies in its neighbors' cells: interior means that no neighbor has a cap, either.
  std::vector<bool> capped(sites.size(), false);
  for (const Index site : clipped.loopSites) capped[static_cast<std::size_t>(site)] = true;
  GradientErrors errors;
  for (std::size_t i = 0; i < count; ++i) {
    bool interior = !capped[i];
    for (const Index facet : diagram.facetsOf(static_cast<Index>(i))) {
      const auto [a, b] = diagram.facetSites[static_cast<std::size_t>(facet)];
      const auto other = static_cast<std::size_t>(a == static_cast<Index>(i) ? b : a);
      if (other < sites.size() && capped[other]) interior = false;
    }
    if (!interior && !capped[i]) continue;
    const voronoi::SiteMoments& site = evaluation.moments[i];
    const double spacing = std::cbrt(site.mass);
    const Vec3 gradient = -2 * site.first;
    const double error = (gradient - energyDifferences(sites, i, 1e-4 * spacing, f)).norm() / (2 * site.mass * spacing);
    if (interior) {
      errors.interior = std::max(errors.interior, error);
      ++errors.interiorCount;
    } else {
      errors.boundary += error * error;
      ++errors.boundaryCount;
    }
  }
  errors.boundary = std::sqrt(errors.boundary / errors.boundaryCount);
  return errors;
}

TEST(EnergyGradient, IsExactAwayFromTheBoundaryAndCloseAtIt) {
  const auto form = implicit::sphere(1);
  const auto sites = testing::relaxed(testing::sitesInside(*form, 600, 3), *form, 10);
  const GradientErrors errors = gradientErrors(sites, *form, 150);
  EXPECT_GT(errors.interiorCount, 20);
  EXPECT_LT(errors.interior, 1e-7);
  EXPECT_GT(errors.boundaryCount, 40);
  // The cap term is left out: 1.3 % here, less with more sites.
  EXPECT_LT(errors.boundary, 0.02);
  EXPECT_GT(errors.boundary, 1e-4);
}

TEST(EnergyGradient, IsExactAtAPlanarBoundary) {
  // Caps in a plane are exact whatever the sites do; sites near the box's edges are left out.
  const auto form = implicit::box(Vec3(2, 2, 2));
  const Box3 box(Vec3::Constant(-1), Vec3::Constant(1));
  const auto sites = testing::relaxed(testing::sitesInBox(700, 4, box), *form, 2);
  const Evaluation evaluation = evaluateEnergy(sites, *form, kExact, {});
  int compared = 0;
  for (std::size_t i = 0; i < sites.size() && compared < 15; ++i) {
    Vec3 sorted = sites[i].cwiseAbs();
    std::sort(sorted.data(), sorted.data() + 3);
    if (sorted[2] < 0.85 || sorted[1] > 0.35) continue;
    ++compared;
    const voronoi::SiteMoments& site = evaluation.moments[i];
    const double spacing = std::cbrt(site.mass);
    const Vec3 differences = energyDifferences(sites, i, 1e-4 * spacing, *form);
    EXPECT_LT((-2 * site.first - differences).norm(), 1e-6 * 2 * site.mass * spacing) << "site " << i;
  }
  EXPECT_EQ(compared, 15);
}

TEST(Energy, RejectsSitesOutsideItsDomain) {
  const auto form = implicit::sphere(1);
  const Box3 domain = siteDomain(*form);
  EXPECT_TRUE(domain.contains(form->bounds()));
  auto sites = testing::sitesInside(*form, 20, 5);
  sites[3] = domain.max() * 1.01;
  EXPECT_THROW(evaluateEnergy(sites, *form, {}, {}), MethodError);
  sites[3] = sites[4];
  EXPECT_THROW(evaluateEnergy(sites, *form, {}, {}), MethodError);
}

}  // namespace
}  // namespace voroform::cvt
