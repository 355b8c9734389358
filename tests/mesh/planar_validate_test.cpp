// The certificate of planar tessellations: what it accepts and what it must reject.
#include "voroform/mesh/planar_validate.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/planar_tessellations.hpp"
#include "voroform/mesh/planar_moments.hpp"

namespace voroform::mesh {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

PlanarCertificate certify(const PlanarTessellation& tessellation, const PlanarRegion& region) {
  PlanarValidateOptions options;
  options.pointSamples = 2000;
  return validate(tessellation, region, options, RunContext{});
}

PlanarCertificate certify(const PlanarTessellation& tessellation) {
  return certify(tessellation, testing::squareOf(4));
}

TEST(PlanarMoments, CellsWithHolesAndSeveralOutlines) {
  const auto moments = cellMoments(testing::ringAndIsland(), RunContext{});
  ASSERT_EQ(moments.size(), 2U);
  EXPECT_NEAR(moments[0].area, 35, 1e-13);
  EXPECT_NEAR(moments[0].centroid.x(), (32 * 3 + 3 * 26.0 / 3) / 35, 1e-13);
  EXPECT_NEAR(moments[0].centroid.y(), (32 * 3 + 3 * 1.0) / 35, 1e-13);
  EXPECT_NEAR(moments[1].area, 3, 1e-14);
  EXPECT_NEAR(moments[1].secondMoment, 2.5, 1e-13);
  EXPECT_THAT(boundaryCells(testing::ringAndIsland()), ::testing::ElementsAre(1, 1));
}

TEST(PlanarMoments, EmptyCellsHaveNone) {
  PlanarTessellation tessellation = testing::squares(1);
  tessellation.cellOffsets.push_back(tessellation.cellOffsets.back());
  tessellation.sites.emplace_back(9, 9);
  const auto moments = cellMoments(tessellation, RunContext{});
  ASSERT_EQ(moments.size(), 2U);
  EXPECT_EQ(moments[1].area, 0);
  EXPECT_EQ(moments[1].secondMoment, 0);
}

TEST(PlanarCertificate, AcceptsSquares) {
  const PlanarCertificate certificate = certify(testing::squares(4));
  EXPECT_TRUE(certificate.valid);
  EXPECT_TRUE(certificate.closed());
  EXPECT_THAT(certificate.problems, IsEmpty());
  EXPECT_EQ(certificate.boundaryLoops, 1);
  EXPECT_EQ(certificate.boundaryError, 0);
  EXPECT_EQ(certificate.area, 16);
  EXPECT_EQ(certificate.areaError, 0);
  EXPECT_GT(certificate.pointSamples, 1990);
}

TEST(PlanarCertificate, AcceptsHolesAndSeveralOutlines) {
  // One site: its cell is the region.
  const PlanarTessellation ring =
      testing::joinLoops({{0, 0}, {6, 0}, {6, 6}, {0, 6}, {2, 2}, {4, 2}, {4, 4}, {2, 4}, {8, 0}, {10, 0}, {8, 3}},
                         {{{0, 1, 2, 3}, {4, 7, 6, 5}, {8, 9, 10}}}, {{1, 1}});
  const PlanarRegion region(std::vector<std::vector<Vec2>>{
      {{0, 0}, {6, 0}, {6, 6}, {0, 6}}, {{2, 2}, {4, 2}, {4, 4}, {2, 4}}, {{8, 0}, {10, 0}, {8, 3}}});
  const PlanarCertificate certificate = certify(ring, region);
  EXPECT_THAT(certificate.problems, IsEmpty());
  EXPECT_EQ(certificate.boundaryLoops, 3);
  EXPECT_NEAR(certificate.area, 35, 1e-12);
}

TEST(PlanarCertificate, SameForAnyNumberOfThreads) {
  PlanarTessellation tessellation = testing::squares(4);
  tessellation.vertices[6] += Vec2(0.2, 0.3);
  RunContext one;
  one.threads = 1;
  RunContext two;
  two.threads = 2;
  const auto a = validate(tessellation, testing::squareOf(4), {}, one);
  const auto b = validate(tessellation, testing::squareOf(4), {}, two);
  EXPECT_GT(a.pointViolations, 0);
  EXPECT_EQ(a.pointViolations, b.pointViolations);
  EXPECT_EQ(a.problems, b.problems);
}

TEST(PlanarCertificate, RejectsCellsThatAreNotVoronoi) {
  PlanarTessellation moved = testing::squares(4);
  moved.vertices[6] += Vec2(0.2, 0.3);  // an inner one: all edges still match
  const PlanarCertificate certificate = certify(moved);
  EXPECT_FALSE(certificate.valid);
  EXPECT_TRUE(certificate.closed());
  EXPECT_LE(certificate.areaError, 1e-15);
  EXPECT_GT(certificate.pointViolations, 0);

  PlanarTessellation swapped = testing::squares(4);
  std::swap(swapped.sites[0], swapped.sites[1]);
  EXPECT_GT(certify(swapped).pointViolations, 0);
}

TEST(PlanarCertificate, RejectsCellsThatCoverOthers) {
  PlanarTessellation folded = testing::squares(4);
  folded.vertices[6] = Vec2(2.8, 1);  // beyond its neighbor, vertex 7: no area is lost, edges match
  const PlanarCertificate certificate = certify(folded);
  EXPECT_TRUE(certificate.closed());
  EXPECT_LE(certificate.areaError, 1e-15);
  EXPECT_GT(certificate.pointViolations, 0);
  EXPECT_FALSE(certificate.valid);
}

TEST(PlanarCertificate, RejectsABoundaryOffTheRegion) {
  PlanarTessellation moved = testing::squares(4);
  moved.vertices[0] += Vec2(-1e-6, -1e-6);
  const PlanarCertificate certificate = certify(moved);
  EXPECT_FALSE(certificate.valid);
  EXPECT_EQ(certificate.strayEdges, 2);
  EXPECT_GT(certificate.boundaryError, 1e-8);
  EXPECT_GT(certificate.areaError, 1e-8);

  // Of the same area and lengths, but elsewhere.
  PlanarTessellation shifted = testing::squares(4);
  for (Vec2& vertex : shifted.vertices) vertex += Vec2(1e-6, 0);
  EXPECT_GT(certify(shifted).strayEdges, 0);
  EXPECT_FALSE(certify(shifted).valid);
}

TEST(PlanarCertificate, RejectsFilledHoles) {
  const PlanarRegion ring(
      std::vector<std::vector<Vec2>>{{{0, 0}, {4, 0}, {4, 4}, {0, 4}}, {{1, 1}, {2, 1}, {2, 2}, {1, 2}}});
  const PlanarCertificate certificate = certify(testing::squares(4), ring);
  EXPECT_FALSE(certificate.valid);
  EXPECT_EQ(certificate.boundaryLoops, 1);
  EXPECT_EQ(certificate.rings, 2);
  EXPECT_THAT(certificate.problems, Contains(HasSubstr("loops is 1, that of the region's rings 2")));
  EXPECT_NEAR(certificate.areaError, 1.0 / 15, 1e-12);
  EXPECT_GT(certificate.pointViolations, 0);
}

TEST(PlanarCertificate, RejectsEdgesThatDoNotMatch) {
  PlanarTessellation wrong = testing::squares(4);
  wrong.neighbors[1] = 5;  // of cell 0, towards cell 1
  EXPECT_EQ(certify(wrong).unmatchedEdges, 2);
  EXPECT_FALSE(certify(wrong).valid);

  PlanarTessellation wrongBack = testing::squares(4);
  wrongBack.neighbors[4 + 3] = 5;  // of cell 1, towards cell 0
  EXPECT_EQ(certify(wrongBack).unmatchedEdges, 2);

  // Both cells say that their common edge is the boundary.
  PlanarTessellation cut = testing::squares(4);
  cut.neighbors[1] = kNone;
  cut.neighbors[4 + 3] = kNone;
  EXPECT_EQ(certify(cut).unmatchedEdges, 2);
  EXPECT_FALSE(certify(cut).closed());

  PlanarTessellation turned = testing::squares(4);
  std::swap(turned.loopVertices[1], turned.loopVertices[3]);
  EXPECT_GT(certify(turned).unmatchedEdges, 0);
  EXPECT_EQ(certify(turned).nonPositiveAreas, 1);
}

TEST(PlanarCertificate, RejectsMissingAndDoubleCells) {
  PlanarTessellation missing = testing::squares(4);
  missing.cellOffsets.pop_back();
  missing.loopOffsets.pop_back();
  missing.loopVertices.resize(60);
  missing.neighbors.resize(60);
  missing.sites.pop_back();
  for (Index& neighbor : missing.neighbors) neighbor = neighbor == 15 ? kNone : neighbor;
  const PlanarCertificate without = certify(missing);
  EXPECT_TRUE(without.closed());
  EXPECT_EQ(without.strayEdges, 2);
  EXPECT_NEAR(without.areaError, 1.0 / 16, 1e-12);
  EXPECT_GT(without.pointViolations, 0);
  EXPECT_FALSE(without.valid);

  PlanarTessellation twice = testing::squares(1);
  for (const Index v : {0, 1, 3, 2}) twice.loopVertices.push_back(v);
  twice.neighbors.resize(8, kNone);
  twice.loopOffsets.push_back(8);
  twice.cellOffsets.push_back(2);
  twice.sites.emplace_back(0.4, 0.4);
  const PlanarCertificate both = certify(twice, testing::squareOf(1));
  EXPECT_EQ(both.unmatchedEdges, 8);
  EXPECT_EQ(both.openVertices, 4);
  EXPECT_NEAR(both.areaError, 1, 1e-12);
  EXPECT_GT(both.pointViolations, 0);
}

TEST(PlanarCertificate, RejectsEmptyCells) {
  PlanarTessellation tessellation = testing::squares(4);
  tessellation.cellOffsets.push_back(tessellation.cellOffsets.back());
  tessellation.sites.emplace_back(0.5, 0.5);
  EXPECT_EQ(certify(tessellation).nonPositiveAreas, 1);
  EXPECT_FALSE(certify(tessellation).valid);
}

TEST(PlanarCertificate, RejectsNumbersThatAreNotFinite) {
  PlanarTessellation vertex = testing::squares(4);
  vertex.vertices[6].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(certify(vertex).nonFiniteVertices, 1);
  PlanarTessellation site = testing::squares(4);
  site.sites[3].y() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(certify(site).nonFiniteVertices, 1);
  EXPECT_FALSE(certify(vertex).valid);
  EXPECT_FALSE(certify(site).valid);
}

TEST(PlanarCertificate, RejectsIndicesOutOfRange) {
  const auto loops = [](auto change) {
    PlanarTessellation tessellation = testing::squares(4);
    change(tessellation);
    const PlanarCertificate certificate = certify(tessellation);
    EXPECT_FALSE(certificate.valid);
    return certificate.invalidLoops;
  };
  EXPECT_EQ(loops([](auto& t) { t.loopVertices[2] = 25; }), 1);
  EXPECT_EQ(loops([](auto& t) { t.loopVertices[2] = -1; }), 1);
  EXPECT_EQ(loops([](auto& t) { t.loopVertices[2] = t.loopVertices[0]; }), 1);
  EXPECT_EQ(loops([](auto& t) { t.neighbors[2] = 16; }), 1);
  EXPECT_EQ(loops([](auto& t) { t.neighbors[2] = -2; }), 1);
  EXPECT_EQ(loops([](auto& t) { t.neighbors[2] = 0; }), 1);
  EXPECT_EQ(loops([](auto& t) { t.loopOffsets[1] = 2; }), 2) << "one of two vertices, one with a vertex twice";
  EXPECT_EQ(loops([](auto& t) { t.loopOffsets[1] = 200; }), 1);
  EXPECT_EQ(loops([](auto& t) { t.cellOffsets.back() = 15; }), 1);
  EXPECT_EQ(loops([](auto& t) { t.cellOffsets.clear(); }), 1);
  EXPECT_EQ(loops([](auto& t) { t.neighbors.pop_back(); }), 1);
  EXPECT_EQ(loops([](auto& t) { t.sites.pop_back(); }), 1);
}

TEST(PlanarCertificate, NamesTheFirstOfEachKind) {
  PlanarTessellation moved = testing::squares(4);
  moved.vertices[0] += Vec2(-1e-3, 0);
  EXPECT_THAT(certify(moved).problems, Contains(HasSubstr("2 boundary edges off the region's boundary")));
  EXPECT_THAT(certify(moved).problems, Contains(HasSubstr("areas add up to")));
}

}  // namespace
}  // namespace voroform::mesh
