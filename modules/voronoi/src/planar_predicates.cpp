#include "planar_predicates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <CGAL/Exact_rational.h>

namespace voroform::voronoi {

namespace {

using Exact = CGAL::Exact_rational;

// Bounds the rounding of the expressions below, a dozen operations each, relative to the sum of their terms' sizes.
constexpr double kRounding = 1e-14;
// Smaller bounds may have lost digits to underflow.
constexpr double kLeastBound = 1e-280;

double oneNorm(const Vec2& v) { return std::abs(v.x()) + std::abs(v.y()); }

template <class Number>
struct Pair {
  Number x, y;
  Pair(const Vec2& p) : x(p.x()), y(p.y()) {}
  Pair(Number first, Number second) : x(std::move(first)), y(std::move(second)) {}
  friend Pair operator-(const Pair& a, const Pair& b) { return {a.x - b.x, a.y - b.y}; }
  friend Pair operator+(const Pair& a, const Pair& b) { return {a.x + b.x, a.y + b.y}; }
  friend Number dot(const Pair& a, const Pair& b) { return a.x * b.x + a.y * b.y; }
};

// |b − p|² − |a − p|²: positive where p is nearer to a.
template <class Number>
Number advantage(const Pair<Number>& p, const Pair<Number>& a, const Pair<Number>& b) {
  return dot(b - a, (a - p) + (b - p));
}

double advantageBound(const Vec2& p, const Vec2& a, const Vec2& b) {
  return kRounding * oneNorm(b - a) * (oneNorm(a - p) + oneNorm(b - p));
}

// The way from p to q meets the bisector of (site, a) at advantage(p, site, a) / (2 (q − p)·(a − site)).
template <class Number>
std::array<Number, 2> fraction(const Pair<Number>& p, const Pair<Number>& q, const Pair<Number>& site,
                               const Pair<Number>& a) {
  return {advantage(p, site, a), 2 * dot(q - p, a - site)};
}

// The sign of the difference of the two bisectors' places on the way, times both (positive) denominators.
int compareExactly(const Pair<Exact>& p, const Pair<Exact>& q, const Pair<Exact>& site, const Pair<Exact>& a,
                   const Pair<Exact>& b) {
  const auto [aAbove, aBelow] = fraction(p, q, site, a);
  const auto [bAbove, bBelow] = fraction(p, q, site, b);
  const Exact difference = aAbove * bBelow - bAbove * aBelow;
  if (difference != 0) return difference > 0 ? 1 : -1;
  // A shift of p and q by u takes 2 u·(a − site) from the numerator and leaves the denominator. If neither direction
  // decides, the bisectors are the same, and so are a and b.
  const Exact byX = (b.x - site.x) * aBelow - (a.x - site.x) * bBelow;
  if (byX != 0) return byX > 0 ? 1 : -1;
  const Exact byY = (b.y - site.y) * aBelow - (a.y - site.y) * bBelow;
  return byY > 0 ? 1 : -1;
}

}  // namespace

bool isNearer(const Vec2& p, const Vec2& a, const Vec2& b) {
  const double value = advantage<double>(p, b, a);
  const double bound = advantageBound(p, a, b);
  if (std::abs(value) > bound && bound > kLeastBound) return value > 0;
  const Exact exact = advantage<Exact>(p, b, a);
  if (exact != 0) return exact > 0;
  // A shift of p by u adds 2 u·(b − a).
  return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
}

bool isCrossedBefore(const Vec2& p, const Vec2& q, const Vec2& site, const Vec2& a, const Vec2& b) {
  const auto [aAbove, aBelow] = fraction<double>(p, q, site, a);
  const auto [bAbove, bBelow] = fraction<double>(p, q, site, b);
  const double difference = aAbove * bBelow - bAbove * aBelow;
  const double length = oneNorm(q - p);
  const double bound =
      2 * length * (advantageBound(p, site, a) * oneNorm(b - site) + advantageBound(p, site, b) * oneNorm(a - site));
  if (std::abs(difference) > bound && bound > kLeastBound) return difference < 0;
  return compareExactly(p, q, site, a, b) < 0;
}

Vec2 bisectorCrossing(const Vec2& p, const Vec2& q, const Vec2& a, const Vec2& b) {
  // Below this share of its terms the denominator has lost too many digits.
  constexpr double kNearlyParallel = 1e-3;
  const auto [above, below] = fraction<double>(p, q, a, b);
  if (std::abs(below) > kNearlyParallel * 2 * oneNorm(q - p) * oneNorm(b - a)) {
    return p + std::clamp(above / below, 0.0, 1.0) * (q - p);
  }
  const Pair<Exact> first = p;
  const Pair<Exact> last = q;
  const auto [exactAbove, exactBelow] = fraction<Exact>(first, last, a, b);
  const Exact t = exactAbove / exactBelow;
  return {CGAL::to_double(first.x + t * (last.x - first.x)), CGAL::to_double(first.y + t * (last.y - first.y))};
}

}  // namespace voroform::voronoi
