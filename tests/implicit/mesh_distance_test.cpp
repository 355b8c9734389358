#include "voroform/implicit/mesh_distance.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/implicit_laws.hpp"
#include "support/surface_meshes.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/surface_locator.hpp"

namespace voroform::implicit {
namespace {

using mesh::TriangleMesh;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kRounding = 1e-13;

void append(TriangleMesh& mesh, const TriangleMesh& more) {
  const auto first = static_cast<Index>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& [a, b, c] : more.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

// Corner i has the sign of bit k of i on axis k.
TriangleMesh cube(const Vec3& center, double half, bool inward = false) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(center + half * Vec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1));
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  for (auto& triangle : mesh.triangles) {
    if (inward) std::swap(triangle[1], triangle[2]);
  }
  return mesh;
}

TriangleMesh torusMesh(int around, int across, double major, double minor) {
  TriangleMesh mesh;
  const double step = 2 * std::acos(-1.0);
  for (int i = 0; i < around; ++i) {
    for (int k = 0; k < across; ++k) {
      const double u = step * i / around;
      const double v = step * k / across;
      const double r = major + minor * std::cos(v);
      mesh.vertices.emplace_back(r * std::cos(u), r * std::sin(u), minor * std::sin(v));
    }
  }
  const auto at = [&](int i, int k) { return static_cast<Index>((i % around) * across + k % across); };
  for (int i = 0; i < around; ++i) {
    for (int k = 0; k < across; ++k) {
      mesh.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  }
  return mesh;
}

// A star whose long thin points have sharp edges: normals there differ by more than a right angle.
TriangleMesh star() {
  TriangleMesh mesh = cube(Vec3::Zero(), 0.2);
  TriangleMesh spiked;
  spiked.vertices = mesh.vertices;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Vec3 center = Vec3::Zero();
    for (const Index v : mesh.triangles[t]) center += mesh.vertices[static_cast<std::size_t>(v)] / 3;
    const auto tip = static_cast<Index>(spiked.vertices.size());
    spiked.vertices.push_back(3.0 * center);
    const auto [a, b, c] = mesh.triangles[t];
    spiked.triangles.insert(spiked.triangles.end(), {{a, b, tip}, {b, c, tip}, {c, a, tip}});
  }
  return spiked;
}

// The cube with a vertex in the middle of one edge whose triangle on one side has no area.
TriangleMesh cubeWithNeedle() {
  TriangleMesh mesh = cube(Vec3::Zero(), 1);
  // The edge of the vertices 1 and 3, between the triangles (0, 3, 1) and (1, 3, 7).
  mesh.vertices.emplace_back(1, 0, -1);
  mesh.triangles[1] = {0, 3, 8};
  mesh.triangles.push_back({0, 8, 1});
  mesh.triangles.push_back({8, 3, 1});
  return mesh;
}

ImplicitPtr distanceTo(TriangleMesh mesh, std::vector<std::string>* warnings = nullptr) {
  RunContext context;
  context.log = [&](LogLevel level, std::string_view message) {
    if (level == LogLevel::warning && warnings != nullptr) warnings->emplace_back(message);
  };
  return meshDistance(std::make_shared<TriangleMesh>(std::move(mesh)), context);
}

TEST(MeshDistance, IsPositiveHoweverFarAway) {
  const auto mesh = std::make_shared<const mesh::TriangleMesh>(testing::icosphere(2, 1));
  const ImplicitPtr f = meshDistance(mesh, {});
  for (std::uint64_t i = 0; i < 400; ++i) {
    const Vec3 direction = randomInBox(5, RandomStream::test, i, Box3(Vec3::Constant(-1), Vec3::Constant(1)));
    for (const double factor : {3.0, 1e8, 1e15, 1e17, 1e30}) {
      const Vec3 p = factor * direction.normalized();
      EXPECT_GT(f->value(p), 0) << factor;
      EXPECT_GE(f->clearance(p), 0) << factor;
    }
  }
}

TEST(MeshDistance, OfACubeIsThatOfTheBox) {
  const ImplicitPtr f = distanceTo(cube(Vec3::Zero(), 1));
  const ImplicitPtr exact = box(Vec3(2, 2, 2));
  const Box3 around(Vec3::Constant(-2), Vec3::Constant(2));
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const Vec3 p = randomInBox(1, RandomStream::test, i, around);
    ASSERT_NEAR(f->value(p), exact->value(p), kRounding);
    ASSERT_NEAR((f->gradient(p) - exact->gradient(p)).norm(), 0, 1e-10);
  }
  // On faces, edges and corners, where nearest points are many.
  for (const Vec3& p : {Vec3(1, 0.3, 0.2), Vec3(1, 1, 0), Vec3(1, 1, 1), Vec3(1, 0, 0)}) EXPECT_EQ(f->value(p), 0);
  EXPECT_NEAR((f->gradient(Vec3(1, 1, 0)) - Vec3(1, 1, 0).normalized()).norm(), 0, kRounding);
  EXPECT_NEAR((f->gradient(Vec3(1, 1, 1)) - Vec3(1, 1, 1).normalized()).norm(), 0, kRounding);
  EXPECT_NEAR(f->value(Vec3(0, 0, 0)), -1, kRounding);
  EXPECT_NEAR(f->value(Vec3(2, 2, 2)), std::sqrt(3.0), kRounding);
}

