// Densities: their presets, the energy and sites weighted by them, and what they do to the cells.
#include "voroform/cvt/density.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/voronoi_sites.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/energy.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/optimize.hpp"
#include "voroform/cvt/planar_domain.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/planar_region.hpp"
#include "voroform/voronoi/planar.hpp"

namespace voroform::cvt {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

template <int M>
DensityPtr<M> densityOf(double (*size)(const Vec<M>&), double ratio) {
  return std::make_shared<const Density<M>>(size, ratio);
}

TEST(Density, GoesWithTheInversePowerOfCellSize) {
  const auto size2 = densityOf<2>([](const Vec2& p) { return p.x(); }, 4);
  EXPECT_DOUBLE_EQ(size2->value({2, 0}), 1.0 / 16);
  EXPECT_DOUBLE_EQ(size2->siteDensity({2, 0}), 1.0 / 4);
  const auto size3 = densityOf<3>([](const Vec3& p) { return p.x(); }, 4);
  EXPECT_DOUBLE_EQ(size3->value({2, 0, 0}), 1.0 / 32);
  EXPECT_DOUBLE_EQ(size3->siteDensity({2, 0, 0}), 1.0 / 8);
  // Clamped to the bounds.
  EXPECT_DOUBLE_EQ(size2->value({5, 0}), 1.0 / 256);
  EXPECT_DOUBLE_EQ(size3->value({0.5, 0, 0}), 1);
  EXPECT_DOUBLE_EQ(size3->value({5, 0, 0}), 1.0 / 1024);
}

TEST(Density, RefusesBadOptions) {
  const auto form = implicit::sphere(1);
  EXPECT_THROW(Density<3>([](const Vec3&) { return 1.0; }, 0.5), UsageError);
  EXPECT_THROW(boundaryDensity<3>([](const Vec3&) { return 1.0; }, 2, 0), UsageError);
  EXPECT_THAT(validate(DensityOptions{}), IsEmpty());
  EXPECT_THAT(validate(DensityOptions{DensityKind::boundary, 11, -1}),
              ElementsAre(HasSubstr("density-ratio is 11"), HasSubstr("density-width is -1")));
  EXPECT_THROW(makeDensity(*form, {DensityKind::boundary, 0.5, 0}, 0.1, {}), UsageError);
  EXPECT_THROW(makeDensity(mesh::squareRegion(), {DensityKind::curvature, 2, 0}, 0.1), UsageError);
  EXPECT_EQ(makeDensity(*form, {}, 0.1, {}), nullptr);
}

TEST(BoundaryDensity, FollowsTheDepthInABall) {
  const auto form = implicit::sphere(1);
  const double width = 0.5;
  const auto density = makeDensity(*form, {DensityKind::boundary, 3, width}, 1, {});
  // The nearest of the grid's points on S may lie beside the foot, by up to 0.7 of the spacing width/8; sizes change by
  // at most 6 a unit of depth.
  double sum = 0;
  for (std::uint64_t k = 0; k < 500; ++k) {
    const Vec3 p = 0.99 * randomInBox(1, RandomStream::test, k, form->bounds());
    const double t = std::clamp((1 - p.norm()) / width, 0.0, 1.0);
    const double error = density->relativeSize(p) - (1 + 2 * t * t * (3 - 2 * t));
    EXPECT_NEAR(error, 0, 0.12) << p.transpose();
    sum += std::abs(error);
  }
  EXPECT_LT(sum / 500, 0.02);
}

TEST(BoundaryDensity, TakesItsWidthFromTheCellSize) {
  const auto form = implicit::sphere(1);
  const auto automatic = makeDensity(*form, {DensityKind::boundary, 3, 0}, 0.1, {});
  const auto given = makeDensity(*form, {DensityKind::boundary, 3, kDefaultWidth * 0.1}, 5, {});
  for (const double x : {0.0, 0.6, 0.7, 0.8, 0.9}) {
    EXPECT_EQ(automatic->value({x, 0, 0}), given->value({x, 0, 0}));
  }
  EXPECT_LT(automatic->relativeSize({0.8, 0, 0}), 2.9);
}

TEST(BoundaryDensity, TakesAnyWidth) {
  // Grids as coarse as the bands would miss the forms, and one that is coarse for its length the plate.
  constexpr double kThickness = 0.02;
  const auto ball = implicit::sphere(1);
  const auto plate = implicit::box(Vec3(2, 2, kThickness));
  for (const double width : {2.0, 20.0, 1e6}) {
    const DensityOptions options{DensityKind::boundary, 3, width};
    const auto expectSize = [&](double size, double depth, double spacing) {
      const auto sizeAt = [&](double at) { return 1 + 2 * at * at / (width * width) * (3 - 2 * at / width); };
      EXPECT_GE(size, sizeAt(depth - spacing)) << width;
      EXPECT_LE(size, sizeAt(depth + spacing)) << width;
    };
    expectSize(makeDensity(*ball, options, 1, {})->relativeSize({0.1, 0, 0}), 0.9, 2.0 / kFewestIntervals);
    expectSize(makeDensity(*plate, options, 1, {})->relativeSize({0.1, 0.2, 0}), kThickness / 2, 2.0 / kMostIntervals);
  }
}

TEST(BoundaryDensity, OfARegionIsExact) {
  const mesh::PlanarRegion region = mesh::squareRegion();
  const auto density = makeDensity(region, {DensityKind::boundary, 2, 4}, 1);
  EXPECT_DOUBLE_EQ(density->relativeSize({10, 0}), 1);
  EXPECT_DOUBLE_EQ(density->relativeSize({8, 0}), 1.5);
  EXPECT_DOUBLE_EQ(density->relativeSize({0, 6}), 2);
  EXPECT_DOUBLE_EQ(density->relativeSize({0, 0}), 2);
}

TEST(CurvatureDensity, GivesBallsOneSizeAndEllipsoidsTheirCurvature) {
  const auto sphere = implicit::sphere(1);
  const auto ofSphere = makeDensity(*sphere, {DensityKind::curvature, 3, 0}, 0.1, {});
  for (const double x : {0.2, 0.5, 0.9}) EXPECT_NEAR(ofSphere->relativeSize({x, 0, 0}), 1, 0.02);
  // Cells larger than the form, too.
  EXPECT_NEAR(makeDensity(*sphere, {DensityKind::curvature, 3, 0}, 5, {})->relativeSize({0.5, 0, 0}), 1, 0.02);

  // An ellipsoid's pole of the semi-axis a has the curvatures a/b² and a/c².
  const Vec3 semiAxes(1, 0.7, 0.5);
  const auto ellipsoid = implicit::ellipsoid(semiAxes);
  const auto ofEllipsoid = makeDensity(*ellipsoid, {DensityKind::curvature, 5, 0}, 0.05, {});
  const auto curvatureAtPole = [&](int axis) {
    const double a = semiAxes[axis];
    const double b = semiAxes[(axis + 1) % 3];
    const double c = semiAxes[(axis + 2) % 3];
    return std::sqrt((std::pow(a / (b * b), 2) + std::pow(a / (c * c), 2)) / 2);
  };
  // Sizes go with κ^(−1/2).
  const double sizeY = ofEllipsoid->relativeSize({0, 0.69, 0});
  const double sizeZ = ofEllipsoid->relativeSize({0, 0, 0.49});
  EXPECT_NEAR(sizeZ / sizeY, std::sqrt(curvatureAtPole(1) / curvatureAtPole(2)), 0.05);
  // κ₀ is exceeded by 5 % of the surface: there, at the sharpest pole, cells are smallest.
  EXPECT_NEAR(ofEllipsoid->relativeSize({0.99, 0, 0}), 1, 0.05);
}

TEST(DensitySites, LieAsDenselyAsTheDomainWants) {
  // Cells twice as large on the right: sites there are four times as sparse.
  const mesh::PlanarRegion region = mesh::squareRegion();
  PlanarDomain domain(region);
  domain.setDensity(densityOf<2>([](const Vec2& p) { return p.x() < 0 ? 1.0 : 2.0; }, 2));
  const auto sites = randomSites<2>(domain, 20000, 3, {});
  const auto left = std::count_if(sites.begin(), sites.end(), [](const Vec2& p) { return p.x() < 0; });
  // Binomial with p = 0.8: σ = 57.
  EXPECT_NEAR(static_cast<double>(left), 16000, 5 * 57);
}

TEST(DensityEnergy, NoSiteMayLeaveTheDomainsBox) {
  const mesh::PlanarRegion region = mesh::squareRegion();
  const PlanarDomain plane(region);
  auto sites = randomSites<2>(plane, 20, 1, {});
  sites[7] = plane.siteBox().max() + Vec2(1, 0);
  EXPECT_THROW(plane.evaluate(sites, {}), MethodError);
  EXPECT_THROW(plane.evaluateGrown(sites, 0.1, {}), MethodError);
  EXPECT_THROW(plane.graph(sites, {}), MethodError);
}

double energyOf(const Domain<2>& domain, const std::vector<Vec2>& sites) { return domain.evaluate(sites, {}).energy; }

// Smooth, but its density is no polynomial.
double smoothSize(const Vec2& p) { return 1.5 + 0.02 * p.x(); }

TEST(DensityEnergy, HasAnExactGradientOnExactDomains) {
  const mesh::PlanarRegion region = mesh::starRegion();
  PlanarDomain domain(region);
  domain.setDensity(densityOf<2>(smoothSize, 3));
  auto sites = randomSites<2>(domain, 80, 5, {});
  const Evaluation<2> state = domain.evaluate(sites, {});
  constexpr double kStep = 1e-4;
  for (std::size_t i = 0; i < sites.size(); i += 7) {
    const Vec2 place = sites[i];
    for (int axis = 0; axis < 2; ++axis) {
      sites[i] = place + kStep * Vec2::Unit(axis);
      const double above = energyOf(domain, sites);
      sites[i] = place - kStep * Vec2::Unit(axis);
      const double below = energyOf(domain, sites);
      sites[i] = place;
      // The density changes by a few per cent within a cell: its terms above the second degree are lost in the
      // differences.
      EXPECT_NEAR((above - below) / (2 * kStep), -2 * state.moments[i].first[axis], 1e-5 * state.energy / 80);
    }
  }
}

TEST(DensityEnergy, OfDensityOneIsTheUniformOne) {
  const auto form = implicit::torus(1, 0.4);
  const auto sites = testing::sitesInside(*form, 600, 1);
  const auto one = densityOf<3>([](const Vec3&) { return 1.0; }, 1);
  const Evaluation<3> plain = evaluateEnergy(sites, *form, {}, {});
  const Evaluation<3> weighted = evaluateEnergy(sites, *form, {}, {}, one.get());
  EXPECT_NEAR(weighted.energy, plain.energy, 1e-12 * plain.energy);
  EXPECT_NEAR(weighted.volume, plain.volume, 1e-12 * plain.volume);
  EXPECT_NEAR(weighted.meanRegularity, plain.meanRegularity, 1e-12);
  // Each cell's own size stands for the mean one: another mean, of the same order.
  EXPECT_NEAR(weighted.rmsMove, plain.rmsMove, 0.1 * plain.rmsMove);
}

TEST(DensityEnergy, DoesNotDependOnTheUnitsOfTheDensity) {
  const mesh::PlanarRegion region = mesh::squareRegion();
  PlanarDomain small(region);
  PlanarDomain large(region);
  small.setDensity(densityOf<2>([](const Vec2&) { return 1.0; }, 4));
  large.setDensity(densityOf<2>([](const Vec2&) { return 2.0; }, 4));
  const auto sites = randomSites<2>(PlanarDomain(region), 300, 2, {});
  const Evaluation<2> a = small.evaluate(sites, {});
  const Evaluation<2> b = large.evaluate(sites, {});
  EXPECT_NEAR(b.energy, a.energy / 16, 1e-12 * a.energy);
  EXPECT_NEAR(b.rmsMove, a.rmsMove, 1e-12);
  EXPECT_NEAR(b.meanRegularity, a.meanRegularity, 1e-12);
  // E_m is of the first order in ρ.
  EXPECT_NEAR(optimalEnergy<2>(300, b.volume), optimalEnergy<2>(300, a.volume) / 16, 1e-12 * a.energy);
}

TEST(DensityCvt, LowersTheEnergyAndGradesTheCells) {
  const mesh::PlanarRegion region = mesh::squareRegion();
  PlanarDomain domain(region);
  domain.setDensity(makeDensity(region, {DensityKind::boundary, 3, 5}, 1));
  auto sites = randomSites<2>(domain, 1000, 1, {});
  OptimizeOptions options;
  options.iterations = 60;
  options.convergence = 0;
  const OptimizeSummary summary = optimize<2>(domain, sites, options, {});
  for (std::size_t k = 1; k < summary.iterations.size(); ++k) {
    EXPECT_LE(summary.iterations[k].energy, summary.iterations[k - 1].energy);
  }
  EXPECT_LT(summary.iterations.back().rmsMove, 0.02);
  EXPECT_LT(std::abs(summary.relativeError), 0.05);
  // Sizes of cells deep inside and at the boundary differ by nearly the ratio.
  const voronoi::PlanarDiagram diagram = voronoi::buildPlanarDiagram(sites, domain.siteBox(), {});
  const auto areas = voronoi::planarMoments(diagram, voronoi::clipPlanar(diagram, region, {}), {});
  double inner = 0;
  double outer = 0;
  int innerCells = 0;
  int outerCells = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const double depth = -region.signedDistance(sites[i]);
    if (depth > 5.5) {
      inner += areas[i].mass;
      ++innerCells;
    } else if (depth < 0.3) {
      outer += areas[i].mass;
      ++outerCells;
    }
  }
  ASSERT_GT(innerCells, 20);
  ASSERT_GT(outerCells, 100);
  EXPECT_NEAR(std::sqrt(inner / innerCells / (outer / outerCells)), 3, 0.3);
}

