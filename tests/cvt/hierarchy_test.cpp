// Subdivisions, the number of sites of each level, and what hierarchical sites are good for.
#include "voroform/cvt/hierarchy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "subdivision.hpp"
#include "support/voronoi_sites.hpp"
#include "voroform/core/error.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/planar_domain.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::cvt {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Le;

// The integer coordinates of a point within rounding of the lattice that the columns of `basis` span around `origin`.
template <int M>
std::array<long, M> latticeCoordinates(const Vec<M>& p, const Eigen::Matrix<double, M, M>& basis,
                                       const Vec<M>& origin) {
  const Vec<M> coordinates = basis.inverse() * (p - origin);
  std::array<long, M> result;
  for (Index i = 0; i < M; ++i) {
    result[static_cast<std::size_t>(i)] = std::lround(coordinates[i]);
    EXPECT_NEAR(coordinates[i], static_cast<double>(result[static_cast<std::size_t>(i)]), 1e-9);
  }
  return result;
}

template <int M>
std::vector<Vec<M>> latticePoints(const Eigen::Matrix<double, M, M>& basis, const Vec<M>& origin, double halfEdge,
                                  long range) {
  std::vector<Vec<M>> result;
  for (long i = -range; i <= range; ++i) {
    for (long j = -range; j <= range; ++j) {
      for (long k = M == 3 ? -range : 0; k <= (M == 3 ? range : 0); ++k) {
        Vec<M> coordinates;
        coordinates[0] = static_cast<double>(i);
        coordinates[1] = static_cast<double>(j);
        if constexpr (M == 3) coordinates[2] = static_cast<double>(k);
        const Vec<M> p = origin + basis * coordinates;
        if (p.cwiseAbs().maxCoeff() < halfEdge) result.push_back(p);
      }
    }
  }
  return result;
}

// The lattice in a cube or square of edge 4, subdivided, is the lattice half as wide, farther than 1 from the boundary.
template <int M>
void expectHalvedLattice(const Domain<M>& domain, const Eigen::Matrix<double, M, M>& basis) {
  const Vec<M> origin = 0.013 * Vec<M>::LinSpaced(1, 2);
  const std::vector<Vec<M>> sites = latticePoints<M>(basis, origin, 2, 20);
  const std::vector<Vec<M>> fine = subdivide<M>(domain, sites, domain.graph(sites, {}), {});
  std::set<std::array<long, M>> found;
  std::size_t inner = 0;
  for (const Vec<M>& p : fine) {
    if (p.cwiseAbs().maxCoeff() > 1) continue;
    ++inner;
    found.insert(latticeCoordinates<M>(p, 0.5 * basis, origin));
  }
  EXPECT_EQ(found.size(), inner) << "two sites at one place";
  EXPECT_EQ(inner, latticePoints<M>(0.5 * basis, origin, 1, 40).size());
  EXPECT_GT(inner, 200U);
}

TEST(Subdivision, HalvesTheHexagonalLattice) {
  const mesh::PlanarRegion region(std::array{std::vector<Vec2>{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}});
  Eigen::Matrix2d basis;
  basis << 0.2, 0.1, 0, 0.1 * std::numbers::sqrt3;
  expectHalvedLattice<2>(PlanarDomain(region), basis);
}

TEST(Subdivision, HalvesTheBodyCenteredCubicLattice) {
  const auto form = implicit::box(Vec3(4, 4, 4));
  Eigen::Matrix3d basis;
  basis << -0.2, 0.2, 0.2, 0.2, -0.2, 0.2, 0.2, 0.2, -0.2;
  expectHalvedLattice<3>(ImplicitDomain(*form), basis);
}

TEST(Subdivision, LeavesOutWhatLiesOutside) {
  // Around the notch of an L the midpoint of two neighbors lies outside.
  const mesh::PlanarRegion region(std::array{std::vector<Vec2>{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}});
  const PlanarDomain domain(region);
  const std::vector<Vec2> sites = {{0.5, 0.4}, {1.9, 0.9}, {0.9, 1.9}};
  const SiteGraph graph{{{0, 1}, {0, 2}, {1, 2}}, {1, 1, 1}};
  const auto fine = subdivide<2>(domain, sites, graph, {});
  ASSERT_EQ(fine.size(), 5U);
  EXPECT_EQ(fine[3], Vec2(1.2, 0.65));
  EXPECT_EQ(fine[4], Vec2(0.7, 1.15));
}