TEST(MeshDistance, ObeysTheLaws) {
  EXPECT_THAT(test::violatedLaws(distanceTo(cube(Vec3::Zero(), 1)), {}), IsEmpty());
  // Near a fine mesh many difference quotients cross a kink.
  EXPECT_THAT(test::violatedLaws(distanceTo(torusMesh(60, 30, 1, 0.4)), {.kinkShare = 0.1}), IsEmpty());
  EXPECT_THAT(test::violatedLaws(distanceTo(star()), {.kinkShare = 0.1}), IsEmpty());
  EXPECT_THAT(test::violatedLaws(distanceTo(cubeWithNeedle()), {.kinkShare = 0.1}), IsEmpty());
}

TEST(MeshDistance, ApproachesTheTorusToSecondOrder) {
  const ImplicitPtr exact = torus(1, 0.4);
  std::vector<double> errors;
  for (const int n : {20, 40, 80}) {
    const ImplicitPtr f = distanceTo(torusMesh(2 * n, n, 1, 0.4));
    double sum = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const Vec3 p = randomInBox(3, RandomStream::test, i, Box3(Vec3(-1.5, -1.5, -0.5), Vec3(1.5, 1.5, 0.5)));
      sum += std::abs(f->value(p) - exact->value(p));
    }
    errors.push_back(sum / 2000);
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.15);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.15);
}

TEST(MeshDistance, SignsAtSharpPartsAreThoseOfTheSolid) {
  // The planes of one triangle alone give wrong signs behind sharp edges; the parity of a ray does not.
  const auto mesh = std::make_shared<TriangleMesh>(star());
  const ImplicitPtr f = meshDistance(mesh, RunContext());
  const mesh::SurfaceLocator locator(*mesh, 0, 1e-12);
  for (std::uint64_t i = 0; i < 20000; ++i) {
    const Vec3 p = randomInBox(5, RandomStream::test, i, Box3(Vec3::Constant(-0.8), Vec3::Constant(0.8)));
    const mesh::Location location = locator.locate(p);
    if (location == mesh::Location::uncertain) continue;
    ASSERT_EQ(f->value(p) < 0, location == mesh::Location::inside) << p.transpose();
  }
}

TEST(MeshDistance, AVoidIsOutside) {
  TriangleMesh mesh = cube(Vec3::Zero(), 2);
  append(mesh, cube(Vec3(0.5, 0, 0), 1, true));
  const ImplicitPtr f = distanceTo(mesh);
  EXPECT_NEAR(f->value(Vec3(0.5, 0, 0)), 1, kRounding);
  EXPECT_NEAR(f->value(Vec3(-1.25, 0, 0)), -0.75, kRounding);
  EXPECT_NEAR(f->value(Vec3(1.75, 0, 0)), -0.25, kRounding);
  EXPECT_LT(f->clearance(Vec3(-1.25, 0, 0)), -0.5);
  EXPECT_GT(f->clearance(Vec3(0.5, 0, 0)), 0.8);
  EXPECT_THAT(test::violatedLaws(f, {.kinkShare = 0.1}), IsEmpty());
}

TEST(MeshDistance, TrianglesWithoutAreaDoNoHarm) {
  const ImplicitPtr f = distanceTo(cubeWithNeedle());
  const ImplicitPtr exact = box(Vec3(2, 2, 2));
  for (std::uint64_t i = 0; i < 20000; ++i) {
    // Around the needle, where it is nearest.
    const Vec3 p =
        Vec3(1, 0, -1) + randomInBox(7, RandomStream::test, i, Box3(Vec3::Constant(-0.3), Vec3::Constant(0.3)));
    ASSERT_NEAR(f->value(p), exact->value(p), kRounding) << p.transpose();
  }
  const Vec3 gradient = f->gradient(Vec3(1, 0.5, -1));
  EXPECT_NEAR(gradient.norm(), 1, kRounding);
  EXPECT_GT(gradient.dot(Vec3(1, 0, -1)), 0);
}

TEST(MeshDistance, OverlappingPartsFollowTheEvenOddRuleAndAreWarnedOf) {
  TriangleMesh mesh = cube(Vec3::Zero(), 1);
  append(mesh, cube(Vec3(1, 0.9, 0.8), 1));
  std::vector<std::string> warnings;
  const ImplicitPtr f = distanceTo(mesh, &warnings);
  EXPECT_THAT(warnings, ElementsAre(HasSubstr("the mesh intersects itself")));
  EXPECT_LT(f->value(Vec3(-0.5, -0.5, -0.4)), 0);
  EXPECT_LT(f->value(Vec3(1.5, 1.4, 1.3)), 0);
  EXPECT_GT(f->value(Vec3(0.5, 0.45, 0.4)), 0);
  EXPECT_GT(f->value(Vec3(3, 0, 0)), 0);
  EXPECT_THAT(test::violatedLaws(f, {.kinkShare = 0.1}), IsEmpty());
  warnings.clear();
  distanceTo(cube(Vec3::Zero(), 1), &warnings);
  EXPECT_THAT(warnings, IsEmpty());
}

TEST(MeshDistance, PlacesThatAreNoneGiveNoCrash) {
  const ImplicitPtr f = distanceTo(cube(Vec3::Zero(), 1));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(f->value(Vec3(kInfinity, 0, 0)) < 0);
  const std::vector<Vec3> points = {Vec3(0, 0, 0), Vec3::Constant(std::nan("")), Vec3(0.5, 0, 0)};
  std::vector<double> values(3);
  f->values(points, values);
  EXPECT_EQ(values[2], f->value(points[2]));
}

TEST(MeshDistance, WithoutTrianglesThereIsNone) {
  EXPECT_THROW(distanceTo(TriangleMesh()), InputError);
  TriangleMesh open = cube(Vec3::Zero(), 1);
  open.triangles.pop_back();
  EXPECT_THROW(distanceTo(open), std::invalid_argument);
}

}  // namespace
}  // namespace voroform::implicit
