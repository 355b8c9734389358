// Quality of tetrahedra and triangles: exact values, degenerate shapes, invariance, an independent computation.
#include "voroform/metrics/shape_quality.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/complexes.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"

namespace voroform::metrics {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using Tetrahedron = std::array<Vec3, 4>;
using Triangle = std::array<Vec3, 3>;
using Criteria = std::array<double, 4>;

constexpr double kDegrees = 180 / std::numbers::pi;
// Rounding of well-shaped elements.
constexpr double kTight = 1e-12;

Criteria criteria(const Tetrahedron& t) {
  const TetrahedronQuality q = tetrahedronQuality(t[0], t[1], t[2], t[3]);
  return {q.smallestDihedral, q.largestDihedral, q.radiusRatio, q.meshingQuality};
}

Criteria criteria(const Triangle& t) {
  const TriangleQuality q = triangleQuality(t[0], t[1], t[2]);
  return {q.smallestAngle, q.largestAngle, q.radiusRatio, q.meshingQuality};
}

void expectNear(const Criteria& found, const Criteria& expected, double tolerance) {
  for (std::size_t k = 0; k < 4; ++k) EXPECT_NEAR(found[k], expected[k], tolerance * (k < 2 ? 180 : 1)) << k;
}

Tetrahedron regularTetrahedron() { return {Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)}; }
Tetrahedron cornerTetrahedron() { return {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}; }
Triangle equilateralTriangle() { return {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}; }

Tetrahedron randomTetrahedron(std::uint64_t index) {
  Tetrahedron t;
  for (std::size_t k = 0; k < 4; ++k) {
    t[k] = randomInBox(7, RandomStream::test, 4 * index + k, Box3(Vec3::Zero(), Vec3::Ones()));
  }
  return t;
}

Triangle firstThree(const Tetrahedron& t) { return {t[0], t[1], t[2]}; }

template <std::size_t N>
std::array<Vec3, N> moved(std::array<Vec3, N> points, std::uint64_t seed, double scale) {
  const Mat3 rotation = randomRotation(seed);
  const Vec3 shift = scale * randomInBox(seed, RandomStream::test, 99, Box3(-Vec3::Ones(), Vec3::Ones()));
  for (Vec3& p : points) p = rotation * (scale * p) + shift;
  return points;
}

TEST(TetrahedronQuality, Regular) {
  const double dihedral = std::acos(1.0 / 3) * kDegrees;
  EXPECT_NEAR(dihedral, 70.5288, 1e-4);
  expectNear(criteria(regularTetrahedron()), {dihedral, dihedral, 1, 1}, kTight);
}

TEST(TetrahedronQuality, CornerOfACube) {
  // Three right angles at the axes, three of acos(1/√3); inradius 1/(3 + √3), circumradius √3/2; V = 1/6, Σ l² = 9.
  const double radiusRatio = 3 / (3 + std::numbers::sqrt3) / (std::numbers::sqrt3 / 2);
  const double meshing = 12 * std::cbrt(9.0 / 36) / 9;
  expectNear(criteria(cornerTetrahedron()), {std::acos(1 / std::numbers::sqrt3) * kDegrees, 90, radiusRatio, meshing},
             kTight);
}

// A regular triangle of side s at height 0 and an apex at height h above its center.
Tetrahedron pyramid(double side, double height) {
  const double radius = side / std::numbers::sqrt3;
  const auto corner = [&](double angle) { return Vec3(radius * std::cos(angle), radius * std::sin(angle), 0); };
  const double third = 2 * std::numbers::pi / 3;
  return {corner(0), corner(third), corner(2 * third), Vec3(0, 0, height)};
}

Criteria pyramidCriteria(double s, double h) {
  const double inradiusOfBase = s / (2 * std::numbers::sqrt3);
  const double radiusOfBase = s / std::numbers::sqrt3;
  const double slant = std::hypot(h, inradiusOfBase);
  const double edge = std::hypot(h, radiusOfBase);
  const double atBase = std::atan2(h, inradiusOfBase) * kDegrees;
  // Outward normals of two sides: (cos 0, sin 0)·h + r·z and the same turned by 120 degrees.
  const double cosine = (h * h * 0.5 - inradiusOfBase * inradiusOfBase) / (slant * slant);
  const double atSide = std::acos(cosine) * kDegrees;
  const double volume = std::numbers::sqrt3 / 4 * s * s * h / 3;
  const double areas = std::numbers::sqrt3 / 4 * s * s + 1.5 * s * slant;
  const double circumradius = edge * edge / (2 * h);
  return {std::min(atBase, atSide), std::max(atBase, atSide), 9 * volume / areas / circumradius,
          12 * std::cbrt(9 * volume * volume) / (3 * s * s + 3 * edge * edge)};
}