template <int M>
std::size_t nearest(const std::vector<Vec<M>>& sites, const Vec<M>& p) {
  return static_cast<std::size_t>(
      std::min_element(sites.begin(), sites.end(),
                       [&](const Vec<M>& a, const Vec<M>& b) { return (a - p).norm() < (b - p).norm(); }) -
      sites.begin());
}

// The sites whose cells took one, each once.
template <int M>
std::set<std::size_t> hosts(const Domain<M>& domain, const std::vector<Vec<M>>& sites, Index count,
                            Placement placement) {
  std::vector<Vec<M>> more = sites;
  insertSites<M>(domain, more, count, placement, 5, {});
  EXPECT_EQ(more.size(), sites.size() + static_cast<std::size_t>(count));
  std::set<std::size_t> result;
  for (std::size_t i = 0; i < more.size(); ++i) {
    EXPECT_TRUE(domain.contains(more[i]));
    if (i < sites.size()) {
      EXPECT_EQ(more[i], sites[i]);
    } else {
      EXPECT_TRUE(result.insert(nearest<M>(sites, more[i])).second) << "two sites in one cell";
    }
  }
  return result;
}

TEST(InsertSites, FillsBoundaryCellsWithOneEach) {
  const auto form = implicit::torus(1, 0.4);
  const ImplicitDomain domain(*form);
  const auto sites = randomSites<3>(domain, 600, 1, {});
  const SiteGraph graph = domain.graph(sites, {});
  const auto boundary = std::count(graph.onBoundary.begin(), graph.onBoundary.end(), 1);
  ASSERT_LT(boundary, 560);
  for (const std::size_t host : hosts<3>(domain, sites, 200, Placement::boundaryAtRandom)) {
    EXPECT_EQ(graph.onBoundary[host], 1);
  }
  // Where those do not suffice, others follow.
  Index onBoundary = 0;
  for (const std::size_t host :
       hosts<3>(domain, sites, static_cast<Index>(boundary) + 20, Placement::boundaryAtRandom)) {
    onBoundary += graph.onBoundary[host];
  }
  EXPECT_GE(onBoundary, boundary - 3) << "but for cells too thin to be hit";
}

TEST(InsertSites, FillsTheLargestCellsThatAreNoNeighbors) {
  const mesh::PlanarRegion star = mesh::starRegion();
  const PlanarDomain domain(star);
  const auto sites = randomSites<2>(domain, 400, 2, {});
  const auto taken = hosts<2>(domain, sites, 30, Placement::largestFirst);
  for (const auto& [a, b] : domain.graph(sites, {}).edges) {
    EXPECT_FALSE(taken.contains(static_cast<std::size_t>(a)) && taken.contains(static_cast<std::size_t>(b)));
  }
  const auto moments = domain.evaluate(sites, {}).moments;
  const double mean = domain.volume() / 400;
  for (const std::size_t host : taken) EXPECT_GT(moments[host].mass, mean);
}

TEST(InsertSites, GoesOnInRounds) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const PlanarDomain domain(square);
  for (const Placement placement : {Placement::boundaryAtRandom, Placement::largestFirst}) {
    std::vector<Vec2> sites = {{1, 2}};
    insertSites<2>(domain, sites, 99, placement, 1, {});
    ASSERT_EQ(sites.size(), 100U);
    std::vector<Vec2> none;
    insertSites<2>(domain, none, 7, placement, 1, {});
    EXPECT_EQ(none.size(), 7U);
  }
}

TEST(RemoveSites, RemovesTheSmallestCells) {
  const mesh::PlanarRegion star = mesh::starRegion();
  const PlanarDomain domain(star);
  const auto sites = randomSites<2>(domain, 400, 2, {});
  const auto moments = domain.evaluate(sites, {}).moments;
  std::vector<Vec2> left = sites;
  removeSites<2>(domain, left, 20, {});
  ASSERT_EQ(left.size(), 380U);
  std::size_t next = 0;
  std::set<Index> removed;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (next < left.size() && left[next] == sites[i]) {
      ++next;
    } else {
      removed.insert(static_cast<Index>(i));
      EXPECT_LT(moments[i].mass, 0.5 * domain.volume() / 400);
    }
  }
  for (const auto& [a, b] : domain.graph(sites, {}).edges) {
    EXPECT_FALSE(removed.contains(a) && removed.contains(b)) << "neighbors";
  }
  EXPECT_EQ(next, left.size()) << "the order is kept";
  removeSites<2>(domain, left, 379, {});
  EXPECT_EQ(left.size(), 1U);
}

