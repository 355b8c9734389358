// The levels of the hierarchy, their numbers of sites, and what hierarchical sites are good for.
#include "voroform/cvt/hierarchy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/voronoi_sites.hpp"
#include "voroform/core/error.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/optimized_sites.hpp"
#include "voroform/cvt/planar_domain.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::cvt {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Le;

TEST(MostSubdivisions, AreThePapers) {
  EXPECT_EQ(mostSubdivisions<2>(1033), 4);
  EXPECT_EQ(mostSubdivisions<2>(10025), 5);
  EXPECT_EQ(mostSubdivisions<3>(1000), 2);
  EXPECT_EQ(mostSubdivisions<3>(5000), 3);
  EXPECT_EQ(mostSubdivisions<2>(1), 0);
  EXPECT_EQ(mostSubdivisions<2>(15), 0);
  EXPECT_EQ(mostSubdivisions<2>(16), 1);
  EXPECT_EQ(mostSubdivisions<3>(std::numeric_limits<Index>::max()), 9);
  EXPECT_EQ(defaultSubdivisions<3>(5000, SubdivisionRule::insertion, false), 3);
  EXPECT_EQ(defaultSubdivisions<3>(5000, SubdivisionRule::matched, false), 1);
  EXPECT_EQ(defaultSubdivisions<3>(100000, SubdivisionRule::matched, false), 2);
  EXPECT_EQ(defaultSubdivisions<3>(40, SubdivisionRule::matched, false), 0);
  EXPECT_EQ(defaultSubdivisions<2>(1033, SubdivisionRule::matched, false), 4);
}

TEST(DefaultSubdivisions, OfALatticeAreOneAtMost) {
  for (const SubdivisionRule rule : {SubdivisionRule::insertion, SubdivisionRule::matched}) {
    EXPECT_EQ(defaultSubdivisions<2>(1033, rule, true), 1);
    EXPECT_EQ(defaultSubdivisions<3>(100000, rule, true), 1);
    EXPECT_EQ(defaultSubdivisions<3>(40, rule, true), 0);
  }
  const mesh::PlanarRegion square = mesh::squareRegion();
  HierarchyOptions options;
  options.fromLattice = true;
  EXPECT_EQ(hierarchicalSites<2>(PlanarDomain(square), 1033, options, {}, {}).levels.size(), 1U);
  options.fromLattice = false;
  EXPECT_EQ(hierarchicalSites<2>(PlanarDomain(square), 1033, options, {}, {}).levels.size(), 4U);
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

template <int M>
double regularityAfter(const Domain<M>& domain, std::vector<Vec<M>> sites, int iterations) {
  return optimize<M>(domain, sites, {.iterations = iterations, .convergence = 0}, {}).iterations.back().meanRegularity;
}

TEST(Hierarchy, SitesAreMoreRegularThanRandomOnes) {
  const auto form = implicit::torus(1, 0.4);
  const ImplicitDomain domain(*form);
  const double random = regularityAfter<3>(domain, randomSites<3>(domain, 4000, 1, {}), 10);
  const double inserted =
      regularityAfter<3>(domain, hierarchy<3>(domain, 6000, SubdivisionRule::insertion, 1).sites, 10);
  const double matched = regularityAfter<3>(domain, hierarchy<3>(domain, 6000, SubdivisionRule::matched, 1).sites, 10);
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
    const double random = regularityAfter<2>(domain, hierarchicalSites<2>(domain, 1033, options, {}, {}).sites, 50);
    options.fromLattice = true;
    const auto result = hierarchicalSites<2>(domain, 1033, options, {}, {});
    EXPECT_EQ(result.sites.size(), 1033U);
    // Of ten seeds each gains 0.0001 at least.
    EXPECT_LT(regularityAfter<2>(domain, result.sites, 50), random - 0.00005) << toString(rule);
  }
}

// Of the only coarser level, when the finest one is to get so many.
template <int M>
int coarseIterations(const Domain<M>& domain, int iterations) {
  SiteOptions options;
  options.sites = 1500;
  options.initialization = Initialization::hierarchicalRandom;
  options.subdivisions = 1;
  options.iterations = iterations;
  options.convergence = 0;
  return optimizeSites<M>(domain, {}, options, {}).summary.levels.at(0).optimization.iterationsDone;
}

TEST(OptimizedSites, CoarserLevelsGetFiftyIterationsAndMoreInThePlaneAlone) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  EXPECT_EQ(coarseIterations<2>(PlanarDomain(square), 2), 50);
  EXPECT_EQ(coarseIterations<2>(PlanarDomain(square), 70), 70);
  const auto form = implicit::sphere(1);
  EXPECT_EQ(coarseIterations<3>(ImplicitDomain(*form), 2), 50);
  EXPECT_EQ(coarseIterations<3>(ImplicitDomain(*form), 70), 50);
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
