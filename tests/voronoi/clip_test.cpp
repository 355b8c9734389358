// Where the points of a clipped diagram lie, and what its cells measure.
#include "voroform/voronoi/clip.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "support/half_space_cell.hpp"
#include "support/voronoi_sites.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/validate.hpp"

namespace voroform::voronoi {
namespace {

using ::testing::IsEmpty;

// The shapes have size 1 and Lipschitz constants near 1, roots are found to 1e-12 of their edge or loop.
constexpr double kOnSurface = 1e-10;
constexpr double kInPlane = 1e-11;

constexpr CapKind kAllCaps[] = {CapKind::flat, CapKind::cvt1, CapKind::cvt2, CapKind::cvt3};

struct NamedForm {
  std::string name;
  implicit::ImplicitPtr form;
};

std::vector<NamedForm> smoothForms() {
  std::vector<NamedForm> forms;
  for (const std::string name : {"sphere", "torus", "ellipsoid", "bumpy-sphere"}) {
    forms.push_back({name, implicit::transformed(implicit::namedShape(name), randomRotation(2), Vec3(0.1, -0.2, 0.3))});
  }
  return forms;
}

std::vector<mesh::CellMoments> momentsOf(const testing::Tessellation& tessellation) {
  return mesh::cellMoments(tessellation.complex, {});
}

double totalVolume(const testing::Tessellation& tessellation) {
  double volume = 0;
  for (const mesh::CellMoments& cell : momentsOf(tessellation)) volume += cell.volume;
  return volume;
}

double distanceToPlane(const Diagram& diagram, Index facet, const Vec3& p) {
  const auto [a, b] = diagram.facetSites[static_cast<std::size_t>(facet)];
  const Vec3& first = diagram.sites[static_cast<std::size_t>(a)];
  const Vec3& second = diagram.sites[static_cast<std::size_t>(b)];
  return (second - first).normalized().dot(p - 0.5 * (first + second));
}

// By how much another site is nearer to p than `site` is.
double intrusion(const Diagram& diagram, const Vec3& site, const Vec3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& other : diagram.sites) nearest = std::min(nearest, (other - p).norm());
  return (site - p).norm() - nearest;
}

TEST(Clip, CellsOfABoxAreWhatHalfSpacesLeave) {
  const auto form = implicit::box(Vec3(2, 2, 2));
  const Box3 box(Vec3::Constant(-1), Vec3::Constant(1));
  const auto sites = testing::sitesInBox(400, 1, box);
  std::vector<testing::HalfSpaceCell> reference;
  for (std::size_t i = 0; i < sites.size(); ++i) reference.push_back(testing::referenceCell(sites, i, box));
  for (const CapKind cap : kAllCaps) {
    const auto result = testing::tessellateSites(sites, *form, {.cap = cap});
    ASSERT_EQ(result.complex.cellCount, 400);
    EXPECT_TRUE(testing::sameBits(result.complex.cellSites, sites));
    const auto cells = momentsOf(result);
    int interior = 0;
    int onOneSide = 0;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const testing::ReferenceMoments expected = reference[i].moments();
      const double size = std::cbrt(expected.volume);
      if (reference[i].boxFaces() > 1) {
        // Where the cell has a piece of the box's edge, the cap cuts it off.
        EXPECT_LT(cells[i].volume, (1 + 1e-9) * expected.volume);
        EXPECT_GT(cells[i].volume, 0);
        continue;
      }
      ++(reference[i].boxFaces() == 0 ? interior : onOneSide);
      EXPECT_NEAR(cells[i].volume, expected.volume, 1e-9 * expected.volume) << "site " << i;
      EXPECT_LT((cells[i].centroid - expected.centroid).norm(), 1e-9 * size) << "site " << i;
      EXPECT_NEAR(cells[i].secondMoment, expected.secondMoment, 1e-9 * expected.secondMoment) << "site " << i;
    }
    EXPECT_GT(interior, 100);
    EXPECT_GT(onOneSide, 100);
    EXPECT_LT(totalVolume(result), 8);
  }
}

