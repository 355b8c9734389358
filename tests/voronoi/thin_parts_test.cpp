// Parts thinner than a cell: sheets, gaps, cells with several caps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/voronoi_sites.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/surface_locator.hpp"
#include "voroform/mesh/validate.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {
namespace {

using ::testing::IsEmpty;

constexpr CapKind kCaps[] = {CapKind::cvt1, CapKind::cvt2, CapKind::cvt3};

const Mat3 kRotation = randomRotation(7);

implicit::ImplicitPtr sheet(double thickness, double offset = 0) {
  return implicit::transformed(implicit::box(Vec3(2, 2, thickness)), kRotation, kRotation * Vec3(0, 0, offset));
}

// Share of the points of the region (a box in the sheet's frame) that lie inside the complex.
double coveredShare(const mesh::PolyhedralComplex& complex, const Box3& region) {
  constexpr std::uint64_t kSamples = 4000;
  const mesh::BoundarySurface surface = mesh::boundarySurface(complex);
  const mesh::SurfaceLocator locator(surface.mesh, 0, 1e-9);
  int inside = 0;
  for (std::uint64_t i = 0; i < kSamples; ++i) {
    const Vec3 p = kRotation * randomInBox(9, RandomStream::test, i, region);
    if (locator.locate(p) == mesh::Location::inside) ++inside;
  }
  return inside / static_cast<double>(kSamples);
}

// A region of the sheet, two cells away from its rim.
Box3 middleOf(double thickness, double margin) {
  const Vec3 half(1 - margin, 1 - margin, 0.5 * thickness);
  return {-half, half};
}

// n × n sites in the middle plane of a 2 × 2 sheet, jittered within it.
std::vector<Vec3> sheetSites(int n, std::uint64_t seed, double offset = 0) {
  const double spacing = 2.0 / n;
  const Box3 square(Vec3(-0.25, -0.25, 0), Vec3(0.25, 0.25, 0));
  std::vector<Vec3> sites;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const Vec3 place(i - 0.5 * (n - 1), j - 0.5 * (n - 1), 0);
      const Vec3 local = spacing * (place + randomInBox(seed, RandomStream::test, sites.size(), square));
      sites.push_back(kRotation * (local + Vec3(0, 0, offset)));
    }
  }
  return sites;
}

TEST(ThinParts, EachCellOfASheetHasACapOnBothSides) {
  constexpr int kSide = 12;
  constexpr double kThickness = 0.08;  // half the sites' spacing
  const auto form = sheet(kThickness);
  for (const CapKind cap : kCaps) {
    const auto result = testing::tessellateSites(sheetSites(kSide, 1), *form, {.cap = cap});
    const ClipSummary& summary = result.clipped.summary;
    EXPECT_EQ(summary.multiLoopCells, (kSide - 2) * (kSide - 2));
    EXPECT_EQ(summary.loops - summary.boundaryCells, summary.multiLoopCells) << "two caps each, not three";
    EXPECT_GT(summary.doubleRootEdges, 0);
    // Cells at the rim may be too small for their caps; no other may be lost.
    EXPECT_GE(result.complex.cellCount, (kSide - 2) * (kSide - 2));
    const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
    EXPECT_THAT(certificate.problems, IsEmpty());
    EXPECT_EQ(certificate.components, 1);
    EXPECT_EQ(certificate.eulerCharacteristic, 2);
    // The caps of the rim's cells cut off the rim; cells within are exact.
    EXPECT_LT(certificate.volume, 4 * kThickness);
    EXPECT_EQ(coveredShare(result.complex, middleOf(kThickness * (1 - 1e-6), 4.0 / kSide)), 1);
  }
}

