#include "voroform/implicit/closest_point.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>

#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/implicit/roots.hpp"

namespace voroform::implicit {

namespace {

// Of the reach: how far apart the ends of a final bracket are at most.
constexpr double kBracket = 1e-10;

// The zero set of f linearized at a point: normal·x = offset.
struct TangentPlane {
  Vec3 normal;
  double offset;

  double excess(const Vec3& x) const { return normal.dot(x) - offset; }
};

// A few planes that bound a region which is convex as seen from the query point: what lies beyond every one of them.
class Cuts {
 public:
  void keepOnly(const TangentPlane& plane) {
    planes_[0] = plane;
    count_ = 1;
  }

  void add(const TangentPlane& plane) {
    if (count_ == planes_.size()) {
      std::move(planes_.begin() + 1, planes_.end(), planes_.begin());
      --count_;
    }
    planes_[count_++] = plane;
  }

  // The point nearest to p beyond all planes, where p is on the positive side (side = 1) or the negative one (−1): by
  // trying every set of at most three planes to lie on. Nothing if rounding leaves none of them.
  std::optional<Vec3> nearestTo(const Vec3& p, double side, double slack) const {
    std::optional<Vec3> best;
    const auto consider = [&](const Vec3& x) {
      if (!x.allFinite() || (best && (x - p).squaredNorm() >= (*best - p).squaredNorm())) return;
      for (std::size_t i = 0; i < count_; ++i) {
        if (side * planes_[i].excess(x) > slack) return;
      }
      best = x;
    };
    for (std::size_t i = 0; i < count_; ++i) {
      const TangentPlane& a = planes_[i];
      consider(p - a.excess(p) * a.normal);
      for (std::size_t j = 0; j < i; ++j) {
        const TangentPlane& b = planes_[j];
        const Vec3 line = a.normal.cross(b.normal);
        const double squared = line.squaredNorm();
        constexpr double kParallel = 1e-16;  // of the sine, squared
        if (!(squared > kParallel)) continue;
        consider(p - (a.excess(p) * b.normal.cross(line) + b.excess(p) * line.cross(a.normal)) / squared);
        for (std::size_t k = 0; k < j; ++k) {
          const TangentPlane& c = planes_[k];
          const double determinant = line.dot(c.normal);
          consider(p - (a.excess(p) * b.normal.cross(c.normal) + b.excess(p) * c.normal.cross(a.normal) +
                        c.excess(p) * line) /
                           determinant);
        }
      }
    }
    return best;
  }

 private:
  std::array<TangentPlane, 4> planes_;
  std::size_t count_ = 0;
};

// Directions that make angles of 40, 80, 130 and 180 degrees with the z axis.
const std::array<Vec3, 12>& probes() {
  static const std::array<Vec3, 12> directions = [] {
    std::array<Vec3, 12> result;
    std::size_t next = 0;
    const auto ring = [&](int count, double degrees, double turn) {
      const double polar = degrees * std::numbers::pi / 180;
      for (int i = 0; i < count; ++i) {
        const double azimuth = 2 * std::numbers::pi * (i + turn) / count;
        result[next++] =
            Vec3(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar));
      }
    };
    ring(4, 40, 0);
    ring(4, 80, 0.5);
    ring(3, 130, 0);
    ring(1, 180, 0);
    return result;
  }();
  return directions;
}

// Columns: two directions across `axis`, and `axis`.
Mat3 frameAlong(const Vec3& axis) {
  Mat3 frame;
  frame.col(2) = axis;
  frame.col(0) = axis.unitOrthogonal();
  frame.col(1) = axis.cross(frame.col(0));
  return frame;
}

class Search {
 public:
  Search(const ImplicitFunction& f, const Vec3& p, double reach)
      : f_(f), p_(p), reach_(reach), value_(f.value(p)), side_(value_ < 0 ? -1 : 1) {}

  ClosestPoint run() {
    const double clearance = std::abs(f_.clearance(p_));
    if (clearance > reach_) return {};
    // From p itself along the gradient; where that leads nowhere, from whatever crossing the probes meet.
    if (!refine(p_)) searchAround();
    if (!best_.found) return {};
    improve(clearance);
    const Vec3 gradient = f_.gradient(best_.position);
    const double slope = gradient.norm();
    if (slope > 0) {
      best_.normal = gradient / slope;
    } else if (best_.distance > 0) {
      best_.normal = side_ / best_.distance * (p_ - best_.position);
    }
    return best_;
  }