TEST(Clip, SiteMomentsAreThoseOfTheFlatlyCappedCells) {
  std::vector<NamedForm> forms = smoothForms();
  forms.push_back({"gyroid-ball", implicit::gyroidBall()});
  for (const auto& [name, form] : forms) {
    const auto sites = testing::sitesInside(*form, 1500, 2);
    const auto result = testing::tessellateSites(sites, *form, {.cap = CapKind::flat});
    const auto moments = siteMoments(result.diagram, result.clipped, {});
    const auto cells = momentsOf(result);
    // Caps that crossed were set apart, which siteMoments does not do: those few cells may differ.
    Index different = 0;
    std::size_t cell = 0;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (cell == cells.size() || result.complex.cellSites[cell] != sites[i]) {
        EXPECT_LT(std::abs(moments[i].mass), 1e-15) << name << ": a site without a cell";
        continue;
      }
      const double volume = cells[cell].volume;
      const Vec3 offset = cells[cell].centroid - sites[i];
      const double second = cells[cell].secondMoment + volume * offset.squaredNorm();
      ++cell;
      const bool same = std::abs(moments[i].mass - volume) <= 1e-10 * volume &&
                        (moments[i].first - volume * offset).norm() <= 1e-10 * volume * std::cbrt(volume) &&
                        std::abs(moments[i].second - second) <= 1e-10 * second;
      if (!same) ++different;
    }
    EXPECT_EQ(cell, cells.size()) << name;
    EXPECT_LE(different, name == "gyroid-ball" ? result.clipped.summary.fallbackCaps : 0) << name;
  }
}

TEST(Clip, RootsLieOnTheSurfaceAndOnTheirEdge) {
  for (const auto& [name, form] : smoothForms()) {
    const auto sites = testing::sitesInside(*form, 800, 3);
    const Diagram diagram = buildDiagram(sites, testing::domainOf(*form), {});
    const ClippedDiagram clipped = clip(diagram, *form, {.cap = CapKind::flat}, {});
    ASSERT_EQ(clipped.rootSites.size(), static_cast<std::size_t>(clipped.rootCount));
    EXPECT_GT(clipped.rootCount, 500);
    for (std::size_t r = 0; r < clipped.rootSites.size(); ++r) {
      EXPECT_NEAR(form->value(clipped.points[r]), 0, kOnSurface) << name;
      const auto& three = clipped.rootSites[r];
      EXPECT_LT(three[0], three[1]);
      EXPECT_LT(three[1], three[2]);
      for (const Index s : three) {
        EXPECT_LT(intrusion(diagram, diagram.sites[static_cast<std::size_t>(s)], clipped.points[r]), kInPlane);
      }
    }
    for (std::size_t v = 0; v < diagram.vertices.size(); ++v) {
      EXPECT_EQ(clipped.inside[v] == 1, form->value(diagram.vertices[v]) < 0) << name;
    }
  }
}

TEST(Clip, FacetsKeepTheirInsideVerticesAndChordPoints) {
  const auto form = implicit::transformed(implicit::bumpySphere(), randomRotation(3), Vec3::Zero());
  const auto sites = testing::sitesInside(*form, 800, 4);
  const Diagram diagram = buildDiagram(sites, testing::domainOf(*form), {});
  const ClippedDiagram clipped = clip(diagram, *form, {.cap = CapKind::cvt3}, {});
  using State = ClippedDiagram::FacetState;
  std::vector<int> kept(diagram.facetSites.size(), 0);
  for (Index p = 0; p < clipped.polygonCount(); ++p) {
    const auto facet = static_cast<std::size_t>(clipped.polygonFacets[static_cast<std::size_t>(p)]);
    EXPECT_EQ(clipped.facetStates[facet], State::cut);
    const Vec3 normal = diagram.sites[static_cast<std::size_t>(diagram.facetSites[facet][1])] -
                        diagram.sites[static_cast<std::size_t>(diagram.facetSites[facet][0])];
    Vec3 area = Vec3::Zero();
    const auto polygon = clipped.polygon(p);
    ASSERT_GE(polygon.size(), 3U);
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      if (polygon[k] < diagram.vertexCount()) {
        EXPECT_EQ(clipped.inside[static_cast<std::size_t>(polygon[k])], 1);
        ++kept[facet];
      }
      const Vec3& a = clipped.position(diagram, polygon[k]);
      const Vec3& b = clipped.position(diagram, polygon[(k + 1) % polygon.size()]);
      EXPECT_NEAR(distanceToPlane(diagram, static_cast<Index>(facet), a), 0, kInPlane);
      area += (a - diagram.sites[0]).cross(b - diagram.sites[0]);
    }
    EXPECT_GT(normal.dot(area), 0) << "runs like the facet";
  }
  for (Index f = 0; f < diagram.facetCount(); ++f) {
    const auto loop = diagram.facet(f);
    const auto inside = std::count_if(loop.begin(), loop.end(),
                                      [&](Index v) { return clipped.inside[static_cast<std::size_t>(v)] != 0; });
    const State state = clipped.facetStates[static_cast<std::size_t>(f)];
    const std::ptrdiff_t whole = state == State::whole ? std::ssize(loop) : 0;
    EXPECT_EQ(inside, state == State::cut ? kept[static_cast<std::size_t>(f)] : whole);
  }

  std::size_t points = 0;
  for (const Chord& chord : clipped.chords) {
    EXPECT_EQ(clipped.facetStates[static_cast<std::size_t>(chord.facet)], State::cut);
    if (chord.point == kNone) continue;
    const Vec3& p = clipped.position(diagram, chord.point);
    EXPECT_NEAR(form->value(p), 0, kOnSurface);
    EXPECT_NEAR(distanceToPlane(diagram, chord.facet, p), 0, kInPlane);
    const Index owner = diagram.facetSites[static_cast<std::size_t>(chord.facet)][0];
    EXPECT_LT(intrusion(diagram, diagram.sites[static_cast<std::size_t>(owner)], p), kInPlane) << "inside its facet";
    EXPECT_EQ(clipped.chordPointFacets[points++], chord.facet);
  }
  EXPECT_EQ(points, clipped.chordPointFacets.size());
  EXPECT_EQ(clipped.points.size(), static_cast<std::size_t>(clipped.rootCount) + points);
  EXPECT_GT(static_cast<double>(points), 0.95 * static_cast<double>(clipped.chords.size()));
}