TEST(TetrahedronQuality, NeedlesAndCaps) {
  for (const double height : {1e-9, 1e-6, 1e-3, 0.1, 1.0, 10.0, 1e3, 1e6}) {
    SCOPED_TRACE(height);
    expectNear(criteria(pyramid(1, height)), pyramidCriteria(1, height), 1e-8);
  }
  // The largest angle of a needle is near 90 at the base and 60 at the sides; that of a cap near 180.
  EXPECT_NEAR(criteria(pyramid(1, 1e6))[1], 90, 1e-4);
  EXPECT_NEAR(criteria(pyramid(1, 1e6))[0], 60, 1e-4);
  EXPECT_GT(criteria(pyramid(1, 1e-6))[1], 179.99);
  EXPECT_LT(criteria(pyramid(1, 1e-6))[2], 1e-5);
}

TEST(TetrahedronQuality, Sliver) {
  // Four points near a square's corners, two opposite ones lifted: edges are fine, all but the dihedral angles.
  for (const double lift : {1e-1, 1e-3, 1e-6}) {
    SCOPED_TRACE(lift);
    const Tetrahedron sliver = {Vec3(1, 0, lift), Vec3(0, 1, -lift), Vec3(-1, 0, lift), Vec3(0, -1, -lift)};
    // At the diagonals the faces meet at nearly 180 degrees, along the square's sides at nearly 0.
    const double atDiagonal = 2 * std::atan2(1, 2 * lift) * kDegrees;
    const Vec3 n1 = (sliver[1] - sliver[0]).cross(sliver[2] - sliver[0]).normalized();
    const Vec3 n2 = (sliver[3] - sliver[0]).cross(sliver[1] - sliver[0]).normalized();
    const double atSide = std::asin(n1.cross(n2).norm()) * kDegrees;
    EXPECT_NEAR(criteria(sliver)[0], atSide, 1e-9);
    EXPECT_NEAR(criteria(sliver)[1], atDiagonal, 1e-9);
    EXPECT_LT(criteria(sliver)[0], 180 * lift);
    EXPECT_LT(criteria(sliver)[2], 4 * lift);
  }
}

void expectWorst(const Criteria& found) {
  EXPECT_EQ(found[0], 0);
  EXPECT_EQ(found[1], 180);
  EXPECT_EQ(found[2], 0);
  EXPECT_EQ(found[3], 0);
}

TEST(TetrahedronQuality, FlatAndZeroSize) {
  expectWorst(criteria(Tetrahedron{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}));
  expectWorst(
      criteria(Tetrahedron{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0), Vec3(1, 1, 0)}));  // one inside the others
  expectWorst(criteria(Tetrahedron{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(3, 0, 0)}));  // on a line
  expectWorst(criteria(Tetrahedron{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(0, 1, 0)}));  // three on a line
  expectWorst(criteria(Tetrahedron{Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}));  // two equal
  const Vec3 p(1, 2, 3);
  expectWorst(criteria(Tetrahedron{p, p, p, p}));
}

TEST(TriangleQuality, Equilateral) { expectNear(criteria(equilateralTriangle()), {60, 60, 1, 1}, kTight); }

TEST(TriangleQuality, RightAngled) {
  // 3-4-5: area 6, inradius 1, circumradius 5/2.
  expectNear(criteria(Triangle{Vec3::Zero(), Vec3(3, 0, 0), Vec3(0, 4, 0)}),
             {std::atan2(3, 4) * kDegrees, 90, 2 / 2.5, 4 * std::numbers::sqrt3 * 6 / 50}, kTight);
}

TEST(TriangleQuality, Needle) {
  const double base = 1e-7;
  const Criteria found = criteria(Triangle{Vec3(-base / 2, 0, 0), Vec3(base / 2, 0, 0), Vec3(0, 1, 0)});
  EXPECT_NEAR(found[0], base * kDegrees, 1e-12);
  EXPECT_NEAR(found[1], 90, 1e-5);
  EXPECT_NEAR(found[2], 2 * base, 1e-13);  // inradius base/2, circumradius 1/2
  EXPECT_NEAR(found[3], std::numbers::sqrt3 * base, 1e-13);
}

