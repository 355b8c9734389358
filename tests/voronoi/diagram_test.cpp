// The Voronoi diagram against its definition and against cells cut out of a box by half-spaces.
#include "voroform/voronoi/diagram.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "support/half_space_cell.hpp"
#include "support/voronoi_sites.hpp"
#include "voroform/core/error.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/validate.hpp"

namespace voroform::voronoi {
namespace {

using ::testing::HasSubstr;

// Circumcenters are computed in double precision where a tetrahedron's determinant is at least 1e-9 of its edges'
// product: at worst that leaves 16 − 9 digits, relative to the circumradius.
constexpr double kCircumcenterTolerance = 1e-6;
constexpr double kRounding = 1e-12;

const Box3 kUnitBox(Vec3::Constant(-1), Vec3::Constant(1));

const Vec3& siteOf(const Diagram& diagram, Index site) { return diagram.sites[static_cast<std::size_t>(site)]; }
const Vec3& vertexOf(const Diagram& diagram, Index v) { return diagram.vertices[static_cast<std::size_t>(v)]; }

Diagram randomDiagram(std::size_t count, std::uint64_t seed) {
  const auto sites = testing::sitesInBox(count, seed, kUnitBox);
  return buildDiagram(sites, kUnitBox, {});
}

TEST(Diagram, KeepsTheSitesAndPutsGhostsFarAway) {
  const auto sites = testing::sitesInBox(100, 1, kUnitBox);
  const Diagram diagram = buildDiagram(sites, kUnitBox, {});
  ASSERT_EQ(diagram.siteCount, 100);
  ASSERT_GT(diagram.sites.size(), sites.size());
  EXPECT_TRUE(testing::sameBits(std::span(diagram.sites).first(100), sites));
  const double radius = 0.5 * kUnitBox.diagonal().norm();
  for (std::size_t i = 100; i < diagram.sites.size(); ++i) {
    EXPECT_GT((diagram.sites[i] - kUnitBox.center()).norm(), 3 * radius);
  }
}

TEST(Diagram, VerticesAreCentersOfEmptySpheresThroughTheirFourSites) {
  const Diagram diagram = randomDiagram(300, 2);
  for (std::size_t v = 0; v < diagram.vertices.size(); ++v) {
    const Vec3& center = diagram.vertices[v];
    const auto& sites = diagram.vertexSites[v];
    const double radius = (siteOf(diagram, sites[0]) - center).norm();
    for (const Index site : sites) {
      EXPECT_NEAR((siteOf(diagram, site) - center).norm(), radius, kCircumcenterTolerance * radius);
    }
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3& site : diagram.sites) nearest = std::min(nearest, (site - center).norm());
    EXPECT_GE(nearest, (1 - kCircumcenterTolerance) * radius) << "vertex " << v;
    EXPECT_TRUE(std::any_of(sites.begin(), sites.end(), [&](Index s) { return diagram.isReal(s); }));
    const Vec3 a = siteOf(diagram, sites[1]) - siteOf(diagram, sites[0]);
    const Vec3 b = siteOf(diagram, sites[2]) - siteOf(diagram, sites[0]);
    const Vec3 c = siteOf(diagram, sites[3]) - siteOf(diagram, sites[0]);
    EXPECT_GT(a.cross(b).dot(c), 0) << "orientation";
  }
}

TEST(Diagram, EdgesAreTheSameFromBothEnds) {
  const Diagram diagram = randomDiagram(300, 3);
  std::size_t edges = 0;
  for (Index v = 0; v < diagram.vertexCount(); ++v) {
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const Index w = diagram.vertexNeighbors[static_cast<std::size_t>(v)][slot];
      std::set<Index> own(diagram.vertexSites[static_cast<std::size_t>(v)].begin(),
                          diagram.vertexSites[static_cast<std::size_t>(v)].end());
      own.erase(diagram.vertexSites[static_cast<std::size_t>(v)][slot]);
      if (w == kNone) {
        EXPECT_FALSE(diagram.isReal(*own.begin())) << "an edge of a real cell has two ends";
        continue;
      }
      ++edges;
      EXPECT_EQ(diagram.slotOf(v, w), static_cast<int>(slot));
      const int back = diagram.slotOf(w, v);
      ASSERT_EQ(diagram.vertexNeighbors[static_cast<std::size_t>(w)][static_cast<std::size_t>(back)], v);
      std::set<Index> others(diagram.vertexSites[static_cast<std::size_t>(w)].begin(),
                             diagram.vertexSites[static_cast<std::size_t>(w)].end());
      others.erase(diagram.vertexSites[static_cast<std::size_t>(w)][static_cast<std::size_t>(back)]);
      EXPECT_EQ(own, others);
    }
  }
  EXPECT_GT(edges, 300U * 12);
}