TEST(EvaluateGrown, SweepsTheBoundaryOutward) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const PlanarDomain domain(square);
  const std::vector<Vec2> site = {{1, 2}};
  const double t = 0.5;
  const auto plain = domain.evaluate(site, {}).moments[0];
  const auto grown = domain.evaluateGrown(site, t, {}).moments[0];
  EXPECT_NEAR(grown.mass, 400 + 80 * t, 1e-9);
  // Of opposite layers only what the site is off the center stays: each is 20·t large.
  EXPECT_NEAR((grown.first - plain.first - 80 * t * (Vec2(0, 0) - site[0])).norm(), 0, 1e-9);
  // ∫ x² over [10, 10 + t] × [−10, 10] and ∫ y²; four of these about the center, and the site's offset.
  const double along = 20 * (std::pow(10 + t, 3) - 1000) / 3;
  const double across = t * 2000 / 3;
  EXPECT_NEAR(grown.second - plain.second, 4 * (along + across) + 80 * t * site[0].squaredNorm(), 1e-8);
}

TEST(EvaluateGrown, GivesEachCellItsOwnPieces) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const PlanarDomain domain(square);
  const std::vector<Vec2> sites = {{-5, 0}, {5, 0}};
  const double t = 0.5;
  const auto plain = domain.evaluate(sites, {}).moments;
  const auto grown = domain.evaluateGrown(sites, t, {}).moments;
  // The layer on the far side has its centroid t/2 beyond it; those above and below balance.
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(grown[i].mass - plain[i].mass, 40 * t, 1e-9);
    const Vec2 expected(20 * t * (5 + t / 2) * (i == 0 ? -1 : 1), 0);
    EXPECT_NEAR((grown[i].first - plain[i].first - expected).norm(), 0, 1e-9);
  }
}

TEST(EvaluateGrown, GrowsABall) {
  const auto ball = implicit::sphere(1);
  const ImplicitDomain domain(*ball);
  const auto sites = randomSites<3>(domain, 4000, 1, {});
  const double t = 0.01;
  const Evaluation<3> plain = domain.evaluate(sites, {});
  EXPECT_EQ(domain.evaluateGrown(sites, 0, {}).energy, plain.energy);
  const Evaluation<3> grown = domain.evaluateGrown(sites, t, {});
  EXPECT_NEAR(grown.volume - plain.volume, 4 * std::numbers::pi * t, 0.01 * 4 * std::numbers::pi * t);
  // Boundary cells' centroids move outward.
  double outward = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    outward += (grown.moments[i].first - plain.moments[i].first).dot(sites[i].normalized());
  }
  EXPECT_GT(outward, 0);
}

TEST(EvaluateGrown, ADensityOfOneChangesNothing) {
  const mesh::PlanarRegion star = mesh::starRegion();
  PlanarDomain domain(star);
  const auto sites = randomSites<2>(domain, 300, 1, {});
  const double energy = domain.evaluateGrown(sites, 0.2, {}).energy;
  domain.setDensity(std::make_shared<const Density<2>>([](const Vec2&) { return 1.0; }, 1.0));
  EXPECT_NEAR(domain.evaluateGrown(sites, 0.2, {}).energy, energy, 1e-12 * energy);
  // Cells twice as wide everywhere: ρ = 1/16, and the layer is twice as thick.
  domain.setDensity(std::make_shared<const Density<2>>([](const Vec2&) { return 2.0; }, 2.0));
  EXPECT_NEAR(domain.evaluateGrown(sites, 0.1, {}).energy, energy / 16, 1e-12 * energy);
}

TEST(MostSubdivisions, AreThePapers) {
  EXPECT_EQ(mostSubdivisions<2>(1033), 4);
  EXPECT_EQ(mostSubdivisions<2>(10025), 5);
  EXPECT_EQ(mostSubdivisions<3>(1000), 2);
  EXPECT_EQ(mostSubdivisions<3>(5000), 3);
  EXPECT_EQ(mostSubdivisions<2>(1), 0);
  EXPECT_EQ(mostSubdivisions<2>(15), 0);
  EXPECT_EQ(mostSubdivisions<2>(16), 1);
  EXPECT_EQ(mostSubdivisions<3>(std::numeric_limits<Index>::max()), 9);
  EXPECT_EQ(defaultSubdivisions<3>(5000, SubdivisionRule::insertion), 3);
  EXPECT_EQ(defaultSubdivisions<3>(5000, SubdivisionRule::matched), 1);
  EXPECT_EQ(defaultSubdivisions<3>(100000, SubdivisionRule::matched), 2);
  EXPECT_EQ(defaultSubdivisions<3>(40, SubdivisionRule::matched), 0);
  EXPECT_EQ(defaultSubdivisions<2>(1033, SubdivisionRule::matched), 4);
}