TEST(TriangleQuality, FlatAndZeroSize) {
  expectWorst(criteria(Triangle{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(3, 0, 0)}));
  expectWorst(criteria(Triangle{Vec3(0, 0, 0), Vec3(0, 0, 0), Vec3(3, 0, 0)}));
  const Vec3 p(1, 2, 3);
  expectWorst(criteria(Triangle{p, p, p}));
}

// By the textbook: face planes, arccosines, Heron's formula, the circumcenter from a linear system.
Criteria independentCriteria(const Tetrahedron& t) {
  Criteria result = {180, 0, 0, 0};
  double squaredLengths = 0;
  double areas = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) {
      const std::size_t k = i != 0 ? 0 : (j != 1 ? 1 : 2);
      const std::size_t l = 6 - i - j - k;
      // In the plane normal to the edge ij: the angle between what is left of ik and il.
      const Vec3 axis = (t[j] - t[i]).normalized();
      const auto across = [&](std::size_t m) { return Vec3(t[m] - t[i] - axis.dot(t[m] - t[i]) * axis).normalized(); };
      const double angle = std::acos(across(k).dot(across(l))) * kDegrees;
      result[0] = std::min(result[0], angle);
      result[1] = std::max(result[1], angle);
      squaredLengths += (t[j] - t[i]).squaredNorm();
    }
    const double a = (t[(i + 1) % 4] - t[(i + 2) % 4]).norm();
    const double b = (t[(i + 2) % 4] - t[(i + 3) % 4]).norm();
    const double c = (t[(i + 3) % 4] - t[(i + 1) % 4]).norm();
    const double s = (a + b + c) / 2;
    areas += std::sqrt(s * (s - a) * (s - b) * (s - c));
  }
  Mat3 system;
  Vec3 right;
  for (int r = 0; r < 3; ++r) {
    const Vec3 row = t[static_cast<std::size_t>(r) + 1] - t[0];
    system.row(r) = 2 * row;
    right[r] = row.squaredNorm();
  }
  const double volume = std::abs(system.determinant()) / 48;
  const double circumradius = system.fullPivLu().solve(right).norm();
  result[2] = 3 * (3 * volume / areas) / circumradius;
  result[3] = 12 * std::pow(9 * volume * volume, 1.0 / 3) / squaredLengths;
  return result;
}

Criteria independentCriteria(const Triangle& t) {
  const double a = (t[1] - t[2]).norm();
  const double b = (t[2] - t[0]).norm();
  const double c = (t[0] - t[1]).norm();
  const double s = (a + b + c) / 2;
  const double area = std::sqrt(s * (s - a) * (s - b) * (s - c));
  const auto angle = [](double opposite, double x, double y) {
    return std::acos((x * x + y * y - opposite * opposite) / (2 * x * y)) * kDegrees;
  };
  const std::array<double, 3> angles = {angle(a, b, c), angle(b, c, a), angle(c, a, b)};
  return {*std::min_element(angles.begin(), angles.end()), *std::max_element(angles.begin(), angles.end()),
          2 * (area / s) / (a * b * c / (4 * area)), 4 * std::numbers::sqrt3 * area / (a * a + b * b + c * c)};
}

TEST(ShapeQuality, RandomElementsAgainstTheTextbook) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    const Tetrahedron t = randomTetrahedron(i);
    expectNear(criteria(t), independentCriteria(t), 1e-7);
    expectNear(criteria(firstThree(t)), independentCriteria(firstThree(t)), 1e-7);
  }
}