TEST(DensityCvt, ConvergesAsFastAsAUniformOne) {
  const auto form = implicit::torus(1, 0.4);
  ImplicitDomain domain(*form);
  OptimizeOptions options;
  options.iterations = 10;
  options.convergence = 0;
  auto sites = randomSites<3>(domain, 4000, 1, {});
  const double uniform = optimize<3>(domain, sites, options, {}).iterations.back().rmsMove;
  domain.setDensity(makeDensity(*form, {DensityKind::boundary, 3, 0}, std::cbrt(domain.volume() / 4000), {}));
  sites = randomSites<3>(domain, 4000, 1, {});
  const double graded = optimize<3>(domain, sites, options, {}).iterations.back().rmsMove;
  // 1.18 times; 1.5 times if all coordinates had one unit.
  EXPECT_LT(graded, 1.35 * uniform);
}

TEST(DensityCvt, IsTheSameBitsForAnyNumberOfThreads) {
  const auto form = implicit::torus(1, 0.4);
  RunContext one;
  one.threads = 1;
  std::vector<std::vector<Vec3>> results;
  for (const RunContext& context : {one, RunContext{}}) {
    ImplicitDomain domain(*form);
    domain.setDensity(makeDensity(*form, {DensityKind::curvature, 2, 0}, 0.1, context));
    auto sites = randomSites<3>(domain, 800, 1, context);
    OptimizeOptions options;
    options.iterations = 5;
    optimize<3>(domain, sites, options, context);
    results.push_back(sites);
  }
  EXPECT_TRUE(testing::sameBits(results[0], results[1]));
}

}  // namespace
}  // namespace voroform::cvt
