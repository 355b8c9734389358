// The laws that every implicit function must obey, as one check for all implementations.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "voroform/core/random.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::test {

struct ImplicitLawOptions {
  std::uint64_t seed = 1;
  int points = 20000;
  // Share of the points near S where f may have a kink between the ends of a difference quotient.
  double kinkShare = 0.02;
  // Step of the difference quotients relative to the size of the bounds, and the error allowed relative to |∇f|.
  double differenceStep = 1e-6;
  double gradientTolerance = 1e-4;
  // Share of the points in the bounds whose sign the oracle must decide.
  double decidedShare = 0.5;
};

namespace detail {

inline bool sameBits(double a, double b) { return std::memcmp(&a, &b, sizeof a) == 0; }

inline Vec3 randomDirection(std::uint64_t seed, std::uint64_t index) {
  const Box3 cube(Vec3::Constant(-1), Vec3::Constant(1));
  for (std::uint64_t attempt = 0; attempt < 64; ++attempt) {
    const Vec3 v = randomInBox(seed + attempt, RandomStream::test, index, cube);
    if (v.norm() > 0.1 && v.norm() <= 1) return v.normalized();
  }
  return Vec3::UnitX();
}

inline Box3 grown(const Box3& box, double share) {
  const Vec3 by = Vec3::Constant(share * box.sizes().maxCoeff());
  return {box.min() - by, box.max() + by};
}

// A point on S to within rounding, on the segment from an inside to an outside point.
inline Vec3 bisect(const implicit::ImplicitFunction& f, Vec3 inside, Vec3 outside) {
  for (int i = 0; i < 60; ++i) {
    const Vec3 middle = 0.5 * (inside + outside);
    (f.value(middle) < 0 ? inside : outside) = middle;
  }
  return 0.5 * (inside + outside);
}

}  // namespace detail

// Two in five points spread over the bounds and somewhat beyond, the others at distances to S from a tenth of the
// bounds down to a billionth.
inline std::vector<Vec3> lawPoints(const implicit::ImplicitFunction& f, const ImplicitLawOptions& options) {
  const Box3 box = detail::grown(f.bounds(), 0.1);
  const double size = box.sizes().maxCoeff();
  std::vector<Vec3> points;
  std::vector<Vec3> inside;
  std::vector<Vec3> outside;
  const auto count = static_cast<std::uint64_t>(options.points);
  for (std::uint64_t i = 0; i < count * 2 / 5; ++i) {
    points.push_back(randomInBox(options.seed, RandomStream::test, i, box));
    (f.value(points.back()) < 0 ? inside : outside).push_back(points.back());
  }
  if (inside.empty() || outside.empty()) return points;
  for (std::uint64_t i = points.size(); i < count; ++i) {
    const Vec3& a = inside[randomBits(options.seed + 1, RandomStream::test, i) % inside.size()];
    const Vec3& b = outside[randomBits(options.seed + 2, RandomStream::test, i) % outside.size()];
    const double distance = size * std::pow(10.0, -1 - 8 * randomUnit(options.seed + 3, RandomStream::test, i));
    points.push_back(detail::bisect(f, a, b) + distance * detail::randomDirection(options.seed + 4, i));
  }
  return points;
}

