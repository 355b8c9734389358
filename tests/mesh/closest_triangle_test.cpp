#include "voroform/mesh/closest_triangle.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "voroform/core/random.hpp"

namespace voroform::mesh {
namespace {

constexpr double kRounding = 1e-12;

Vec3 corner(const TriangleMesh& mesh, std::size_t t, std::size_t i) {
  return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][i])];
}

// Small triangles scattered over the unit cube, every eighth of them without area.
TriangleMesh scattered(std::size_t count, std::uint64_t seed) {
  const Box3 cube(Vec3::Zero(), Vec3::Ones());
  const Box3 step(Vec3::Constant(-0.1), Vec3::Constant(0.1));
  TriangleMesh mesh;
  for (std::uint64_t t = 0; t < count; ++t) {
    const Vec3 a = randomInBox(seed, RandomStream::test, 3 * t, cube);
    const Vec3 ab = randomInBox(seed, RandomStream::test, 3 * t + 1, step);
    const Vec3 ac = t % 8 == 0 ? Vec3(0.25 * ab) : randomInBox(seed, RandomStream::test, 3 * t + 2, step);
    const auto first = static_cast<Index>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {a, a + ab, a + ac});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

// Distance to a triangle by the definition: the foot of the perpendicular if it lies inside, else the nearest edge.
double distanceTo(const TriangleMesh& mesh, std::size_t t, const Vec3& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 a = corner(mesh, t, i);
    const Vec3 ab = corner(mesh, t, (i + 1) % 3) - a;
    const double along = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (p - a - along * ab).norm());
  }
  const Vec3 normal = (corner(mesh, t, 1) - corner(mesh, t, 0)).cross(corner(mesh, t, 2) - corner(mesh, t, 0));
  if (normal.norm() < 1e-9) return nearest;
  bool inside = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 a = corner(mesh, t, i);
    inside = inside && (corner(mesh, t, (i + 1) % 3) - a).cross(p - a).dot(normal) > 0;
  }
  return inside ? std::abs(normal.dot(p - corner(mesh, t, 0)) / normal.norm()) : nearest;
}

class ScatteredTriangles : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ScatteredTriangles, NearestIsThatOfAllTriangles) {
  const TriangleMesh mesh = scattered(GetParam(), 1);
  const ClosestTriangle tree(mesh);
  const Box3 around(Vec3::Constant(-0.5), Vec3::Constant(1.5));
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Vec3 p = randomInBox(2, RandomStream::test, i, around);
    double expected = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) expected = std::min(expected, distanceTo(mesh, t, p));
    const ClosestTriangle::Hit hit = tree.find(p);
    ASSERT_NE(hit.triangle, kNone);
    ASSERT_NEAR(hit.distance, expected, kRounding);
    ASSERT_NEAR((hit.point - p).norm(), hit.distance, kRounding);
    ASSERT_NEAR(distanceTo(mesh, static_cast<std::size_t>(hit.triangle), hit.point), 0, 1e-9);
    // A bound above the distance changes nothing, one below finds nothing.
    const ClosestTriangle::Hit bounded = tree.find(p, expected * (1 + 1e-6));
    EXPECT_EQ(bounded.triangle, hit.triangle);
    EXPECT_EQ(bounded.point, hit.point);
    EXPECT_EQ(bounded.feature, hit.feature);
    EXPECT_EQ(tree.find(p, expected * (1 - 1e-6)).triangle, kNone);
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, ScatteredTriangles, ::testing::Values(1, 4, 5, 9, 700));

TEST(ClosestTriangle, NamesTheFeature) {
  TriangleMesh mesh;
  mesh.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  mesh.triangles = {{0, 1, 2}};
  const ClosestTriangle tree(mesh);
  EXPECT_EQ(tree.find(Vec3(0.25, 0.25, 2)).feature, 0);
  EXPECT_EQ(tree.find(Vec3(0.5, -1, 1)).feature, 1);
  EXPECT_EQ(tree.find(Vec3(1, 1, 1)).feature, 2);
  EXPECT_EQ(tree.find(Vec3(-1, 0.5, 1)).feature, 3);
  EXPECT_EQ(tree.find(Vec3(-1, -1, 1)).feature, 4);
  EXPECT_EQ(tree.find(Vec3(3, 0, 1)).feature, 5);
  EXPECT_EQ(tree.find(Vec3(0, 3, 1)).feature, 6);
  EXPECT_EQ(tree.find(Vec3(0.25, 0.25, 0)).distance, 0);
}

TEST(ClosestTriangle, OfNeedlesNoNumberIsLost) {
  TriangleMesh mesh;
  mesh.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 1e-9, 0), Vec3(0.5, 0, 0)};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 0, 0}};
  const ClosestTriangle tree(mesh);
  for (const Vec3& p : {Vec3(0.5, 0, 1), Vec3(0.3, 1e-10, 1e-3), Vec3(0.5, 1e-9, 0), Vec3(0.7, 0, 0)}) {
    EXPECT_NEAR(tree.find(p).distance, p.z(), kRounding);
  }
}

TEST(ClosestTriangle, EqualDistancesGiveTheLowestIndex) {
  TriangleMesh mesh;
  mesh.vertices = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  for (int i = 0; i < 20; ++i) mesh.triangles.push_back({0, 1, 2});
  EXPECT_EQ(ClosestTriangle(mesh).find(Vec3(0.2, 0.2, 1)).triangle, 0);
}

TEST(ClosestTriangle, OfNoMeshNothingIsNear) {
  EXPECT_EQ(ClosestTriangle(TriangleMesh()).find(Vec3::Zero()).triangle, kNone);
}

}  // namespace
}  // namespace voroform::mesh
