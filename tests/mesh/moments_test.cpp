#include "voroform/mesh/moments.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/complexes.hpp"
#include "voroform/core/random.hpp"

namespace voroform::mesh {
namespace {

// A few operations' rounding relative to the result.
constexpr double kRounding = 1e-13;

CellMoments onlyCell(const PolyhedralComplex& complex) {
  const auto moments = cellMoments(complex, RunContext{});
  EXPECT_EQ(moments.size(), 1U);
  return moments.at(0);
}

double regularity(const CellMoments& cell) { return cell.secondMoment / (3 * std::pow(cell.volume, 5.0 / 3)); }

TEST(CellMoments, BoxMatchesClosedForm) {
  const Vec3 edges(2, 3, 5);
  const Vec3 corner(-1, 4, 0.5);
  const CellMoments box = onlyCell(testing::mapped(testing::block(1), edges.asDiagonal(), corner));
  EXPECT_NEAR(box.volume, 30, 30 * kRounding);
  EXPECT_LE((box.centroid - (corner + edges / 2)).norm(), 10 * kRounding);
  // ∫ x² over an edge a, centered: a²/12 times the volume.
  EXPECT_NEAR(box.secondMoment, 30 * edges.squaredNorm() / 12, 100 * kRounding);
}

TEST(CellMoments, RegularPolyhedraHaveTheirKnownRegularity) {
  // Thesis, table 3.1; closed forms after Conway and Sloane.
  EXPECT_NEAR(regularity(onlyCell(testing::block(1))), 1.0 / 12, kRounding);
  EXPECT_NEAR(regularity(onlyCell(testing::tetrahedron())), std::pow(3.0, 2.0 / 3) / 20, kRounding);
  EXPECT_NEAR(regularity(onlyCell(testing::truncatedOctahedron())), 19 / (192 * std::cbrt(2.0)), 1e-12);
  const CellMoments cell = onlyCell(testing::truncatedOctahedron());
  EXPECT_NEAR(cell.volume, 32, 32 * kRounding);
  EXPECT_LE(cell.centroid.norm(), kRounding);
}

TEST(CellMoments, InvariantUnderRigidMotionsAndScale) {
  const CellMoments before = onlyCell(testing::truncatedOctahedron());
  const Mat3 rotation = randomRotation(7);
  const double scale = 0x1p-30;
  const CellMoments after = onlyCell(testing::mapped(testing::truncatedOctahedron(), scale * rotation, Vec3(3, 4, 5)));
  // Coordinates about 5 keep 2⁻⁵⁰ of the cell's size 2⁻²⁸: what is left of the digits.
  const double tolerance = 1e-15 / scale * 10;
  EXPECT_NEAR(after.volume / std::pow(scale, 3), before.volume, before.volume * tolerance);
  EXPECT_NEAR(regularity(after), regularity(before), tolerance);
  const CellMoments rotated = onlyCell(testing::mapped(testing::truncatedOctahedron(), rotation, Vec3::Zero()));
  EXPECT_NEAR(rotated.volume, before.volume, before.volume * kRounding);
  EXPECT_NEAR(rotated.secondMoment, before.secondMoment, before.secondMoment * kRounding);
}

TEST(CellMoments, LosesNoDigitsFarFromTheOrigin) {
  // 2²² keeps the cube's coordinates exact, so the only loss could come from the method.
  const double far = 0x1p22;
  const CellMoments cube = onlyCell(testing::mapped(testing::block(1), Mat3::Identity(), Vec3::Constant(far)));
  EXPECT_NEAR(cube.volume, 1, kRounding);
  EXPECT_NEAR(cube.secondMoment, 0.25, kRounding);
  EXPECT_EQ(cube.centroid, Vec3::Constant(far + 0.5));
}

TEST(CellMoments, SharedFaceCountsForBothCellsWithOppositeSides) {
  const auto moments = cellMoments(testing::cubes({{0, 0, 0}, {1, 0, 0}}), RunContext{});
  ASSERT_EQ(moments.size(), 2U);
  EXPECT_NEAR(moments[0].volume, 1, kRounding);
  EXPECT_NEAR(moments[1].volume, 1, kRounding);
  EXPECT_LE((moments[1].centroid - Vec3(1.5, 0.5, 0.5)).norm(), kRounding);
}

TEST(CellMoments, DisconnectedCellHasTheMomentsOfTheUnion) {
  PolyhedralComplex pair = testing::cubes({{0, 0, 0}, {4, 0, 0}});
  for (auto& cells : pair.faceCells) cells[0] = 0;
  pair.cellCount = 1;
  const CellMoments both = onlyCell(pair);
  EXPECT_NEAR(both.volume, 2, kRounding);
  EXPECT_LE((both.centroid - Vec3(2.5, 0.5, 0.5)).norm(), 10 * kRounding);
  // Two cubes, each ¼ about its own centroid, at the distance 2 (parallel axes).
  EXPECT_NEAR(both.secondMoment, 2 * (0.25 + 4), 100 * kRounding);
}

TEST(CellMoments, SameBitsForAnyNumberOfThreads) {
  const PolyhedralComplex complex = testing::mapped(testing::block(12), randomRotation(3), Vec3(0.1, 0.2, 0.3));
  RunContext one;
  one.threads = 1;
  RunContext four;
  four.threads = 4;
  const auto a = cellMoments(complex, one);
  const auto b = cellMoments(complex, four);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].volume, b[i].volume);
    EXPECT_EQ(a[i].secondMoment, b[i].secondMoment);
    EXPECT_EQ(a[i].centroid, b[i].centroid);
  }
}

TEST(EnclosedVolume, SignFollowsTheOrientation) {
  TriangleMesh mesh = boundarySurface(testing::truncatedOctahedron()).mesh;
  EXPECT_NEAR(enclosedVolume(mesh), 32, 32 * kRounding);
  for (auto& triangle : mesh.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_NEAR(enclosedVolume(mesh), -32, 32 * kRounding);
  EXPECT_EQ(enclosedVolume(TriangleMesh{}), 0);
}

}  // namespace
}  // namespace voroform::mesh