 private:
  struct Minimum {
    Vec3 position;
    bool settled;
  };

  bool isAcross(double value) const { return (value < 0) != (side_ < 0); }

  // Minimizes |x − p| over f(x) = 0 by replacing f with its linearization at the last point: a step of Newton's method
  // and the tangential correction in one. It converges at the rate distance × curvature on a smooth S, and ends exactly
  // where S is a plane. At a ridge between two pieces it would jump to and fro; then the linearizations of both count.
  Minimum minimize(Vec3 x) const {
    constexpr int kMostSteps = 24;
    constexpr double kSlowConvergence = 0.5;
    const double finest = 1e-2 * kBracket * reach_;
    Cuts cuts;
    bool useCuts = false;
    double lastStep = 0;
    for (int k = 0; k < kMostSteps; ++k) {
      const double value = k == 0 && x == p_ ? value_ : f_.value(x);
      const Vec3 gradient = f_.gradient(x);
      const double slope = gradient.norm();
      if (!(slope > 0) || !std::isfinite(value) || !std::isfinite(slope)) break;
      const TangentPlane plane{gradient / slope, (gradient.dot(x) - value) / slope};
      // Beyond S although short of all cuts: S is not convex here as seen from p, and the older cuts mislead.
      if (isAcross(value) && std::abs(value) > 0.1 * lastStep * slope) {
        cuts.keepOnly(plane);
      } else {
        cuts.add(plane);
      }
      Vec3 next = p_ - plane.excess(p_) * plane.normal;
      if (useCuts) next = cuts.nearestTo(p_, side_, finest).value_or(next);
      const double distance = (next - p_).norm();
      if (distance > reach_) next = p_ + reach_ / distance * (next - p_);
      const double step = (next - x).norm();
      x = next;
      if (step <= kSettled * distance || step <= finest) return {x, true};
      useCuts = useCuts || (k >= 2 && step > kSlowConvergence * lastStep);
      lastStep = step;
    }
    return {x, false};
  }

  // Looks for S on the ray from p around `distance`. A crossing becomes the result if it is the nearest so far.
  bool landOnRay(const Vec3& direction, double distance) {
    for (double width = kBracket / 2; width < 2; width *= 1e3) {
      double near = distance - width * reach_;
      const double far = std::min(distance + width * reach_, reach_);
      if (width > kBracket) near = std::max(near, 0.0);
      const double nearValue = near == 0 ? value_ : f_.value(p_ + near * direction);
      const double farValue = f_.value(p_ + far * direction);
      if ((nearValue < 0) != (farValue < 0)) return takeCrossing(direction, near, far, nearValue, farValue);
    }
    return false;
  }

  bool takeCrossing(const Vec3& direction, double near, double far, double nearValue, double farValue) {
    double crossing = (near + far) / 2;
    if (far - near > kBracket * reach_) {
      std::int64_t evaluations = 0;
      const double t = findRoot(f_, p_ + near * direction, p_ + far * direction, nearValue, farValue,
                                kBracket * reach_ / (far - near), RootFinder::itp, evaluations);
      crossing = near + t * (far - near);
    }
    const Vec3 position = p_ + crossing * direction;
    const double distance = (position - p_).norm();
    if (distance > reach_ || (best_.found && distance >= best_.distance)) return best_.found;
    best_.position = position;
    best_.distance = distance;
    best_.found = true;
    return true;
  }

  // Searches locally from a point near S; true if there is a result. A search that has not settled, or not on S, for f
  // bends too much between p and S, goes on from where it met S as long as that comes nearer.
  bool refine(Vec3 start) {
    constexpr int kMostRounds = 8;
    for (int round = 0; round < kMostRounds; ++round) {
      const Minimum minimum = minimize(start);
      const double before = best_.found ? best_.distance : 2 * reach_;
      if (!land(minimum.position)) return false;
      if (best_.distance >= before) break;
      const double miss = (best_.position - minimum.position).norm();
      if (minimum.settled && miss <= kSettled * best_.distance + kBracket * reach_) break;
      start = best_.position;
    }
    return true;
  }