TEST(ThinParts, SheetOfHalfTheCellSizeIsNotLost) {
  // With n sites the cells' size is h = (4t/n)^(1/3); t = h/2 means h² = 2/n.
  constexpr std::size_t kSites = 800;
  const double thickness = 0.5 * std::sqrt(2.0 / kSites);
  const auto form = sheet(thickness);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto sites = testing::relaxed(testing::sitesInside(*form, kSites, seed), *form, 4);
    for (const CapKind cap : kCaps) {
      const auto result = testing::tessellateSites(sites, *form, {.cap = cap});
      const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
      EXPECT_THAT(certificate.problems, IsEmpty());
      EXPECT_EQ(certificate.components, 1);
      EXPECT_EQ(certificate.eulerCharacteristic, 2);
      // Only the rim is cut off, by half a cell.
      EXPECT_GE(coveredShare(result.complex, middleOf(thickness, 0.15)), 0.998);
      EXPECT_LT(certificate.volume, 4 * thickness);
      EXPECT_GT(certificate.volume, 0.82 * 4 * thickness);
      EXPECT_GE(result.complex.cellCount, static_cast<Index>(0.97 * kSites));
      EXPECT_GT(result.clipped.summary.multiLoopCells, static_cast<Index>(kSites) / 2);
    }
  }
}

TEST(ThinParts, SheetIsKeptUpToItsRim) {
  // Beyond the last edges that meet it the sheet goes on within the facets of neighbors at the rim, up to where it
  // ends.
  constexpr int kSide = 12;
  constexpr double kThickness = 0.04;
  const auto form = sheet(kThickness);
  const auto sites = sheetSites(kSide, 1);
  const auto flat = testing::tessellateSites(sites, *form, {.cap = CapKind::flat});
  Index atRim = 0;
  for (std::size_t i = 0; i < flat.clipped.chordPointFacets.size(); ++i) {
    const Vec3 p = kRotation.transpose() * flat.clipped.points[static_cast<std::size_t>(flat.clipped.rootCount) + i];
    const double side = std::max(std::abs(p.x()), std::abs(p.y()));
    EXPECT_LT(std::min(std::abs(side - 1), std::abs(std::abs(p.z()) - 0.5 * kThickness)), 1e-9) << "not on the surface";
    if (std::abs(side - 1) < 1e-9) ++atRim;
  }
  EXPECT_GE(atRim, 4 * (kSide - 2));
  EXPECT_EQ(flat.clipped.summary.tonguePoints, static_cast<Index>(flat.clipped.chordPointFacets.size()));
  EXPECT_EQ(flat.clipped.summary.tips, 0) << "flat caps search none";
  for (const CapKind cap : kCaps) {
    const auto result = testing::tessellateSites(sites, *form, {.cap = cap});
    const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
    EXPECT_THAT(certificate.problems, IsEmpty());
  }
}

// A cone with its tip at (0, 0, 1) and slope 1/4, down to z = −1, turned.
class Cone final : public implicit::ImplicitFunction {
 public:
  double value(const Vec3& p) const override {
    const Vec3 q = kRotation.transpose() * p;
    return std::max(std::hypot(q.x(), q.y()) - 0.25 * (1 - q.z()), -1 - q.z());
  }
  Vec3 gradient(const Vec3& p) const override {
    const Vec3 q = kRotation.transpose() * p;
    return kRotation * Vec3(q.x(), q.y(), 0.25 * std::hypot(q.x(), q.y())).normalized();
  }
  Box3 bounds() const override { return {Vec3::Constant(-1.2), Vec3::Constant(1.2)}; }
};

TEST(ThinParts, CapsReachTheTipOfACone) {
  // One cell holds the end of the cone from about z = −0.1 on, and no edge of the diagram meets it beyond.
  const Cone form;
  const Vec3 tip = kRotation * Vec3(0, 0, 1);
  Index tipsOfChords = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    auto sites = testing::sitesInside(form, 300, seed);
    sites.erase(std::remove_if(sites.begin(), sites.end(),
                               [](const Vec3& p) { return (kRotation.transpose() * p).z() > -0.2; }),
                sites.end());
    sites.emplace_back(0, 0, 0);
    for (const CapKind cap : {CapKind::cvt2, CapKind::cvt3}) {
      const auto result = testing::tessellateSites(sites, form, {.cap = cap});
      const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
      EXPECT_THAT(certificate.problems, IsEmpty());
      double nearest = 1;
      for (const Vec3& vertex : result.complex.vertices) nearest = std::min(nearest, (vertex - tip).norm());
      EXPECT_LT(nearest, 0.03) << "seed " << seed;
      EXPECT_GE(result.clipped.summary.tips, 1) << "seed " << seed;
      tipsOfChords += clip(result.diagram, form, {.cap = cap}, {}).summary.tips;
    }
  }
  EXPECT_GE(tipsOfChords, 1);
}

