#include "voroform/implicit/tetrahedral_form.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/implicit_laws.hpp"
#include "voroform/core/error.hpp"

namespace voroform::implicit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kRounding = 1e-12;

// The cube [−1, 1]³ cut into cells³ small cubes of six tetrahedra each (Kuhn's subdivision), with f at the vertices.
template <class Function>
TetrahedralMesh kuhnMesh(int cells, const Function& f) {
  TetrahedralMesh mesh;
  const int side = cells + 1;
  const auto vertexAt = [side](int x, int y, int z) { return (z * side + y) * side + x; };
  for (int z = 0; z < side; ++z) {
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const Vec3 p = 2.0 / cells * Vec3(x, y, z) - Vec3::Ones();
        mesh.vertices.push_back({p, f(p)});
      }
    }
  }
  for (int z = 0; z < cells; ++z) {
    for (int y = 0; y < cells; ++y) {
      for (int x = 0; x < cells; ++x) {
        std::array<int, 3> axes = {0, 1, 2};
        bool even = true;
        do {
          std::array<int, 3> at = {x, y, z};
          FormTetrahedron tetrahedron{{}, {kNone, kNone, kNone, kNone}};
          tetrahedron.vertices[0] = vertexAt(at[0], at[1], at[2]);
          for (std::size_t step = 0; step < 3; ++step) {
            ++at[static_cast<std::size_t>(axes[step])];
            tetrahedron.vertices[step + 1] = vertexAt(at[0], at[1], at[2]);
          }
          const auto sign = (axes[1] - axes[0]) * (axes[2] - axes[0]) * (axes[2] - axes[1]);
          even = sign > 0;
          if (!even) std::swap(tetrahedron.vertices[2], tetrahedron.vertices[3]);
          mesh.tetrahedra.push_back(tetrahedron);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
    }
  }
  // Neighbors by comparing all faces, sorted.
  std::vector<std::pair<std::array<Index, 3>, std::pair<Index, std::size_t>>> faces;
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    for (std::size_t i = 0; i < 4; ++i) {
      const auto& v = mesh.tetrahedra[t].vertices;
      std::array<Index, 3> face = {v[(i + 1) % 4], v[(i + 2) % 4], v[(i + 3) % 4]};
      std::sort(face.begin(), face.end());
      faces.push_back({face, {static_cast<Index>(t), i}});
    }
  }
  std::sort(faces.begin(), faces.end());
  for (std::size_t k = 0; k + 1 < faces.size(); ++k) {
    if (faces[k].first != faces[k + 1].first) continue;
    const auto [a, i] = faces[k].second;
    const auto [b, j] = faces[k + 1].second;
    mesh.tetrahedra[static_cast<std::size_t>(a)].neighbors[i] = b;
    mesh.tetrahedra[static_cast<std::size_t>(b)].neighbors[j] = a;
  }
  return mesh;
}

double plane(const Vec3& p) { return p.dot(Vec3(1, 2, -0.5)) + 0.3; }
double roundness(const Vec3& p) { return p.norm() - 0.7; }

TEST(TetrahedralForm, IsExactForALinearFunction) {
  const TetrahedralForm form(kuhnMesh(5, plane), 32, {});
  const Box3 cube(-Vec3::Ones(), Vec3::Ones());
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const Vec3 p = randomInBox(1, RandomStream::test, i, cube);
    EXPECT_NEAR(form.value(p), plane(p), kRounding);
    EXPECT_NEAR((form.gradient(p) - Vec3(1, 2, -0.5)).norm(), 0, kRounding);
  }
}

TEST(TetrahedralForm, IsAPositiveConstantOutsideTheHull) {
  const TetrahedralForm form(kuhnMesh(3, plane), 32, {});
  double largest = 0;
  for (const FormVertex& vertex : form.mesh().vertices) largest = std::max(largest, std::abs(vertex.value));
  for (const Vec3& p : {Vec3(1.001, 0, 0), Vec3(-1.5, -1.5, -1.5), Vec3(0, 0, 1e9)}) {
    EXPECT_EQ(form.value(p), largest);
    EXPECT_EQ(form.gradient(p), Vec3::Zero());
    EXPECT_EQ(form.locate(p), kNone);
    EXPECT_GE(form.clearance(p), 0);
  }
}

TEST(TetrahedralForm, BoundsAreThoseOfTheNegativePart) {
  const TetrahedralForm form(kuhnMesh(8, [](const Vec3& p) { return p.x() + 0.3; }), 32, {});
  EXPECT_NEAR(form.bounds().max().x(), -0.3, 1e-6);
  EXPECT_NEAR(form.bounds().min().x(), -1, 1e-6);
  EXPECT_NEAR(form.bounds().max().y(), 1, 1e-6);
  const TetrahedralForm empty(kuhnMesh(2, [](const Vec3&) { return 1.0; }), 32, {});
  EXPECT_TRUE(empty.bounds().isEmpty());
  EXPECT_EQ(empty.clearance(Vec3::Zero()), 0);
}

TEST(TetrahedralForm, ObeysTheLaws) {
  const test::ImplicitLawOptions options = {.kinkShare = 0.02, .differenceStep = 1e-8, .decidedShare = 0.8};
  const auto ball = std::make_shared<TetrahedralForm>(kuhnMesh(9, roundness), 96, RunContext{});
  EXPECT_THAT(test::violatedLaws(ball, options), IsEmpty());
  // A solid that leaves through the hull, where f jumps: many points near S have no difference quotient.
  const auto half = std::make_shared<TetrahedralForm>(kuhnMesh(9, plane), 96, RunContext{});
  test::ImplicitLawOptions withJump = options;
  withJump.kinkShare = 0.06;
  EXPECT_THAT(test::violatedLaws(half, withJump), IsEmpty());
}