// What f violates, one line for each law; empty for a lawful f.
inline std::vector<std::string> violatedLaws(const implicit::ImplicitPtr& function, const ImplicitLawOptions& options) {
  const implicit::ImplicitFunction& f = *function;
  std::vector<std::string> violated;
  const std::vector<Vec3> points = lawPoints(f, options);
  const std::size_t count = points.size();
  const Box3 box = f.bounds();
  const double size = box.sizes().maxCoeff();
  std::vector<double> value(count);
  for (std::size_t i = 0; i < count; ++i) value[i] = f.value(points[i]);

  // There is an inside and an outside, and no NaN.
  const auto negatives = std::count_if(value.begin(), value.end(), [](double v) { return v < 0; });
  if (negatives == 0 || negatives == static_cast<std::ptrdiff_t>(count))
    violated.emplace_back("sign: no inside or no outside");
  if (std::any_of(value.begin(), value.end(), [](double v) { return std::isnan(v); }))
    violated.emplace_back("sign: NaN");

  // The bounds contain the solid.
  const Box3 around = detail::grown(box, 0.5);
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = randomInBox(options.seed + 5, RandomStream::test, i, around);
    if (!box.contains(p) && f.value(p) < 0) ++beyond;
    if (!box.contains(points[i]) && value[i] < 0) ++beyond;
  }
  if (beyond > 0) violated.push_back("bounds: " + std::to_string(beyond) + " inside points beyond");

  // A clearance has the sign of f, here and in the whole ball of its size. The radius is taken a little less than
  // full, so that the rounding of the test itself does not count.
  std::size_t wrongSign = 0;
  std::size_t wrongBall = 0;
  std::size_t decided = 0;
  std::size_t withinBounds = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double clearance = f.clearance(points[i]);
    if (i < count * 2 / 5 && box.contains(points[i])) {
      ++withinBounds;
      if (clearance != 0) ++decided;
    }
    if (clearance == 0) continue;
    if ((clearance < 0) != (value[i] < 0)) ++wrongSign;
    for (std::uint64_t k = 0; k < 4; ++k) {
      const double share = k == 0 ? 1 - 1e-9 : std::cbrt(randomUnit(options.seed + 6, RandomStream::test, 4 * i + k));
      const Vec3 q = points[i] + share * std::abs(clearance) * detail::randomDirection(options.seed + 7, 4 * i + k);
      if ((f.value(q) < 0) != (clearance < 0)) ++wrongBall;
    }
  }
  if (wrongSign > 0) violated.push_back("clearance: " + std::to_string(wrongSign) + " signs contradict f");
  if (wrongBall > 0) violated.push_back("clearance: " + std::to_string(wrongBall) + " balls meet S");
  if (static_cast<double>(decided) < options.decidedShare * static_cast<double>(withinBounds)) {
    violated.push_back("clearance: decides only " + std::to_string(decided) + " of " + std::to_string(withinBounds));
  }

  // The gradient agrees with central differences.
  const double step = options.differenceStep * size;
  std::size_t steep = 0;
  for (std::size_t i = count * 2 / 5; i < count; ++i) {
    const Vec3 gradient = f.gradient(points[i]);
    Vec3 difference;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 offset = step * Vec3::Unit(axis);
      difference[axis] = (f.value(points[i] + offset) - f.value(points[i] - offset)) / (2 * step);
    }
    if (!((gradient - difference).norm() <= options.gradientTolerance * (gradient.norm() + difference.norm()))) ++steep;
  }
  if (static_cast<double>(steep) > options.kinkShare * static_cast<double>(count)) {
    violated.push_back("gradient: differs from differences at " + std::to_string(steep) + " points");
  }

  // Lists give the same bits as single points, also from several threads at once.
  constexpr std::size_t kThreads = 4;
  std::array<std::vector<double>, kThreads> listed;
  std::array<std::vector<double>, kThreads> cleared;
  std::vector<std::thread> threads;
  for (std::size_t thread = 0; thread < kThreads; ++thread) {
    threads.emplace_back([&, thread] {
      listed[thread].resize(count);
      cleared[thread].resize(count);
      f.values(points, listed[thread]);
      f.clearances(points, cleared[thread]);
    });
  }
  for (std::thread& thread : threads) thread.join();
  bool same = true;
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t thread = 0; thread < kThreads; ++thread) {
      same = same && detail::sameBits(listed[thread][i], value[i]);
      same = same && detail::sameBits(cleared[thread][i], f.clearance(points[i]));
    }
  }
  if (!same) violated.emplace_back("values: other bits in a list or from several threads");

  // Moving and scaling the solid moves and scales f.
  const double scale = 2.5;
  const Mat3 rotation = randomRotation(options.seed);
  const Vec3 translation = size * Vec3(3, -2, 0.5);
  const implicit::ImplicitPtr moved = implicit::transformed(function, rotation, translation, scale);
  std::size_t unmoved = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = rotation * (scale * points[i]) + translation;
    const double tolerance = 1e-9 * scale * (std::abs(value[i]) + size * f.gradient(points[i]).norm());
    if (!(std::abs(moved->value(p) - scale * value[i]) <= tolerance)) ++unmoved;
  }
  if (static_cast<double>(unmoved) > options.kinkShare * static_cast<double>(count)) {
    violated.push_back("motion: f does not move with the solid at " + std::to_string(unmoved) + " points");
  }
  return violated;
}

}  // namespace voroform::test
