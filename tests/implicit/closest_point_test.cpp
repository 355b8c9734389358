#include "voroform/implicit/closest_point.hpp"

#include <cmath>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::implicit {
namespace {

constexpr double kReach = 0.2;
constexpr double kBracket = 1e-10;  // of the reach, as closestPoint() promises
constexpr double kSettled = 1e-9;   // of the reach: an angle of 1e-6 to the normal, at distances up to the reach
const Box3 kUnitBox(Vec3::Constant(-1), Vec3::Constant(1));

Vec3 randomDirection(std::uint64_t index) {
  for (std::uint64_t i = 0;; ++i) {
    const Vec3 p = randomInBox(17 + i, RandomStream::test, index, kUnitBox);
    if (p.norm() > 0.1 && p.norm() < 1) return p.normalized();
  }
}

// A form given by functions, so that values and gradients may be anything.
class Given final : public ImplicitFunction {
 public:
  Given(std::function<double(const Vec3&)> value, std::function<Vec3(const Vec3&)> gradient)
      : value_(std::move(value)), gradient_(std::move(gradient)) {}
  double value(const Vec3& p) const override { return value_(p); }
  Vec3 gradient(const Vec3& p) const override { return gradient_(p); }
  Box3 bounds() const override { return {Vec3::Constant(-3), Vec3::Constant(3)}; }

 private:
  std::function<double(const Vec3&)> value_;
  std::function<Vec3(const Vec3&)> gradient_;
};

// map(f), without a clearance.
Given mapped(const ImplicitPtr& f, const std::function<double(double)>& map,
             const std::function<double(double)>& slope) {
  return {[=](const Vec3& p) { return map(f->value(p)); },
          [=](const Vec3& p) -> Vec3 { return slope(f->value(p)) * f->gradient(p); }};
}

void expectBracketed(const ImplicitFunction& f, const ClosestPoint& nearest, double reach) {
  const Vec3 step = 2 * kBracket * reach * nearest.normal;
  EXPECT_LT(f.value(nearest.position - step), 0);
  EXPECT_GE(f.value(nearest.position + step), 0);
}

// The nearest point of the ellipsoid Σ(x/a)² = 1 to p (all coordinates non-zero): x = a²p/(a² + t) with the largest
// root t of Σ(ap/(a² + t))² = 1 (Eberly, Distance from a point to an ellipsoid, 2013), by bisection.
Vec3 nearestOnEllipsoid(const Vec3& a, const Vec3& p) {
  const Vec3 squares = a.cwiseProduct(a);
  double low = -squares.minCoeff();
  double high = a.maxCoeff() * p.norm();
  for (int i = 0; i < 200; ++i) {
    const double t = 0.5 * (low + high);
    const Vec3 ratio = a.cwiseProduct(p).cwiseQuotient(squares + Vec3::Constant(t));
    (ratio.squaredNorm() > 1 ? low : high) = t;
  }
  return squares.cwiseProduct(p).cwiseQuotient(squares + Vec3::Constant(0.5 * (low + high)));
}

TEST(ClosestPoint, OnASphere) {
  const ImplicitPtr f = sphere(1);
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vec3 direction = randomDirection(i);
    const double offset = kReach * (2 * randomUnit(1, RandomStream::test, i) - 1);
    const ClosestPoint nearest = closestPoint(*f, (1 + offset) * direction, kReach);
    ASSERT_TRUE(nearest.found);
    EXPECT_LT((nearest.position - direction).norm(), 2 * kBracket);
    EXPECT_LT((nearest.normal - direction).norm(), 1e-9);
    EXPECT_NEAR(nearest.distance, std::abs(offset), 2 * kBracket);
    expectBracketed(*f, nearest, kReach);
  }
}

