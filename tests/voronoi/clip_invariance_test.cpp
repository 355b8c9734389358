// What clipping does not depend on: threads, the oracle, the root finder, scale, rotation.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "support/voronoi_sites.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {
namespace {

using ::testing::IsEmpty;

constexpr CapKind kAllCaps[] = {CapKind::flat, CapKind::cvt1, CapKind::cvt2, CapKind::cvt3};
const double kTiny = std::ldexp(1.0, -30);

void expectSameCombinatorics(const testing::Tessellation& a, const testing::Tessellation& b) {
  EXPECT_EQ(a.clipped.inside, b.clipped.inside);
  EXPECT_EQ(a.clipped.rootSites, b.clipped.rootSites);
  EXPECT_EQ(a.clipped.polygonFacets, b.clipped.polygonFacets);
  EXPECT_EQ(a.clipped.polygonOffsets, b.clipped.polygonOffsets);
  EXPECT_EQ(a.clipped.polygonPoints, b.clipped.polygonPoints);
  EXPECT_EQ(a.clipped.loopOffsets, b.clipped.loopOffsets);
  EXPECT_EQ(a.clipped.loopPoints, b.clipped.loopPoints);
  EXPECT_EQ(a.complex.faceOffsets, b.complex.faceOffsets);
  EXPECT_EQ(a.complex.faceVertices, b.complex.faceVertices);
  EXPECT_EQ(a.complex.faceCells, b.complex.faceCells);
}

double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  double result = 0;
  for (std::size_t i = 0; i < a.size(); ++i) result = std::max(result, (a[i] - b[i]).norm());
  return result;
}

TEST(ClipInvariance, ThreadsGiveTheSameBits) {
  // Enough facets, edges and cells for several chunks of every parallel loop; some fallbacks, too.
  for (const auto& form : {implicit::torus(1, 0.4), implicit::gyroidBall()}) {
    const auto sites = testing::sitesInside(*form, 6000, 1);
    for (const CapKind cap : kAllCaps) {
      RunContext one;
      one.threads = 1;
      const auto reference = testing::tessellateSites(sites, *form, {.cap = cap}, one);
      for (const int threads : {2, 3}) {
        RunContext several;
        several.threads = threads;
        const auto result = testing::tessellateSites(sites, *form, {.cap = cap}, several);
        EXPECT_THAT(testing::differences(reference.complex, result.complex), IsEmpty()) << threads;
        EXPECT_EQ(reference.clipped.summary.evaluations, result.clipped.summary.evaluations);
        EXPECT_EQ(reference.clipped.summary.fallbackCaps, result.clipped.summary.fallbackCaps);
        const auto a = siteMoments(reference.diagram, reference.clipped, one);
        const auto b = siteMoments(result.diagram, result.clipped, several);
        EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]), 0);
      }
    }
  }
}

// Where the oracle's clearances reach shifts the probes, and with them the brackets that roots are found in: positions
// may differ by the root finder's tolerance, and nothing else may.
TEST(ClipInvariance, TheOracleSavesEvaluationsAndChangesNoIndex) {
  for (const auto& form : {implicit::sphere(1), implicit::torus(1, 0.4), implicit::ellipsoid(Vec3(1, 0.7, 0.5))}) {
    const testing::WithoutOracle idle(form);
    const auto sites = testing::relaxed(testing::sitesInside(*form, 2000, 2), *form, 3);
    for (const CapKind cap : {CapKind::flat, CapKind::cvt2, CapKind::cvt3}) {
      const auto active = testing::tessellateSites(sites, *form, {.cap = cap});
      const auto without = testing::tessellateSites(sites, idle, {.cap = cap});
      expectSameCombinatorics(active, without);
      EXPECT_LT(farthest(active.complex.vertices, without.complex.vertices), 1e-11);
      EXPECT_EQ(without.clipped.summary.oracleShare, 0);
      EXPECT_GT(active.clipped.summary.oracleShare, 0.5);
      EXPECT_LT(active.clipped.summary.evaluations, 0.5 * static_cast<double>(without.clipped.summary.evaluations));
    }
  }
}