TEST(Diagram, FacetsLieOnBisectorsAndRunCounterClockwiseSeenFromTheSecondSite) {
  const Diagram diagram = randomDiagram(300, 4);
  std::set<std::array<Index, 2>> pairs;
  for (Index f = 0; f < diagram.facetCount(); ++f) {
    const auto [a, b] = diagram.facetSites[static_cast<std::size_t>(f)];
    ASSERT_LT(a, b);
    ASSERT_TRUE(diagram.isReal(a));
    EXPECT_TRUE(pairs.insert({a, b}).second) << "two facets between " << a << " and " << b;
    const Vec3 normal = (siteOf(diagram, b) - siteOf(diagram, a)).normalized();
    const Vec3 middle = 0.5 * (siteOf(diagram, a) + siteOf(diagram, b));
    const auto loop = diagram.facet(f);
    ASSERT_GE(loop.size(), 3U);
    Vec3 area = Vec3::Zero();
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3& p = vertexOf(diagram, loop[k]);
      const Vec3& q = vertexOf(diagram, loop[(k + 1) % loop.size()]);
      const Vec3& r = vertexOf(diagram, loop[(k + 2) % loop.size()]);
      const double radius = (p - siteOf(diagram, a)).norm();
      EXPECT_NEAR(normal.dot(p - middle), 0, kCircumcenterTolerance * radius);
      EXPECT_GE(normal.dot((q - p).cross(r - q)), -kCircumcenterTolerance * radius * radius) << "convex";
      area += (p - middle).cross(q - middle);
    }
    EXPECT_GT(normal.dot(area), 0) << "facet of " << a << " and " << b;
  }
}

TEST(Diagram, FacetsOfARealSiteFormASphere) {
  const auto sites = testing::latticeSites(6, 0.2, 5);
  const Diagram diagram = buildDiagram(sites, Box3(Vec3::Constant(-4), Vec3::Constant(4)), {});
  std::vector<int> owners(static_cast<std::size_t>(diagram.facetCount()), 0);
  for (Index s = 0; s < diagram.siteCount; ++s) {
    std::map<std::pair<Index, Index>, int> directed;
    std::set<Index> vertices;
    std::size_t corners = 0;
    for (const Index f : diagram.facetsOf(s)) {
      ++owners[static_cast<std::size_t>(f)];
      const auto [a, b] = diagram.facetSites[static_cast<std::size_t>(f)];
      ASSERT_TRUE(a == s || b == s);
      const auto loop = diagram.facet(f);
      corners += loop.size();
      for (std::size_t k = 0; k < loop.size(); ++k) {
        std::pair<Index, Index> edge(loop[k], loop[(k + 1) % loop.size()]);
        vertices.insert(edge.first);
        if (b == s) std::swap(edge.first, edge.second);
        ++directed[edge];
      }
    }
    EXPECT_EQ(directed.size(), corners) << "no directed edge twice";
    for (const auto& [edge, count] : directed) {
      EXPECT_EQ(directed.count({edge.second, edge.first}), 1U) << "site " << s;
    }
    const auto faces = static_cast<std::ptrdiff_t>(diagram.facetsOf(s).size());
    EXPECT_EQ(std::ssize(vertices) - std::ssize(directed) / 2 + faces, 2) << "Euler's formula, site " << s;
  }
  for (Index f = 0; f < diagram.facetCount(); ++f) {
    const Index second = diagram.facetSites[static_cast<std::size_t>(f)][1];
    EXPECT_EQ(owners[static_cast<std::size_t>(f)], diagram.isReal(second) ? 2 : 1);
  }
}

// Volume of a cell as pyramids of its facets over the site.
double cellVolume(const Diagram& diagram, Index site) {
  double volume = 0;
  for (const Index f : diagram.facetsOf(site)) {
    const auto [a, b] = diagram.facetSites[static_cast<std::size_t>(f)];
    const auto loop = diagram.facet(f);
    double sum = 0;
    for (std::size_t k = 2; k < loop.size(); ++k) {
      sum += (vertexOf(diagram, loop[0]) - siteOf(diagram, site))
                 .dot((vertexOf(diagram, loop[k - 1]) - siteOf(diagram, site))
                          .cross(vertexOf(diagram, loop[k]) - siteOf(diagram, site)));
    }
    volume += (a == site ? sum : -sum) / 6;
  }
  return volume;
}