  // Looks for S on the ray from p to a point that lies on it or nearly so; true if there is a result.
  bool land(const Vec3& end) {
    const double distance = (end - p_).norm();
    // Too near to tell a direction: S is looked for along its normal.
    constexpr double kNoDirection = 1e-8;
    if (distance < kNoDirection * reach_) {
      const Vec3 gradient = f_.gradient(end);
      const double slope = gradient.norm();
      if (!(slope > 0)) return false;
      const Vec3 toSurface = -side_ / slope * gradient;
      return landOnRay(toSurface, toSurface.dot(end - p_));
    }
    const Vec3 direction = (end - p_) / distance;
    if (landOnRay(direction, distance)) return true;
    // At a thin ridge the ray may only graze S.
    const Mat3 frame = frameAlong(direction);
    for (const Vec3& probe : probes()) {
      const Vec3 beyond = end + kGraze * distance * (frame * probe) - p_;
      const double length = beyond.norm();
      const double value = f_.value(p_ + beyond);
      if (isAcross(value)) return takeCrossing(beyond / length, 0, length, value_, value);
    }
    return false;
  }

  // Without a result: the first crossing that probes of growing length meet, along the gradient and all around.
  void searchAround() {
    const Vec3 gradient = f_.gradient(p_);
    const double slope = gradient.norm();
    Mat3 frame = frameAlong(slope > 0 ? Vec3(-side_ / slope * gradient) : Vec3(Vec3::UnitZ()));
    constexpr double kFirstLength = 1.0 / 32;
    constexpr double kGrowth = 1.4;
    for (double length = kFirstLength * reach_; length <= reach_; length *= kGrowth) {
      const auto meets = [&](const Vec3& direction) {
        const double value = f_.value(p_ + length * direction);
        return isAcross(value) && takeCrossing(direction, 0, length, value_, value);
      };
      bool met = meets(frame.col(2));
      for (const Vec3& probe : probes()) met = meets(frame * probe) || met;
      if (met) break;
      // Other directions for the next length.
      frame = frameAlong(frame * probes()[4]);
    }
    if (best_.found) refine(best_.position);
  }

  // A point short of the result's distance where f has the other sign shows that S comes nearer elsewhere.
  void improve(double clearance) {
    constexpr int kMostTries = 4;
    constexpr double kShort = 0.98;
    for (int tries = 0; tries < kMostTries && clearance < kShort * best_.distance; ++tries) {
      const double before = best_.distance;
      const double length = kShort * before;
      if (length < kBracket * reach_) return;
      const Mat3 frame = frameAlong((best_.position - p_) / before);
      for (const Vec3& probe : probes()) {
        const Vec3 direction = frame * probe;
        const double value = f_.value(p_ + length * direction);
        if (isAcross(value) && length <= best_.distance) takeCrossing(direction, 0, length, value_, value);
      }
      if (best_.distance == before) return;
      refine(best_.position);
    }
  }

  static constexpr double kSettled = 1e-6;  // of the distance: makes an error of its square in the distance
  static constexpr double kGraze = 1e-3;    // of the distance: how far beside a grazed ridge S is looked for

  const ImplicitFunction& f_;
  const Vec3& p_;
  double reach_;
  double value_;
  double side_;
  ClosestPoint best_;
};

}  // namespace

ClosestPoint closestPoint(const ImplicitFunction& f, const Vec3& p, double reach) {
  if (!(reach > 0) || !std::isfinite(reach)) throw UsageError("closestPoint: the reach must be positive and finite");
  if (!p.allFinite()) throw UsageError("closestPoint: the point must be finite");
  return Search(f, p, reach).run();
}

std::vector<ClosestPoint> closestPoints(const ImplicitFunction& f, std::span<const Vec3> points, double reach,
                                        const RunContext& context) {
  constexpr std::size_t kGrain = 64;
  std::vector<ClosestPoint> result(points.size());
  parallelFor(context, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = closestPoint(f, points[i], reach);
  });
  return result;
}

}  // namespace voroform::implicit