TEST(ClosestPoint, OnAMovedTorus) {
  const Mat3 rotation = randomRotation(4);
  const Vec3 translation(10, -20, 5);
  const ImplicitPtr f = transformed(torus(1, 0.4), rotation, translation, 3);
  for (std::uint64_t i = 0; i < 500; ++i) {
    const double u = 6.3 * randomUnit(2, RandomStream::test, 2 * i);
    const double v = 6.3 * randomUnit(2, RandomStream::test, 2 * i + 1);
    const double offset = 0.3 * (2 * randomUnit(1, RandomStream::test, i) - 1);
    const auto place = [&](double r) {
      const double ring = 1 + r * std::cos(v);
      const Vec3 local(ring * std::cos(u), ring * std::sin(u), r * std::sin(v));
      return Vec3(3 * (rotation * local) + translation);
    };
    const ClosestPoint nearest = closestPoint(*f, place(0.4 + offset), 1);
    ASSERT_TRUE(nearest.found);
    EXPECT_LT((nearest.position - place(0.4)).norm(), kSettled);
    EXPECT_NEAR(nearest.distance, 3 * std::abs(offset), kSettled);
    expectBracketed(*f, nearest, 1);
  }
}

TEST(ClosestPoint, OnAnEllipsoidWhoseFormIsNoDistance) {
  const Vec3 axes(1, 0.7, 0.5);
  const ImplicitPtr f = ellipsoid(axes);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    // Off the surface along a normal, at most as far as half its radius of curvature.
    const Vec3 onSurface = axes.cwiseProduct(randomDirection(i));
    const double offset = 0.12 * (2 * randomUnit(1, RandomStream::test, i) - 1);
    const Vec3 p = onSurface + offset * f->gradient(onSurface).normalized();
    const ClosestPoint nearest = closestPoint(*f, p, kReach);
    ASSERT_TRUE(nearest.found);
    const Vec3 exact = nearestOnEllipsoid(axes, p);
    EXPECT_NEAR(nearest.distance, (p - exact).norm(), kSettled);
    EXPECT_LT((nearest.position - exact).norm(), 1e-5 * std::abs(offset) + kSettled);
    EXPECT_LE(std::abs(f->value(nearest.position)), 2 * kBracket * kReach);
    expectBracketed(*f, nearest, kReach);
  }
}

TEST(ClosestPoint, IsThePointItselfOnTheSurface) {
  const ImplicitPtr f = ellipsoid(Vec3(1, 0.7, 0.5));
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Vec3 p = Vec3(1, 0.7, 0.5).cwiseProduct(randomDirection(i));
    const ClosestPoint nearest = closestPoint(*f, p, kReach);
    ASSERT_TRUE(nearest.found);
    EXPECT_LT((nearest.position - p).norm(), 2 * kBracket * kReach);
    EXPECT_EQ(nearest.distance, (nearest.position - p).norm());
  }
}

// Whatever rises with f has the same surface, and so the same nearest points.
TEST(ClosestPoint, DependsOnTheSurfaceAlone) {
  const ImplicitPtr f = ellipsoid(Vec3(1, 0.7, 0.5));
  const Given scaled = mapped(
      f, [](double x) { return 1e6 * x; }, [](double) { return 1e6; });
  const Given steep = mapped(
      f, [](double x) { return std::sinh(20 * x); }, [](double x) { return 20 * std::cosh(20 * x); });
  const Given flat = mapped(
      f, [](double x) { return std::tanh(20 * x); }, [](double x) { return 20 / std::pow(std::cosh(20 * x), 2); });
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Vec3 onSurface = Vec3(1, 0.7, 0.5).cwiseProduct(randomDirection(i));
    const double offset = 0.1 * (2 * randomUnit(1, RandomStream::test, i) - 1);
    const Vec3 p = onSurface + offset * f->gradient(onSurface).normalized();
    for (const Given* other : {&scaled, &steep, &flat}) {
      const ClosestPoint nearest = closestPoint(*other, p, kReach);
      ASSERT_TRUE(nearest.found);
      // A search that converges slowly ends when the distance, where the error counts squared, no longer falls.
      EXPECT_LT((nearest.position - onSurface).norm(), 1e-3 * std::abs(offset) + kSettled);
      EXPECT_NEAR(nearest.distance, std::abs(offset), 1e-6 * std::abs(offset) + kSettled);
    }
  }
}