TEST(Diagram, CellsAreWhatHalfSpacesLeave) {
  const Diagram diagram = randomDiagram(400, 6);
  const auto sites = std::span(diagram.sites).first(400);
  int compared = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const testing::HalfSpaceCell cell = testing::referenceCell(sites, i, kUnitBox);
    if (cell.boxFaces() > 0) continue;
    ++compared;
    const double volume = cell.moments().volume;
    EXPECT_NEAR(cellVolume(diagram, static_cast<Index>(i)), volume, 1e-10 * volume) << "site " << i;
    // The reference finds the same neighbors, and no others.
    std::set<int> neighbors;
    for (const Index f : diagram.facetsOf(static_cast<Index>(i))) {
      const auto [a, b] = diagram.facetSites[static_cast<std::size_t>(f)];
      neighbors.insert(a == static_cast<Index>(i) ? b : a);
    }
    EXPECT_EQ(cell.countFaces([&](int plane) { return neighbors.count(plane) == 1; }), neighbors.size());
    EXPECT_EQ(cell.countFaces([&](int plane) { return neighbors.count(plane) == 0; }), 0U);
  }
  EXPECT_GT(compared, 100);
}

TEST(Diagram, CosphericalSitesGiveTheCubesOfTheLattice) {
  // All eight corners of a lattice cube lie on one sphere: Delaunay tetrahedra are arbitrary, flat ones among them.
  const auto sites = testing::latticeSites(6, 0, 0);
  const Diagram diagram = buildDiagram(sites, Box3(Vec3::Constant(-4), Vec3::Constant(4)), {});
  int interior = 0;
  for (Index s = 0; s < diagram.siteCount; ++s) {
    if (siteOf(diagram, s).cwiseAbs().maxCoeff() > 2) continue;
    ++interior;
    EXPECT_NEAR(cellVolume(diagram, s), 1, kRounding);
  }
  EXPECT_EQ(interior, 64);
}

// Coincident diagram vertices give roots that coincide and cap triangles without area. What is decided by index must
// hold nevertheless; whether triangles without area touch is no sensible question.
TEST(Diagram, CosphericalSitesAreClippedToAClosedSurface) {
  const auto sites = testing::latticeSites(6, 0, 0);
  const auto form = implicit::transformed(implicit::sphere(2.6), randomRotation(1), Vec3(0.1, 0.2, 0.05));
  for (const CapKind cap : {CapKind::flat, CapKind::cvt1, CapKind::cvt2, CapKind::cvt3}) {
    const auto result = testing::tessellateSites(sites, *form, {.cap = cap});
    const mesh::Certificate certificate = mesh::validate(result.complex, {.selfIntersections = false}, {});
    EXPECT_THAT(certificate.problems, ::testing::IsEmpty());
    EXPECT_TRUE(certificate.valid);
    EXPECT_EQ(certificate.components, 1);
    EXPECT_EQ(certificate.eulerCharacteristic, 2);
    EXPECT_EQ(certificate.pointViolations, 0);
  }
}

TEST(Diagram, NearlyCosphericalSitesAreClippedValidly) {
  const auto form = implicit::transformed(implicit::sphere(2.6), randomRotation(1), Vec3(0.1, 0.2, 0.05));
  for (const double jitter : {1e-2, 1e-4, 1e-6, 1e-8}) {
    const auto sites = testing::latticeSites(6, jitter, 3);
    for (const CapKind cap : {CapKind::flat, CapKind::cvt1, CapKind::cvt2, CapKind::cvt3}) {
      const auto result = testing::tessellateSites(sites, *form, {.cap = cap});
      const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
      EXPECT_THAT(certificate.problems, ::testing::IsEmpty()) << "jitter " << jitter;
      EXPECT_EQ(certificate.eulerCharacteristic, 2);
    }
  }
}

using Extended = Eigen::Matrix<long double, 3, 1>;

// In extended precision: eleven bits more.
Extended extendedCircumcenter(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  const Extended a = q.cast<long double>() - p.cast<long double>();
  const Extended b = r.cast<long double>() - p.cast<long double>();
  const Extended c = s.cast<long double>() - p.cast<long double>();
  const Extended sum = a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b);
  return p.cast<long double>() + sum / (2 * a.dot(b.cross(c)));
}