TEST(ClipInvariance, RootFindersAgree) {
  const auto form = implicit::transformed(implicit::bumpySphere(), randomRotation(4), Vec3(0.1, 0, 0));
  const auto sites = testing::relaxed(testing::sitesInside(*form, 1500, 3), *form, 2);
  for (const CapKind cap : {CapKind::cvt1, CapKind::cvt2, CapKind::cvt3}) {
    const auto itp = testing::tessellateSites(sites, *form, {.cap = cap});
    const auto bisection =
        testing::tessellateSites(sites, *form, {.cap = cap, .rootFinder = implicit::RootFinder::bisection});
    expectSameCombinatorics(itp, bisection);
    const double apart = farthest(itp.complex.vertices, bisection.complex.vertices);
    EXPECT_LT(apart, 1e-9);
    EXPECT_GT(apart, 0) << "they are two methods";
    EXPECT_LT(itp.clipped.summary.evaluations, 0.5 * static_cast<double>(bisection.clipped.summary.evaluations));
  }
}

TEST(ClipInvariance, ScaleChangesNoIndex) {
  for (const auto& shape : {implicit::bumpySphere(), implicit::gyroidBall(), implicit::box(Vec3(2, 1, 0.1))}) {
    const auto form = implicit::transformed(shape, randomRotation(5), Vec3::Zero());
    const auto small = implicit::transformed(shape, randomRotation(5), Vec3::Zero(), kTiny);
    const auto sites = testing::sitesInside(*form, 800, 4);
    std::vector<Vec3> smallSites;
    for (const Vec3& site : sites) smallSites.push_back(kTiny * site);
    for (const CapKind cap : {CapKind::cvt1, CapKind::cvt2, CapKind::cvt3}) {
      const auto a = testing::tessellateSites(sites, *form, {.cap = cap});
      const auto b = testing::tessellateSites(smallSites, *small, {.cap = cap});
      expectSameCombinatorics(a, b);
      std::vector<Vec3> restored = b.complex.vertices;
      for (Vec3& vertex : restored) vertex /= kTiny;
      EXPECT_TRUE(testing::sameBits(a.complex.vertices, restored)) << "a power of two is exact";
      EXPECT_EQ(a.clipped.summary.unprojectedPoints, b.clipped.summary.unprojectedPoints);
      EXPECT_EQ(a.clipped.summary.fallbackCaps, b.clipped.summary.fallbackCaps);
    }
  }
}

// What a rigid motion keeps, free of the order of elements: the edges that have roots, the facets in the solid and the
// length of each cell's loops.
struct Signature {
  std::multiset<std::array<Index, 3>> roots;
  std::map<std::array<Index, 2>, ClippedDiagram::FacetState> facets;
  std::multiset<std::pair<Index, std::size_t>> loops;
  std::array<Index, 5> counts{};
};

Signature signatureOf(const testing::Tessellation& tessellation) {
  Signature result;
  const auto& [diagram, clipped, complex] = tessellation;
  result.roots.insert(clipped.rootSites.begin(), clipped.rootSites.end());
  for (std::size_t f = 0; f < clipped.facetStates.size(); ++f) {
    if (clipped.facetStates[f] != ClippedDiagram::FacetState::outside) {
      result.facets[diagram.facetSites[f]] = clipped.facetStates[f];
    }
  }
  for (Index l = 0; l < clipped.loopCount(); ++l) {
    result.loops.emplace(clipped.loopSites[static_cast<std::size_t>(l)], clipped.loop(l).size());
  }
  result.counts = {complex.cellCount, complex.faceCount(), static_cast<Index>(complex.vertices.size()),
                   clipped.summary.doubleRootEdges, clipped.summary.multiLoopCells};
  return result;
}

TEST(ClipInvariance, RigidMotionKeepsTheCombinatorics) {
  const Mat3 rotation = randomRotation(6);
  const Vec3 translation(0.3, -0.2, 0.7);
  for (const auto& form : {implicit::bumpySphere(), implicit::torus(1, 0.4)}) {
    const auto moved = implicit::transformed(form, rotation, translation);
    const auto sites = testing::sitesInside(*form, 800, 5);
    std::vector<Vec3> movedSites;
    for (const Vec3& site : sites) movedSites.push_back(rotation * site + translation);
    for (const CapKind cap : {CapKind::cvt1, CapKind::cvt2, CapKind::cvt3}) {
      const Signature a = signatureOf(testing::tessellateSites(sites, *form, {.cap = cap}));
      const Signature b = signatureOf(testing::tessellateSites(movedSites, *moved, {.cap = cap}));
      EXPECT_EQ(a.roots, b.roots);
      EXPECT_EQ(a.facets, b.facets);
      EXPECT_EQ(a.loops, b.loops);
      EXPECT_EQ(a.counts, b.counts);
      EXPECT_GT(a.loops.size(), 100U);
    }
  }
}

}  // namespace
}  // namespace voroform::voronoi