TEST(ShapeQuality, InvariantUnderMotionScalingAndOrder) {
  for (std::uint64_t i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    const Tetrahedron t = randomTetrahedron(i);
    const Criteria tetrahedron = criteria(t);
    const Criteria triangle = criteria(firstThree(t));
    for (const double scale : {1e-100, 1e-3, 1.0, 1e100}) {
      expectNear(criteria(moved(t, i, scale)), tetrahedron, 1e-10);
      expectNear(criteria(moved(firstThree(t), i, scale)), triangle, 1e-10);
    }
    std::array<std::size_t, 4> order = {0, 1, 2, 3};
    do {
      expectNear(criteria(Tetrahedron{t[order[0]], t[order[1]], t[order[2]], t[order[3]]}), tetrahedron, 1e-10);
      if (order[3] == 3) expectNear(criteria(Triangle{t[order[0]], t[order[1]], t[order[2]]}), triangle, 1e-10);
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

// Two tetrahedra on a common face: the regular one and a flatter one.
mesh::PolyhedralComplex twoTetrahedra() {
  const Tetrahedron t = regularTetrahedron();
  const Vec3 below = (t[1] + t[2] + t[3]) / 3 * 1.2;
  return testing::joinCells({t[0], t[1], t[2], t[3], below}, {{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}},
                                                              {{1, 2, 3}, {4, 2, 1}, {4, 3, 2}, {4, 1, 3}}});
}

TEST(QualityStatistics, MeansAndWorstOfTetrahedra) {
  const mesh::PolyhedralComplex complex = twoTetrahedra();
  const Criteria good = criteria(regularTetrahedron());
  const Criteria bad =
      criteria(Tetrahedron{complex.vertices[1], complex.vertices[2], complex.vertices[3], complex.vertices[4]});
  const QualityStatistics statistics = tetrahedraQuality(complex, RunContext{});
  EXPECT_EQ(statistics.elements, 2);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(statistics.mean[k], (good[k] + bad[k]) / 2, 1e-10) << k;
    EXPECT_NEAR(statistics.worst[k], bad[k], 1e-10) << k;
  }
  EXPECT_LT(bad[0], kSliverAngle);
  EXPECT_EQ(statistics.slivers, 1);
}

TEST(QualityStatistics, BoundaryTriangles) {
  mesh::PolyhedralComplex complex = twoTetrahedra();
  const Criteria flat = criteria(Triangle{complex.vertices[4], complex.vertices[2], complex.vertices[1]});
  const QualityStatistics all = boundaryTriangleQuality(complex);
  EXPECT_EQ(all.elements, 6);
  EXPECT_EQ(all.slivers, 0);
  EXPECT_NEAR(all.mean[0], (60 + flat[0]) / 2, 1e-10);
  EXPECT_NEAR(all.mean[2], (1 + flat[2]) / 2, 1e-12);
  EXPECT_NEAR(all.worst[1], flat[1], 1e-10);

  for (Index f = 0; f < complex.faceCount(); ++f) {
    const auto loop = complex.face(f);
    const bool flatFace = std::find(loop.begin(), loop.end(), 4) != loop.end();
    if (flatFace) complex.faceTags[static_cast<std::size_t>(f)] = mesh::FaceTag::envelope;
  }
  const QualityStatistics measured = boundaryTriangleQuality(complex, false);
  EXPECT_EQ(measured.elements, 3);
  EXPECT_NEAR(measured.mean[0], 60, 1e-10);
  EXPECT_NEAR(measured.worst[2], 1, 1e-12);
}

TEST(QualityStatistics, SameBitsForAnyNumberOfThreads) {
  std::vector<Vec3> vertices;
  std::vector<std::vector<testing::Loop>> cells;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const auto v = static_cast<Index>(vertices.size());
    for (const Vec3& p : randomTetrahedron(i)) vertices.push_back(p);
    cells.push_back({{v, v + 2, v + 1}, {v, v + 1, v + 3}, {v, v + 3, v + 2}, {v + 1, v + 2, v + 3}});
  }
  const mesh::PolyhedralComplex complex = testing::joinCells(vertices, cells);
  RunContext one;
  one.threads = 1;
  const QualityStatistics a = tetrahedraQuality(complex, one);
  const QualityStatistics b = tetrahedraQuality(complex, RunContext{});
  EXPECT_EQ(a.mean, b.mean);
  EXPECT_EQ(a.worst, b.worst);
  EXPECT_EQ(a.slivers, b.slivers);
  EXPECT_GT(a.slivers, 300);
}

TEST(QualityStatistics, NoElements) {
  const QualityStatistics none = tetrahedraQuality(mesh::PolyhedralComplex{}, RunContext{});
  EXPECT_EQ(none.elements, 0);
  EXPECT_EQ(none.mean, Criteria{});
  EXPECT_EQ(none.worst, Criteria{});
  EXPECT_EQ(boundaryTriangleQuality(mesh::PolyhedralComplex{}).elements, 0);
}

TEST(QualityStatistics, CellsThatAreNoTetrahedra) {
  EXPECT_THAT([] { tetrahedraQuality(testing::block(1), RunContext{}); },
              ThrowsMessage<UsageError>(HasSubstr("cell 0 is no tetrahedron")));
}

}  // namespace
}  // namespace voroform::metrics