TEST(Clip, LoopsAreMadeOfTheCellsChords) {
  const auto form = implicit::torus(1, 0.4);
  const auto sites = testing::sitesInside(*form, 600, 5);
  const Diagram diagram = buildDiagram(sites, testing::domainOf(*form), {});
  const ClippedDiagram clipped = clip(diagram, *form, {.cap = CapKind::cvt3}, {});
  EXPECT_EQ(clipped.loopCount(), clipped.summary.loops);
  EXPECT_TRUE(std::is_sorted(clipped.loopSites.begin(), clipped.loopSites.end()));
  std::size_t corners = 0;
  for (Index l = 0; l < clipped.loopCount(); ++l) {
    const Vec3& site = diagram.sites[static_cast<std::size_t>(clipped.loopSites[static_cast<std::size_t>(l)])];
    const auto loop = clipped.loop(l);
    corners += loop.size();
    Vec3 normal = Vec3::Zero();
    Vec3 mean = Vec3::Zero();
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3& p = clipped.position(diagram, loop[k]);
      EXPECT_LT(intrusion(diagram, site, p), kInPlane) << "on the border of its cell";
      normal += (p - site).cross(clipped.position(diagram, loop[(k + 1) % loop.size()]) - site);
      mean += p / static_cast<double>(loop.size());
    }
    EXPECT_GT(normal.dot(form->gradient(mean)), 0) << "counter-clockwise seen from outside";
  }
  // Each chord belongs to two cells, and every point of a loop is a chord's begin or its extra point.
  EXPECT_EQ(corners, 2 * (clipped.chords.size() + clipped.chordPointFacets.size()));
}

TEST(Clip, BoundaryVerticesLieOnTheSurfaceAndInTheirCell) {
  for (const auto& [name, form] : smoothForms()) {
    const auto sites = testing::relaxed(testing::sitesInside(*form, 600, 6), *form, 3);
    for (const CapKind cap : {CapKind::cvt1, CapKind::cvt2, CapKind::cvt3}) {
      const auto result = testing::tessellateSites(sites, *form, {.cap = cap});
      const ClipSummary& summary = result.clipped.summary;
      std::vector<std::uint8_t> onBoundary(result.complex.vertices.size(), 0);
      for (Index f = 0; f < result.complex.faceCount(); ++f) {
        const Index cell = result.complex.faceCells[static_cast<std::size_t>(f)][0];
        for (const Index v : result.complex.face(f)) {
          if (!result.complex.isBoundary(f)) continue;
          onBoundary[static_cast<std::size_t>(v)] = 1;
          EXPECT_LT(intrusion(result.diagram, result.complex.cellSites[static_cast<std::size_t>(cell)],
                              result.complex.vertices[static_cast<std::size_t>(v)]),
                    kInPlane);
        }
      }
      Index offSurface = 0;
      for (std::size_t v = 0; v < onBoundary.size(); ++v) {
        const double value = form->value(result.complex.vertices[v]);
        if (onBoundary[v] == 0) {
          EXPECT_LT(value, 0) << "a vertex within the solid";
        } else if (std::abs(value) > kOnSurface) {
          ++offSurface;
        }
      }
      if (cap == CapKind::cvt1) {
        EXPECT_LE(offSurface, summary.fallbackCaps) << name;
      } else {
        EXPECT_LE(offSurface, summary.unprojectedPoints + summary.fallbackCaps) << name;
      }
    }
  }
}