template <int M>
Hierarchy<M> hierarchy(const Domain<M>& domain, Index count, SubdivisionRule rule, int subdivisions,
                       const RunContext& context = {}) {
  HierarchyOptions options;
  options.rule = rule;
  options.subdivisions = subdivisions;
  options.coarseIterations = 20;
  return hierarchicalSites<M>(domain, count, options, {}, context);
}

TEST(Hierarchy, CountsSitesAsTheThesisDoes) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const auto result = hierarchy<2>(PlanarDomain(square), 2560, SubdivisionRule::insertion, 4);
  // Thesis, figure 4.4.
  const std::vector<Index> counts = {10, 40, 160, 640, 2560};
  ASSERT_EQ(result.levels.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    const HierarchyLevel& level = result.levels[i];
    EXPECT_EQ(level.sites, counts[i]);
    EXPECT_EQ(level.subdivided + level.inserted, counts[i + 1]);
    EXPECT_GT(level.inserted, 0);
    EXPECT_GT(level.optimization.iterationsDone, 0);
  }
  // 97.5 % of 2560 stood after subdivision in table 4.1.
  EXPECT_LT(result.levels[3].inserted, 150);
  EXPECT_EQ(result.sites.size(), 2560U);
}

TEST(Hierarchy, MatchedCountsLeaveNextToNothingMissing) {
  const auto form = implicit::torus(1, 0.4);
  const ImplicitDomain domain(*form);
  const auto missing = [&](SubdivisionRule rule) { return hierarchy<3>(domain, 6000, rule, 1).levels.back().inserted; };
  EXPECT_GT(missing(SubdivisionRule::insertion), 900);
  EXPECT_LT(std::abs(missing(SubdivisionRule::matched)), 120);
}

TEST(Hierarchy, MatchedLevelsFillTheBoundaryLayer) {
  const auto form = implicit::torus(1, 0.4);
  const ImplicitDomain domain(*form);
  const auto sites = hierarchy<3>(domain, 4000, SubdivisionRule::matched, 1).sites;
  const auto moments = domain.evaluate(sites, {}).moments;
  const SiteGraph graph = domain.graph(sites, {});
  double mass = 0;
  double cells = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (graph.onBoundary[i] == 0) continue;
    mass += moments[i].mass;
    ++cells;
  }
  // Without growth the outermost cells would be half a layer thicker.
  EXPECT_NEAR(mass / cells, domain.volume() / 4000, 0.1 * domain.volume() / 4000);
}

double regularityAfter(const Domain<3>& domain, std::vector<Vec3> sites, int iterations) {
  OptimizeOptions options;
  options.iterations = iterations;
  options.convergence = 0;
  return optimize(domain, sites, options, {}).iterations.back().meanRegularity;
}

TEST(Hierarchy, SitesAreMoreRegularThanRandomOnes) {
  const auto form = implicit::torus(1, 0.4);
  const ImplicitDomain domain(*form);
  const double random = regularityAfter(domain, randomSites<3>(domain, 4000, 1, {}), 10);
  const double inserted = regularityAfter(domain, hierarchy<3>(domain, 6000, SubdivisionRule::insertion, 1).sites, 10);
  const double matched = regularityAfter(domain, hierarchy<3>(domain, 6000, SubdivisionRule::matched, 1).sites, 10);
  EXPECT_LT(inserted, random - 0.0002);
  EXPECT_LT(matched, inserted - 0.0004);
}

