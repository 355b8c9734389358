// The yardsticks of accuracy themselves: Marching Cubes and distances to a surface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "support/half_space_cell.hpp"
#include "support/implicit_laws.hpp"
#include "support/marching_cubes.hpp"
#include "support/surface_distance.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/moments.hpp"

namespace voroform::testing {
namespace {

constexpr double kPi = std::numbers::pi;

mesh::TriangleMesh marched(const implicit::ImplicitFunction& f, double spacing) {
  return marchingCubes(f, spacing, implicit::RootFinder::itp, 1e-12);
}

double areaOf(const mesh::TriangleMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3& a = mesh.vertices[static_cast<std::size_t>(t[0])];
    area += 0.5 * (mesh.vertices[static_cast<std::size_t>(t[1])] - a)
                      .cross(mesh.vertices[static_cast<std::size_t>(t[2])] - a)
                      .norm();
  }
  return area;
}

// Euler's number of a closed, oriented mesh; throws if it is not one.
std::ptrdiff_t eulerOf(const mesh::TriangleMesh& mesh) {
  std::map<std::pair<Index, Index>, int> directed;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (++directed[{t[k], t[(k + 1) % 3]}] > 1) throw std::runtime_error("a directed edge twice");
    }
  }
  for (const auto& [edge, count] : directed) {
    if (directed.count({edge.second, edge.first}) == 0) throw std::runtime_error("an open edge");
  }
  return std::ssize(mesh.vertices) - std::ssize(directed) / 2 + std::ssize(mesh.triangles);
}

TEST(MarchingCubes, SphereIsClosedAndItsMeasuresConvergeWithOrderTwo) {
  const auto form = implicit::transformed(implicit::sphere(1), Mat3::Identity(), Vec3(0.013, 0.007, -0.011));
  double areaErrors[2];
  double volumeErrors[2];
  const double spacings[] = {0.1, 0.05};
  for (const std::size_t k : {0U, 1U}) {
    const auto mesh = marched(*form, spacings[k]);
    EXPECT_EQ(eulerOf(mesh), 2);
    for (const Vec3& v : mesh.vertices) EXPECT_NEAR(form->value(v), 0, 1e-11);
    areaErrors[k] = 4 * kPi - areaOf(mesh);
    volumeErrors[k] = 4 * kPi / 3 - mesh::enclosedVolume(mesh);
    EXPECT_GT(volumeErrors[k], 0) << "inscribed";
  }
  EXPECT_NEAR(std::log2(areaErrors[0] / areaErrors[1]), 2, 0.2);
  EXPECT_NEAR(std::log2(volumeErrors[0] / volumeErrors[1]), 2, 0.2);
  EXPECT_LT(volumeErrors[1], 0.01);
}

TEST(MarchingCubes, AmbiguousFacesStayClosed) {
  // A gyroid at few cubes a period has many.
  const auto form = implicit::transformed(implicit::gyroidBall(), randomRotation(1), Vec3::Zero());
  for (const double spacing : {0.31, 0.17, 0.09}) {
    const auto mesh = marched(*form, spacing);
    EXPECT_NO_THROW(eulerOf(mesh)) << spacing;
    EXPECT_GT(mesh::enclosedVolume(mesh), 0);
  }
  EXPECT_EQ(eulerOf(marched(*implicit::torus(1, 0.4), 0.08)), 0);
  EXPECT_EQ(eulerOf(marched(*implicit::twoTori(), 0.06)), 0);
}

TEST(SurfaceDistance, IsTheClosedFormOfTheTorus) {
  const Mat3 rotation = randomRotation(2);
  // f is scaled, so that its values are no distances.
  class Scaled final : public implicit::ImplicitFunction {
   public:
    explicit Scaled(implicit::ImplicitPtr form) : form_(std::move(form)) {}
    double value(const Vec3& p) const override { return std::expm1(form_->value(p)) * (2 + std::sin(3 * p.x())); }
    Vec3 gradient(const Vec3& p) const override {
      const double inner = form_->value(p);
      const double factor = 2 + std::sin(3 * p.x());
      return std::exp(inner) * factor * form_->gradient(p) +
             std::expm1(inner) * 3 * std::cos(3 * p.x()) * Vec3::UnitX();
    }
    Box3 bounds() const override { return form_->bounds(); }

   private:
    implicit::ImplicitPtr form_;
  };
  const auto torus = implicit::transformed(implicit::torus(1, 0.4), rotation, Vec3(0.1, 0.2, 0.3));
  const Scaled form(torus);
  const Box3 box = torus->bounds();
  int compared = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const Vec3 p = randomInBox(3, RandomStream::test, i, box);
    const double exact = std::abs(torus->value(p));  // of the torus f is the signed distance
    if (exact > 0.1) continue;
    ++compared;
    EXPECT_NEAR(distanceToSurface(form, p, 0.5), exact, 1e-4 * exact + 1e-12);
  }
  EXPECT_GT(compared, 500);
}

TEST(SurfaceDistance, FindsNoSurfaceWhereThereIsNone) {
  EXPECT_THROW(projectAlongGradient(*implicit::sphere(1), Vec3(5, 0, 0), 0.5), std::runtime_error);
  EXPECT_NEAR(projectAlongGradient(*implicit::sphere(1), Vec3(1.2, 0, 0), 0.5).x(), 1, 1e-12);
}

TEST(SurfaceDistances, OfInscribedTrianglesAreThoseOfTheirSagitta) {
  // One triangle with its corners on the unit sphere: ⟨1 − ‖x‖⟩ = ⟨|x_i − x|²⟩/2 to leading order, which for a triangle
  // of edges a, b, c is (a² + b² + c²)/24.
  mesh::TriangleMesh mesh;
  const double size = 0.05;
  for (const Vec3& p : {Vec3(1, 0, 0), Vec3(1, size, 0), Vec3(1, 0.3 * size, size)}) {
    mesh.vertices.push_back(p.normalized());
  }
  mesh.triangles.push_back({0, 1, 2});
  double squares = 0;
  for (const std::size_t k : {0U, 1U, 2U}) squares += (mesh.vertices[k] - mesh.vertices[(k + 1) % 3]).squaredNorm();
  const SurfaceDistances distances = surfaceDistances(*implicit::sphere(1), mesh, 20000, {});
  EXPECT_EQ(distances.samples, 20000U);
  EXPECT_NEAR(distances.mean, squares / 24, 0.01 * squares / 24);
  EXPECT_GT(distances.rms, distances.mean);
  EXPECT_GT(distances.max, distances.rms);
  EXPECT_LT(distances.max, size * size);
}

TEST(HalfSpaceCell, CutsACubeExactly) {
  HalfSpaceCell cell(Box3(Vec3::Zero(), Vec3::Ones()));
  EXPECT_NEAR(cell.moments().volume, 1, 1e-14);
  EXPECT_NEAR(cell.moments().secondMoment, 0.25, 1e-14);
  cell.cut(Vec3(1, 1, 1), 0.75, 7);  // leaves the corner's tetrahedron
  EXPECT_NEAR(cell.moments().volume, 0.75 * 0.75 * 0.75 / 6, 1e-15);
  EXPECT_LT((cell.moments().centroid - Vec3::Constant(0.1875)).norm(), 1e-15);
  EXPECT_EQ(cell.boxFaces(), 3U);
  EXPECT_EQ(cell.countFaces([](int plane) { return plane == 7; }), 1U);
}

}  // namespace
}  // namespace voroform::testing