TEST(Clip, CapsOnSmoothShapesHardlyEverFallBack) {
  constexpr double kShare = 0.01;
  for (const auto& [name, form] : smoothForms()) {
    const auto sites = testing::relaxed(testing::sitesInside(*form, 3000, 7), *form, 5);
    for (const CapKind cap : {CapKind::cvt1, CapKind::cvt2, CapKind::cvt3}) {
      const ClipSummary summary = testing::tessellateSites(sites, *form, {.cap = cap}).clipped.summary;
      EXPECT_EQ(summary.crossingCells, 0) << name;
      EXPECT_LE(summary.fallbackCaps, kShare * summary.loops) << name;
      EXPECT_LE(summary.unprojectedPoints, kShare * (summary.capPoints + summary.chordPoints)) << name;
      EXPECT_EQ(summary.capPoints, cap == CapKind::cvt1 ? 0 : summary.loops) << name;
      EXPECT_EQ(summary.chordPoints > 0, cap == CapKind::cvt3) << name;
      EXPECT_GE(summary.loops, summary.boundaryCells);
      EXPECT_GT(summary.oracleShare, 0.5) << name;
    }
  }
}

TEST(Clip, VolumeOfASphereConvergesWithOrderTwo) {
  const auto form = implicit::sphere(1);
  const double exact = 4 * std::numbers::pi / 3;
  const double counts[] = {400, 1600, 6400};
  for (const CapKind cap : {CapKind::flat, CapKind::cvt1, CapKind::cvt2, CapKind::cvt3}) {
    std::vector<double> errors;
    for (const double count : counts) {
      const auto sites = testing::relaxed(testing::sitesInside(*form, static_cast<std::size_t>(count), 8), *form, 5);
      errors.push_back(exact - totalVolume(testing::tessellateSites(sites, *form, {.cap = cap})));
      EXPECT_GT(errors.back(), 0) << "inscribed";
    }
    // The cells' size falls like count^(−1/3).
    for (std::size_t k = 0; k + 1 < errors.size(); ++k) {
      const double order = std::log(errors[k] / errors[k + 1]) / std::log(std::cbrt(counts[k + 1] / counts[k]));
      EXPECT_NEAR(order, 2, 0.3) << "cap " << static_cast<int>(cap) << ", from " << counts[k] << " sites";
    }
  }
}

TEST(Clip, BetterCapsLoseLessVolume) {
  const auto form = implicit::sphere(1);
  const auto sites = testing::relaxed(testing::sitesInside(*form, 1000, 9), *form, 5);
  const auto lost = [&](CapKind cap) {
    return 4 * std::numbers::pi / 3 - totalVolume(testing::tessellateSites(sites, *form, {.cap = cap}));
  };
  // Of inscribed polyhedra on the same loops the convex hull's is the largest; extra points on S add to it.
  EXPECT_LT(lost(CapKind::cvt1), lost(CapKind::flat));
  EXPECT_LT(lost(CapKind::cvt2), 0.8 * lost(CapKind::cvt1));
  EXPECT_LT(lost(CapKind::cvt3), 0.8 * lost(CapKind::cvt2));
}

TEST(Clip, WholeTessellationsAreValid) {
  for (const auto& [name, form] : smoothForms()) {
    const auto sites = testing::sitesInside(*form, 1000, 10);
    for (const CapKind cap : kAllCaps) {
      const auto result = testing::tessellateSites(sites, *form, {.cap = cap});
      const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
      EXPECT_THAT(certificate.problems, IsEmpty()) << name;
      EXPECT_EQ(certificate.components, 1) << name;
      EXPECT_EQ(certificate.eulerCharacteristic, name == "torus" ? 0 : 2) << name;
      EXPECT_EQ(result.clipped.summary.crossingCells, 0) << name;
    }
  }
}

}  // namespace
}  // namespace voroform::voronoi
