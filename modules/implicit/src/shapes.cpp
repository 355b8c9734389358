#include "voroform/implicit/shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "box_distance.hpp"
#include "rounding.hpp"
#include "voroform/core/error.hpp"

namespace voroform::implicit {

namespace {

void requirePositive(double value, const char* what) {
  if (!(value > 0) || !std::isfinite(value)) throw UsageError(std::string(what) + " must be positive and finite");
}

Box3 cube(const Vec3& halfEdges) { return inflated(Box3(-halfEdges, halfEdges)); }

// p/|p|, and the x axis where that does not exist.
Vec3 directionOf(const Vec3& p) {
  const double length = p.norm();
  return length > 0 ? Vec3(p / length) : Vec3(Vec3::UnitX());
}

class Sphere final : public ImplicitFunction {
 public:
  explicit Sphere(double radius) : radius_(radius) { requirePositive(radius, "sphere: the radius"); }
  double value(const Vec3& p) const override { return p.norm() - radius_; }
  Vec3 gradient(const Vec3& p) const override { return directionOf(p); }
  Box3 bounds() const override { return cube(Vec3::Constant(radius_)); }
  double clearance(const Vec3& p) const override {
    const double distance = p.norm();
    return shrunk(distance - radius_, roundingMargin(distance + radius_));
  }

 private:
  double radius_;
};

class Torus final : public ImplicitFunction {
 public:
  Torus(double majorRadius, double minorRadius) : major_(majorRadius), minor_(minorRadius) {
    requirePositive(majorRadius, "torus: the major radius");
    requirePositive(minorRadius, "torus: the minor radius");
  }
  double value(const Vec3& p) const override {
    const double ring = std::sqrt(p.x() * p.x() + p.y() * p.y()) - major_;
    return std::sqrt(ring * ring + p.z() * p.z()) - minor_;
  }
  Vec3 gradient(const Vec3& p) const override {
    const Vec3 outward = directionOf(Vec3(p.x(), p.y(), 0));
    return directionOf(p - major_ * outward);
  }
  Box3 bounds() const override { return cube(Vec3(major_ + minor_, major_ + minor_, minor_)); }
  // f is the signed distance if minor < major, and has the Lipschitz constant 1 in any case.
  double clearance(const Vec3& p) const override {
    return shrunk(value(p), roundingMargin(p.norm() + major_ + minor_));
  }

 private:
  double major_;
  double minor_;
};

class BoxShape final : public ImplicitFunction {
 public:
  explicit BoxShape(const Vec3& edges) : box_(-0.5 * edges, 0.5 * edges) {
    for (const double edge : edges) requirePositive(edge, "box: each edge");
  }
  double value(const Vec3& p) const override { return boxDistance(box_, p); }
  Vec3 gradient(const Vec3& p) const override { return boxGradient(box_, p); }
  Box3 bounds() const override { return inflated(box_); }
  double clearance(const Vec3& p) const override { return boxClearance(box_, p); }

 private:
  Box3 box_;
};

// f = a_min·(|p/a| − 1), by components of the semi-axes a; |∇f| = a_min·|p/a²| / |p/a| ≤ 1.
class Ellipsoid final : public ImplicitFunction {
 public:
  explicit Ellipsoid(const Vec3& semiAxes)
      : semiAxes_(semiAxes), inverse_(semiAxes.cwiseInverse()), smallest_(semiAxes.minCoeff()) {
    for (const double axis : semiAxes) requirePositive(axis, "ellipsoid: each semi-axis");
  }
  double value(const Vec3& p) const override { return smallest_ * (p.cwiseProduct(inverse_).norm() - 1); }
  Vec3 gradient(const Vec3& p) const override {
    return smallest_ * directionOf(p.cwiseProduct(inverse_)).cwiseProduct(inverse_);
  }
  Box3 bounds() const override { return cube(semiAxes_); }
  double clearance(const Vec3& p) const override { return shrunk(value(p), roundingMargin(p.norm() + smallest_)); }

 private:
  Vec3 semiAxes_;
  Vec3 inverse_;
  double smallest_;
};

class BumpySphere final : public ImplicitFunction {
 public:
  double value(const Vec3& p) const override {
    const double r = p.norm();
    const Vec3 n = directionOf(p);
    return r - 1 - kHeight * std::sin(kWaves * n.x()) * std::sin(kWaves * n.y()) * std::sin(kWaves * n.z());
  }
  Vec3 gradient(const Vec3& p) const override {
    const double r = p.norm();
    const Vec3 n = directionOf(p);
    const Vec3 s = (kWaves * n).array().sin();
    const Vec3 c = (kWaves * n).array().cos();
    const Vec3 bumps = kHeight * kWaves * Vec3(c.x() * s.y() * s.z(), s.x() * c.y() * s.z(), s.x() * s.y() * c.z());
    if (!(r > 0)) return n;
    return n - (bumps - n * n.dot(bumps)) / r;
  }
  Box3 bounds() const override { return cube(Vec3::Constant(1 + kHeight)); }
  // S lies in the shell 1 − 0.12 ≤ r ≤ 1 + 0.12. The bumps' gradient is tangential, and with u, v, w the squared sines
  // its square is at most (0.12·6/r)²·((1−u)vw + u(1−v)w + uv(1−w)) ≤ (0.72/r)², for a trilinear function is largest at
  // a corner of [0, 1]³. So |∇f|² ≤ 1 + (0.72/r)², and f has that Lipschitz constant in every ball beyond radius r.
  double clearance(const Vec3& p) const override {
    constexpr double kInner = 0.8;
    const double r = p.norm();
    const double f = value(p);
    static const double kLipschitz = std::hypot(1.0, kHeight * kWaves / kInner);
    const double toShell = std::max(1 - kHeight - r, r - 1 - kHeight);
    const double inBall = std::min(std::abs(f) / kLipschitz, r - kInner);
    const double distance = shrunk(std::max(toShell, inBall), roundingMargin(r + 10));
    return distance > 0 ? std::copysign(distance, f) : 0.0;
  }