template <int M>
void expectSites(const Domain<M>& domain, Index count) {
  for (const SubdivisionRule rule : {SubdivisionRule::insertion, SubdivisionRule::matched}) {
    for (int subdivisions = 0; subdivisions <= mostSubdivisions<M>(count) + (count >= 8 ? 1 : 0); ++subdivisions) {
      SCOPED_TRACE(std::to_string(count) + " sites, " + toString(rule) + ", " + std::to_string(subdivisions));
      const auto result = hierarchy<M>(domain, count, rule, subdivisions);
      ASSERT_EQ(result.sites.size(), static_cast<std::size_t>(count));
      EXPECT_EQ(result.levels.size(), static_cast<std::size_t>(subdivisions));
      for (const Vec<M>& site : result.sites) EXPECT_TRUE(domain.contains(site));
      EXPECT_NO_THROW(domain.evaluate(result.sites, {})) << "sites coincide";
    }
  }
}

TEST(Hierarchy, GivesTheNumberOfSitesAskedFor) {
  const mesh::PlanarRegion star = mesh::starRegion();
  for (const auto& form : {implicit::sphere(1), implicit::gyroidBall(), implicit::twoTori()}) {
    for (const Index count : {1, 2, 3, 4, 7, 8, 12, 20, 300}) expectSites<3>(ImplicitDomain(*form), count);
  }
  for (Index count = 1; count <= 20; ++count) expectSites<2>(PlanarDomain(star), count);
  expectSites<2>(PlanarDomain(star), 700);
}

TEST(Hierarchy, MayStartFromALattice) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const PlanarDomain domain(square);
  HierarchyOptions options;
  options.subdivisions = 1;
  for (const SubdivisionRule rule : {SubdivisionRule::insertion, SubdivisionRule::matched}) {
    options.rule = rule;
    options.fromLattice = false;
    const double random = domain.evaluate(hierarchicalSites<2>(domain, 1033, options, {}, {}).sites, {}).meanRegularity;
    options.fromLattice = true;
    const auto result = hierarchicalSites<2>(domain, 1033, options, {}, {});
    EXPECT_EQ(result.sites.size(), 1033U);
    EXPECT_LT(domain.evaluate(result.sites, {}).meanRegularity, random - 0.0001) << toString(rule);
  }
}

TEST(Hierarchy, ThreadsGiveTheSameBits) {
  const auto form = implicit::torus(1, 0.4);
  const ImplicitDomain domain(*form);
  RunContext one;
  one.threads = 1;
  RunContext two;
  two.threads = 2;
  for (const SubdivisionRule rule : {SubdivisionRule::insertion, SubdivisionRule::matched}) {
    const auto reference = hierarchy<3>(domain, 3000, rule, 2, one);
    EXPECT_TRUE(testing::sameBits(reference.sites, hierarchy<3>(domain, 3000, rule, 2, two).sites));
  }
}

TEST(Hierarchy, RejectsBadOptions) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const PlanarDomain domain(square);
  const auto messageOf = [&](Index count, const HierarchyOptions& options, const OptimizeOptions& optimization) {
    try {
      hierarchicalSites<2>(domain, count, options, optimization, {});
    } catch (const UsageError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(messageOf(0, {}, {}), HasSubstr("sites is 0"));
  HierarchyOptions deep;
  deep.subdivisions = 6;
  EXPECT_THAT(messageOf(1033, deep, {}), HasSubstr("subdivisions is 6, but 1033 sites can come of at most 5"));
  HierarchyOptions idle;
  idle.coarseIterations = 0;
  EXPECT_THAT(messageOf(1033, idle, {}), HasSubstr("coarseIterations is 0"));
  OptimizeOptions bad;
  bad.convergence = -1;
  EXPECT_THAT(messageOf(3, {}, bad), HasSubstr("convergence is -1"));
}

TEST(Hierarchy, ReportsLevelsAndCanBeCancelled) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const PlanarDomain domain(square);
  std::vector<double> shares;
  std::atomic<bool> cancelled = false;
  RunContext context;
  context.cancelled = &cancelled;
  context.progress = [&](std::string_view stage, double share) {
    EXPECT_EQ(stage, "subdivide");
    shares.push_back(share);
  };
  hierarchy<2>(domain, 700, SubdivisionRule::matched, 3, context);
  EXPECT_THAT(shares, ::testing::ElementsAre(::testing::DoubleEq(1.0 / 3), ::testing::DoubleEq(2.0 / 3), 1));
  EXPECT_THAT(shares, Each(Le(1)));
  context.progress = [&](std::string_view, double) { cancelled = true; };
  EXPECT_THROW(hierarchy<2>(domain, 700, SubdivisionRule::matched, 3, context), Cancelled);
}

}  // namespace
}  // namespace voroform::cvt