TEST(Diagram, NearlyFlatTetrahedraHaveExactCircumcenters) {
  // A jitter near the rounding of the coordinates leaves tetrahedra whose determinant has no correct digit in double
  // precision. Their circumcenters are vertices of the diagram, so they lie near the dual lattice's vertices or, where
  // the four sites are nearly a lattice square, near its edges.
  const double jitter = 1e-13;
  const double kNear = 1e3 * jitter;
  const long double kExtended = 1e-5;  // double precision alone is off by 1e-3
  const auto sites = testing::latticeSites(6, jitter, 7);
  const Diagram diagram = buildDiagram(sites, Box3(Vec3::Constant(-4), Vec3::Constant(4)), {});
  int inside = 0;
  int flat = 0;
  for (std::size_t v = 0; v < diagram.vertices.size(); ++v) {
    const auto& s = diagram.vertexSites[v];
    if (std::any_of(s.begin(), s.end(), [&](Index i) { return !diagram.isReal(i); })) continue;
    // Flat on the lattice's hull: their centers may be anywhere beyond it.
    const Vec3 mean =
        (siteOf(diagram, s[0]) + siteOf(diagram, s[1]) + siteOf(diagram, s[2]) + siteOf(diagram, s[3])) / 4;
    if (mean.cwiseAbs().maxCoeff() > 2.4) continue;
    ++inside;
    const Vec3 a = siteOf(diagram, s[1]) - siteOf(diagram, s[0]);
    const Vec3 b = siteOf(diagram, s[2]) - siteOf(diagram, s[0]);
    const Vec3 c = siteOf(diagram, s[3]) - siteOf(diagram, s[0]);
    if (a.cross(b).dot(c) < 1e-9) ++flat;
    std::array<double, 3> off{};
    for (Index axis = 0; axis < 3; ++axis) {
      const double x = diagram.vertices[v][axis];
      EXPECT_LT(std::abs(x), 2 + kNear);
      off[static_cast<std::size_t>(axis)] = std::abs(x - std::round(x));
    }
    std::sort(off.begin(), off.end());
    EXPECT_LT(off[1], kNear) << diagram.vertices[v].transpose();
    const Extended exact = extendedCircumcenter(siteOf(diagram, s[0]), siteOf(diagram, s[1]), siteOf(diagram, s[2]),
                                                siteOf(diagram, s[3]));
    EXPECT_LT((diagram.vertices[v].cast<long double>() - exact).norm(), kExtended) << "vertex " << v;
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(flat, 0) << "the case this test is about occurs";
}

TEST(Diagram, RejectsWhatItCannotTriangulate) {
  auto sites = testing::sitesInBox(50, 8, kUnitBox);
  const auto messageFor = [&](std::size_t i, const Vec3& p) {
    auto bad = sites;
    bad[i] = p;
    try {
      buildDiagram(bad, kUnitBox, {});
    } catch (const MethodError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_THAT(messageFor(17, sites[31]), ::testing::AllOf(HasSubstr("17"), HasSubstr("31"), HasSubstr("coincide")));
  EXPECT_THAT(messageFor(4, Vec3(0, std::nan(""), 0)), HasSubstr("site 4 "));
  EXPECT_THAT(messageFor(5, Vec3(std::numeric_limits<double>::infinity(), 0, 0)), HasSubstr("site 5 "));
  EXPECT_THAT(messageFor(6, Vec3(0, 0, 1.001)), HasSubstr("site 6 "));
  EXPECT_EQ(messageFor(7, Vec3(0, 0, 1)), "no error");
}

TEST(SpatialOrder, IsAPermutationThatKeepsNeighborsTogether) {
  const auto points = testing::sitesInBox(2000, 9, kUnitBox);
  std::vector<Index> order = spatialOrder(points);
  double path = 0;
  double unordered = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    path += (points[static_cast<std::size_t>(order[i])] - points[static_cast<std::size_t>(order[i - 1])]).norm();
    unordered += (points[i] - points[i - 1]).norm();
  }
  // Neighbors on a Hilbert curve lie about a spacing, 2·2000^(−1/3) = 0.16, apart; random pairs in the box 1.32.
  EXPECT_LT(path, 0.2 * unordered);
  std::sort(order.begin(), order.end());
  std::vector<Index> all(points.size());
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(order, all);
  EXPECT_THAT(spatialOrder({}), ::testing::IsEmpty());
}

TEST(Diagram, OneThreadOrSeveralGiveTheSameArrays) {
  const auto sites = testing::sitesInBox(3000, 10, kUnitBox);
  RunContext one;
  one.threads = 1;
  const Diagram reference = buildDiagram(sites, kUnitBox, one);
  for (const int threads : {2, 3}) {
    RunContext several;
    several.threads = threads;
    const Diagram diagram = buildDiagram(sites, kUnitBox, several);
    EXPECT_TRUE(testing::sameBits(diagram.vertices, reference.vertices));
    EXPECT_EQ(diagram.vertexSites, reference.vertexSites);
    EXPECT_EQ(diagram.vertexNeighbors, reference.vertexNeighbors);
    EXPECT_EQ(diagram.facetSites, reference.facetSites);
    EXPECT_EQ(diagram.facetOffsets, reference.facetOffsets);
    EXPECT_EQ(diagram.facetVertices, reference.facetVertices);
    EXPECT_EQ(diagram.siteFacets, reference.siteFacets);
  }
}

}  // namespace
}  // namespace voroform::voronoi