 private:
  static constexpr double kHeight = 0.12;
  static constexpr double kWaves = 6;
};

class GyroidBall final : public ImplicitFunction {
 public:
  double value(const Vec3& p) const override { return std::max(p.norm() - 1, gyroid(p)); }
  Vec3 gradient(const Vec3& p) const override {
    if (p.norm() - 1 >= gyroid(p)) return directionOf(p);
    const Vec3 s = (kFrequency * p).array().sin();
    const Vec3 c = (kFrequency * p).array().cos();
    return kFrequency *
           Vec3(c.x() * c.y() - s.z() * s.x(), c.y() * c.z() - s.x() * s.y(), c.z() * c.x() - s.y() * s.z());
  }
  Box3 bounds() const override { return cube(Vec3::Constant(1)); }
  // The gyroid's partial derivatives are 7·(cos x cos y − sin x sin z) and so on in turn; by Cauchy and Schwarz their
  // squares are at most 49·(cos²y + sin²z), and the three add up to at most 49·3: a Lipschitz constant of 7√3. The
  // maximum of two functions keeps the larger of their signed clearances.
  double clearance(const Vec3& p) const override {
    const double r = p.norm();
    const double ball = shrunk(r - 1, roundingMargin(r + 1));
    const double sheet = gyroid(p) / (kFrequency * std::numbers::sqrt3);
    return std::max(ball, shrunk(sheet, roundingMargin(kFrequency * r + 10)));
  }

 private:
  static double gyroid(const Vec3& p) {
    const Vec3 s = (kFrequency * p).array().sin();
    const Vec3 c = (kFrequency * p).array().cos();
    return s.x() * c.y() + s.y() * c.z() + s.z() * c.x();
  }

  static constexpr double kFrequency = 7;
};

struct NamedShape {
  std::string_view name;
  ImplicitPtr (*make)();
};

constexpr double kUnitRadius = 1;

const std::array<NamedShape, 7>& catalog() {
  static const std::array<NamedShape, 7> shapes = {{
      {"sphere", [] { return sphere(kUnitRadius); }},
      {"torus", [] { return torus(kUnitRadius, 0.4); }},
      {"box", [] { return box(Vec3::Constant(2)); }},
      {"ellipsoid", [] { return ellipsoid(Vec3(1, 0.7, 0.5)); }},
      {"bumpy-sphere", [] { return bumpySphere(); }},
      {"gyroid-ball", [] { return gyroidBall(); }},
      {"two-tori", [] { return twoTori(); }},
  }};
  return shapes;
}

}  // namespace

ImplicitPtr sphere(double radius) { return std::make_shared<Sphere>(radius); }
ImplicitPtr torus(double majorRadius, double minorRadius) { return std::make_shared<Torus>(majorRadius, minorRadius); }
ImplicitPtr box(const Vec3& edges) { return std::make_shared<BoxShape>(edges); }
ImplicitPtr ellipsoid(const Vec3& semiAxes) { return std::make_shared<Ellipsoid>(semiAxes); }
ImplicitPtr bumpySphere() { return std::make_shared<BumpySphere>(); }
ImplicitPtr gyroidBall() { return std::make_shared<GyroidBall>(); }

ImplicitPtr twoTori() {
  const ImplicitPtr ring = torus(0.7, 0.2);
  Mat3 axisZToY;  // a quarter turn about x, free of rounding
  axisZToY << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  return unionOf(transformed(ring, Mat3::Identity(), Vec3(-0.35, 0, 0)), transformed(ring, axisZToY, Vec3(0.35, 0, 0)));
}

std::vector<std::string> shapeNames() {
  std::vector<std::string> names;
  for (const NamedShape& shape : catalog()) names.emplace_back(shape.name);
  return names;
}

ImplicitPtr namedShape(std::string_view name) {
  for (const NamedShape& shape : catalog()) {
    if (shape.name == name) return shape.make();
  }
  std::string message = "unknown shape '" + std::string(name) + "'; the shapes are ";
  bool first = true;
  for (const NamedShape& shape : catalog()) {
    if (!first) message += ", ";
    first = false;
    message += shape.name;
  }
  throw UsageError(message);
}

}  // namespace voroform::implicit