TEST(ClosestPoint, OnFacesEdgesAndCornersOfABox) {
  const Vec3 half(0.5, 0.6, 0.7);
  const Vec3 shift(1, 2, 3);
  const Mat3 rotation = randomRotation(9);
  // The maximum over the faces: the same zero set as the distance's, but at edges no gradient points to the nearest
  // point.
  const Given faces([=](const Vec3& p) { return ((rotation.transpose() * (p - shift)).cwiseAbs() - half).maxCoeff(); },
                    [=](const Vec3& p) -> Vec3 {
                      const Vec3 q = rotation.transpose() * (p - shift);
                      int axis = 0;
                      (q.cwiseAbs() - half).maxCoeff(&axis);
                      return std::copysign(1.0, q[axis]) * rotation.col(axis);
                    });
  int corners = 0;
  int edges = 0;
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const Vec3 q = randomInBox(3, RandomStream::test, i, Box3(-half - Vec3::Constant(0.1), half + Vec3::Constant(0.1)));
    const Vec3 outside = (q.cwiseAbs() - half).cwiseMax(0.0);
    const int beyond = static_cast<int>((outside.array() > 0).count());
    const double distance = beyond > 0 ? outside.norm() : (half - q.cwiseAbs()).minCoeff();
    if (distance > 0.9 * kReach) continue;
    corners += beyond == 3 ? 1 : 0;
    edges += beyond == 2 ? 1 : 0;
    const ClosestPoint nearest = closestPoint(faces, rotation * q + shift, kReach);
    ASSERT_TRUE(nearest.found) << "point " << q.transpose();
    EXPECT_NEAR(nearest.distance, distance, kSettled) << "point " << q.transpose();
    if (beyond == 0) continue;  // the nearest face may be tied
    EXPECT_LT((nearest.position - (rotation * q.cwiseMax(-half).cwiseMin(half) + shift)).norm(), 1e-6 * kReach);
  }
  EXPECT_GT(corners, 5);
  EXPECT_GT(edges, 100);
}

// Two planes that meet at the y axis at a blunt angle, as in a piecewise linear form. Seen from above, where the solid
// is their intersection, they form a ridge and the nearest point may lie on it; in their union a valley.
TEST(ClosestPoint, OnBluntRidgesAndInValleys) {
  const Vec3 left = Vec3(-0.1, 0, 1).normalized();
  const Vec3 right = Vec3(0.2, 0, 1).normalized();
  const auto higher = [=](const Vec3& p) { return left.dot(p) > right.dot(p); };
  const Given ridge([=](const Vec3& p) { return 3 * std::max(left.dot(p), right.dot(p)); },
                    [=](const Vec3& p) -> Vec3 { return 3 * (higher(p) ? left : right); });
  const Given valley([=](const Vec3& p) { return 3 * std::min(left.dot(p), right.dot(p)); },
                     [=](const Vec3& p) -> Vec3 { return 3 * (higher(p) ? right : left); });
  for (std::uint64_t i = 0; i < 500; ++i) {
    const Vec3 p = 0.1 * randomInBox(5, RandomStream::test, i, Box3(Vec3(-0.3, -1, 0.1), Vec3(0.3, 1, 1)));
    // Exactly: in each half plane x ≤ 0 and x ≥ 0 the foot on the plane or the point on the axis.
    const auto distanceTo = [&](const Vec3& normal, double side) {
      const Vec3 foot = p - normal.dot(p) * normal;
      return side * foot.x() >= 0 ? std::abs(normal.dot(p)) : std::hypot(p.x(), p.z());
    };
    // The ridge's surface is where the greater of the two vanishes: the right plane for x ≥ 0.
    const ClosestPoint onRidge = closestPoint(ridge, p, kReach);
    ASSERT_TRUE(onRidge.found);
    EXPECT_NEAR(onRidge.distance, std::min(distanceTo(right, 1), distanceTo(left, -1)), kSettled);
    const ClosestPoint inValley = closestPoint(valley, p, kReach);
    ASSERT_TRUE(inValley.found);
    const double exact = std::min(distanceTo(left, 1), distanceTo(right, -1));
    EXPECT_GE(inValley.distance, exact - kSettled);
    EXPECT_LE(inValley.distance, 1.02 * exact + kSettled) << "the sides differ by the angle between them at most";
  }
}