TEST(TetrahedralForm, VerticesThatAreZeroCountAsOutside) {
  // Zero on whole faces: on the plane x = 0 and in all of x > 0.
  const auto form = std::make_shared<TetrahedralForm>(kuhnMesh(4, [](const Vec3& p) { return std::min(p.x(), 0.0); }),
                                                      64, RunContext{});
  EXPECT_LT(form->value(Vec3(-0.01, 0.2, 0.1)), 0);
  EXPECT_EQ(form->value(Vec3(0.5, 0.2, 0.1)), 0);
  EXPECT_GT(form->clearance(Vec3(0.5, 0.2, 0.1)), 0);
  EXPECT_LT(form->clearance(Vec3(-0.5, 0.2, 0.1)), 0);
  EXPECT_EQ(form->clearance(Vec3(0, 0.2, 0.1)), 0);
}

TEST(TetrahedralForm, ValuesDoNotDependOnTheNumbering) {
  TetrahedralMesh mesh = kuhnMesh(6, roundness);
  const TetrahedralForm plain(mesh, 32, {});
  sortSpatially(mesh);
  EXPECT_THAT(findProblem(mesh), IsEmpty());
  const TetrahedralForm sorted(mesh, 32, {});
  for (const Vec3& p : test::lawPoints(plain, {.points = 3000})) {
    EXPECT_NEAR(plain.value(p), sorted.value(p), kRounding);
    EXPECT_EQ(plain.clearance(p), sorted.clearance(p));
  }
}

TEST(TetrahedralForm, TheSearchBehindTheWalkFindsTheSameValues) {
  const TetrahedralForm walking(kuhnMesh(4, roundness), 32, {});
  const TetrahedralForm searching(kuhnMesh(4, roundness), 32, {}, 0);
  for (const Vec3& p : test::lawPoints(walking, {.points = 3000})) {
    EXPECT_NEAR(walking.value(p), searching.value(p), kRounding);
    EXPECT_EQ(walking.locate(p) == kNone, searching.locate(p) == kNone);
  }
}

// Points on vertices, edges and faces, where rounding decides between neighbors.
TEST(TetrahedralForm, IsContinuousOnSharedFaces) {
  const TetrahedralForm form(kuhnMesh(7, roundness), 32, {});
  const TetrahedralMesh& mesh = form.mesh();
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const auto& v = mesh.tetrahedra[t].vertices;
    const FormVertex& a = mesh.vertices[static_cast<std::size_t>(v[0])];
    const FormVertex& b = mesh.vertices[static_cast<std::size_t>(v[1])];
    const FormVertex& c = mesh.vertices[static_cast<std::size_t>(v[2])];
    const auto expectAt = [&form](const Vec3& p, double value) {
      // On the hull itself rounding decides between inside and outside.
      if (p.cwiseAbs().maxCoeff() > 1 - 1e-9) return;
      EXPECT_NEAR(form.value(p), value, kRounding) << p.transpose();
    };
    expectAt(a.position, a.value);
    expectAt(0.3 * a.position + 0.7 * b.position, 0.3 * a.value + 0.7 * b.value);
    expectAt((a.position + b.position + c.position) / 3, (a.value + b.value + c.value) / 3);
  }
}

TEST(TetrahedralForm, RefusesUnusableMeshes) {
  const TetrahedralMesh good = kuhnMesh(2, roundness);
  EXPECT_THAT(findProblem(good), IsEmpty());
  const auto problemAfter = [&good](const auto& change) {
    TetrahedralMesh mesh = good;
    change(mesh);
    EXPECT_THROW(TetrahedralForm(mesh, 32, {}), InputError);
    return findProblem(mesh);
  };
  EXPECT_THAT(problemAfter([](TetrahedralMesh& m) { m.tetrahedra.clear(); }), HasSubstr("no tetrahedra"));
  EXPECT_THAT(problemAfter([](TetrahedralMesh& m) { m.vertices[3].value = std::nan(""); }), HasSubstr("vertex 3"));
  EXPECT_THAT(problemAfter([](TetrahedralMesh& m) { m.vertices[4].position.y() = HUGE_VAL; }), HasSubstr("vertex 4"));
  EXPECT_THAT(problemAfter([](TetrahedralMesh& m) { m.tetrahedra[5].vertices[2] = 27; }), HasSubstr("no vertex 27"));
  EXPECT_THAT(problemAfter([](TetrahedralMesh& m) { m.tetrahedra[5].vertices[2] = -1; }), HasSubstr("no vertex -1"));
  EXPECT_THAT(problemAfter([](TetrahedralMesh& m) { m.tetrahedra[6].neighbors[0] = 48; }), HasSubstr("no neighbor 48"));
  EXPECT_THAT(problemAfter([](TetrahedralMesh& m) { m.tetrahedra[6].neighbors[0] = -2; }), HasSubstr("no neighbor -2"));
  EXPECT_THAT(
      problemAfter([](TetrahedralMesh& m) { std::swap(m.tetrahedra[7].vertices[0], m.tetrahedra[7].vertices[1]); }),
      HasSubstr("tetrahedron 7 is turned inside out"));
  EXPECT_THAT(problemAfter([](TetrahedralMesh& m) { m.measured.assign(3, 1); }), HasSubstr("measured"));
  EXPECT_THAT(problemAfter([](TetrahedralMesh& m) {
                for (FormTetrahedron& t : m.tetrahedra) {
                  if (t.neighbors[0] != kNone && t.neighbors[1] != kNone) std::swap(t.neighbors[0], t.neighbors[1]);
                }
              }),
              HasSubstr("share no face"));
  EXPECT_THROW(TetrahedralForm(good, 0, {}), UsageError);
}

}  // namespace
}  // namespace voroform::implicit