TEST(ThinParts, TwoSheetsStayApart) {
  constexpr double kThickness = 0.08;
  constexpr double kGap = 0.02;
  const double offset = 0.5 * (kThickness + kGap);
  const auto form = implicit::unionOf(sheet(kThickness, offset), sheet(kThickness, -offset));
  auto sites = sheetSites(12, 2, offset);
  const auto below = sheetSites(12, 2, -offset);
  sites.insert(sites.end(), below.begin(), below.end());
  for (const CapKind cap : kCaps) {
    const auto result = testing::tessellateSites(sites, *form, {.cap = cap});
    const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
    EXPECT_THAT(certificate.problems, IsEmpty());
    EXPECT_EQ(certificate.components, 2);
    EXPECT_EQ(certificate.eulerCharacteristic, 4);
    // All of both sheets, and nothing of the gap.
    const Box3 middle = middleOf(kThickness * (1 - 1e-6), 4.0 / 12);
    for (const double side : {-1.0, 1.0}) {
      const Vec3 shift(0, 0, side * offset);
      EXPECT_EQ(coveredShare(result.complex, Box3(middle.min() + shift, middle.max() + shift)), 1);
    }
    EXPECT_EQ(coveredShare(result.complex, middleOf(kGap * (1 - 1e-6), 0)), 0);
  }
}

TEST(ThinParts, GapWithinASolidStaysOpen) {
  // A slit of half the cells' size within a box: the boundary has a second component, and the volume lacks the slit's.
  const double slit = 0.06;
  const auto form = implicit::differenceOf(
      implicit::transformed(implicit::box(Vec3(1, 1, 1)), kRotation, Vec3::Zero()),
      implicit::transformed(implicit::box(Vec3(0.6, 0.6, slit)), randomRotation(8), Vec3(0.01, 0.02, 0)));
  const double exact = 1 - 0.36 * slit;
  const auto sites = testing::relaxed(testing::sitesInside(*form, 800, 4), *form, 4);
  for (const CapKind cap : kCaps) {
    const auto result = testing::tessellateSites(sites, *form, {.cap = cap});
    const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
    EXPECT_THAT(certificate.problems, IsEmpty());
    EXPECT_EQ(certificate.components, 2);
    EXPECT_NEAR(certificate.volume, exact, 0.03 * exact);
    EXPECT_EQ(result.clipped.summary.crossingCells, 0);
  }
}

TEST(ThinParts, CellAroundACavityHasTwoCaps) {
  // The Voronoi cell of the middle site holds a cavity's piece on one side and the outer surface on another.
  const auto form = implicit::differenceOf(implicit::sphere(1), implicit::sphere(0.5));
  const auto sites = testing::sitesInside(*form, 150, 5);
  for (const CapKind cap : kCaps) {
    const auto result = testing::tessellateSites(sites, *form, {.cap = cap});
    EXPECT_GT(result.clipped.summary.multiLoopCells, 0);
    EXPECT_EQ(result.clipped.summary.loops - result.clipped.summary.boundaryCells,
              result.clipped.summary.multiLoopCells)
        << "two caps each";
    const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
    EXPECT_THAT(certificate.problems, IsEmpty());
    EXPECT_EQ(certificate.components, 2);
    EXPECT_EQ(certificate.eulerCharacteristic, 4);
  }
}

TEST(ThinParts, WhatNoEdgeMeetsIsLostAndCounted) {
  // One or two sites in a sphere: no edge of their diagram meets it.
  const auto form = implicit::sphere(1);
  for (const std::size_t count : {1U, 2U}) {
    const auto sites = testing::sitesInside(*form, count, 6);
    const auto result = testing::tessellateSites(sites, *form, {});
    EXPECT_EQ(result.complex.cellCount, 0);
    EXPECT_EQ(result.complex.faceCount(), 0);
    EXPECT_EQ(result.clipped.summary.roots, 0);
    for (const SiteMoments& site : siteMoments(result.diagram, result.clipped, {})) EXPECT_EQ(site.mass, 0);
  }
}

}  // namespace
}  // namespace voroform::voronoi