// Newton's step is misled by the steep sheet to one side; the other sheet is nearer.
TEST(ClosestPoint, FindsTheNearerOfTwoSheets) {
  const double gap = 0.1;
  // A slot: solid below z = 0 and above z = gap, where f rises ten times as fast above the lower sheet.
  const Given slot([=](const Vec3& p) { return std::min(10 * p.z(), gap - p.z()); },
                   [=](const Vec3& p) { return 10 * p.z() < gap - p.z() ? Vec3(0, 0, 10) : Vec3(0, 0, -1); });
  for (int i = 1; i < 100; ++i) {
    const double z = gap * i / 100;
    const ClosestPoint nearest = closestPoint(slot, Vec3(0.3, 0.2, z), kReach);
    ASSERT_TRUE(nearest.found);
    const double exact = std::min(z, gap - z);
    EXPECT_GE(nearest.distance, exact - kSettled);
    EXPECT_LE(nearest.distance, exact / 0.98 + kSettled) << "z = " << z;
  }
}

TEST(ClosestPoint, WithoutAUsefulGradient) {
  const ImplicitPtr f = sphere(1);
  const Given flat([=](const Vec3& p) { return f->value(p) < 0 ? -1.0 : 1.0; },
                   [](const Vec3&) { return Vec3::Zero(); });
  const Vec3 direction = randomDirection(3);
  const ClosestPoint nearest = closestPoint(flat, 1.05 * direction, kReach);
  ASSERT_TRUE(nearest.found);
  EXPECT_NEAR(nearest.position.norm(), 1, 1e-8);
  EXPECT_GE(nearest.distance, 0.05 - 1e-8);
  EXPECT_LE(nearest.distance, 0.05 * 1.1);
}

TEST(ClosestPoint, IsNotFoundBeyondTheReach) {
  const ImplicitPtr f = sphere(1);
  const Given plain = mapped(
      f, [](double x) { return x; }, [](double) { return 1.0; });
  for (const double offset : {-0.9, -0.3, 0.21, 0.5, 5.0}) {
    EXPECT_FALSE(closestPoint(*f, (1 + offset) * randomDirection(1), kReach).found) << offset;
    EXPECT_FALSE(closestPoint(plain, (1 + offset) * randomDirection(1), kReach).found) << offset;
  }
  EXPECT_TRUE(closestPoint(plain, 1.199 * randomDirection(1), kReach).found);
}

TEST(ClosestPoint, RefusesWhatIsNoPlaceOrLength) {
  const ImplicitPtr f = sphere(1);
  EXPECT_THROW(closestPoint(*f, Vec3::Zero(), 0), UsageError);
  EXPECT_THROW(closestPoint(*f, Vec3::Zero(), std::numeric_limits<double>::infinity()), UsageError);
  EXPECT_THROW(closestPoint(*f, Vec3(0, std::nan(""), 0), 1), UsageError);
}

TEST(ClosestPoints, AreTheSameForAnyNumberOfThreads) {
  const ImplicitPtr f = bumpySphere();
  std::vector<Vec3> points;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    points.emplace_back((0.8 + 0.4 * randomUnit(8, RandomStream::test, i)) * randomDirection(i));
  }
  RunContext context;
  context.threads = 1;
  const auto one = closestPoints(*f, points, kReach, context);
  context.threads = 2;
  const auto two = closestPoints(*f, points, kReach, context);
  ASSERT_EQ(one.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(one[i].position, two[i].position);
    EXPECT_EQ(one[i].found, two[i].found);
    EXPECT_EQ(one[i].position, closestPoint(*f, points[i], kReach).position);
  }
}

}  // namespace
}  // namespace voroform::implicit
