// Cell rows and boundary surfaces.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/complexes.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {
namespace {

using testing::cubes;
using ::testing::ElementsAre;

TEST(CellFaces, TwoCubesShareAFaceSeenFromBothSides) {
  const PolyhedralComplex complex = cubes({{0, 0, 0}, {1, 0, 0}});
  ASSERT_EQ(complex.faceCount(), 11);
  const CellFaces rows = cellFaces(complex);
  EXPECT_THAT(rows.offsets, ElementsAre(0, 6, 12));
  EXPECT_THAT(rows.faces, ElementsAre(0, 1, 2, 3, 4, 5, 1, 6, 7, 8, 9, 10));
  EXPECT_THAT(rows.sides, ElementsAre(1, 1, 1, 1, 1, 1, -1, 1, 1, 1, 1, 1));
}

TEST(BoundarySurface, CutsPolygonsIntoFansAndDropsInteriorVertices) {
  const PolyhedralComplex complex = testing::block(3);
  const BoundarySurface surface = boundarySurface(complex);
  EXPECT_EQ(surface.mesh.vertices.size(), 64U - 8U);
  EXPECT_EQ(surface.mesh.triangles.size(), 6U * 9U * 2U);
  ASSERT_EQ(surface.sourceFaces.size(), surface.mesh.triangles.size());
  double area = 0;
  for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t) {
    const auto& triangle = surface.mesh.triangles[t];
    const auto corner = [&](std::size_t i) { return surface.mesh.vertices[static_cast<std::size_t>(triangle[i])]; };
    const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    EXPECT_GT(normal.dot(corner(0) - Vec3(1.5, 1.5, 1.5)), 0) << "triangle " << t << " is turned inward";
    area += 0.5 * normal.norm();
    EXPECT_TRUE(complex.isBoundary(surface.sourceFaces[t]));
  }
  EXPECT_DOUBLE_EQ(area, 54);
}

TEST(BoundarySurface, KeepsTheFrame) {
  PolyhedralComplex complex = testing::tetrahedron();
  complex.frame.origin = Vec3(1, 2, 3);
  const BoundarySurface surface = boundarySurface(complex);
  EXPECT_EQ(surface.mesh.frame.origin, complex.frame.origin);
  EXPECT_EQ(surface.mesh.triangles.size(), 4U);
}

}  // namespace
}  // namespace voroform::mesh
