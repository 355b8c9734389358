#include "voroform/implicit/roots.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "voroform/core/error.hpp"

namespace voroform::implicit {

namespace {

// Narrower brackets cannot be told apart near t = 1.
constexpr double kSmallestTolerance = 4 * std::numeric_limits<double>::epsilon();

struct Bracket {
  double low = 0;
  double high = 1;
  double valueLow;
  double valueHigh;

  double width() const { return high - low; }
  double middle() const { return low + 0.5 * (high - low); }

  // Where the chord of f through the bracket's ends vanishes; the middle if that is not a number inside.
  double falsePosition() const {
    const double t = low + (high - low) * (valueLow / (valueLow - valueHigh));
    return t >= low && t <= high ? t : middle();
  }

  void shrink(double t, double value) {
    if ((value < 0) == (valueLow < 0)) {
      low = t;
      valueLow = value;
    } else {
      high = t;
      valueHigh = value;
    }
  }
};

// The next point to evaluate (Oliveira & Takahashi 2020, algorithm 1, with κ₁ = 0.2, κ₂ = 2): the false position, moved
// toward the middle by δ so that both ends of the bracket close in, and projected to within `slack` of the middle.
double itpPoint(const Bracket& bracket, double slack) {
  constexpr double kTruncation = 0.2;
  const double middle = bracket.middle();
  const double falsePosition = bracket.falsePosition();
  const double toMiddle = middle - falsePosition;
  const double truncation = kTruncation * bracket.width() * bracket.width();
  const double truncated =
      truncation <= std::abs(toMiddle) ? falsePosition + std::copysign(truncation, toMiddle) : middle;
  if (std::abs(truncated - middle) <= slack) return truncated;
  return middle - std::copysign(slack, toMiddle);
}

}  // namespace

double findRoot(const ImplicitFunction& f, const Vec3& a, const Vec3& b, double valueA, double valueB, double tolerance,
                RootFinder finder, std::int64_t& evaluations) {
  if ((valueA < 0) == (valueB < 0)) throw Error("findRoot: exactly one end must be negative");
  const double width = std::clamp(tolerance, kSmallestTolerance, 0.5);
  const Vec3 direction = b - a;
  Bracket bracket{.valueLow = valueA, .valueHigh = valueB};

  // Bisection needs ⌈log₂(1/width)⌉ steps and ITP at most one more: after j steps its bracket is at most as wide as
  // bisection's after j − 1, which `reach` keeps track of. A thousandth is left for rounding.
  double reach = std::ldexp(0.5 * width * (1 - 0x1p-10), static_cast<int>(std::ceil(-std::log2(width))) + 1);
  while (bracket.width() > width) {
    const double middle = bracket.middle();
    double t = middle;
    if (finder == RootFinder::itp) t = itpPoint(bracket, std::max(0.0, reach - 0.5 * bracket.width()));
    if (!(t > bracket.low && t < bracket.high)) t = middle;
    if (!(t > bracket.low && t < bracket.high)) break;  // two neighboring numbers
    const double value = f.value(a + t * direction);
    ++evaluations;
    reach *= 0.5;
    if (value == 0) {
      bracket.low = bracket.high = t;
      break;
    }
    bracket.shrink(t, value);
  }
  // The chord's zero costs nothing and is usually far closer than the bracket is wide.
  const bool chord = finder == RootFinder::itp && bracket.width() > 0;
  const double t = chord ? bracket.falsePosition() : bracket.middle();
  constexpr double kOffEnds = 0x1p-53;
  return std::clamp(t, kOffEnds, 1 - kOffEnds);
}

}  // namespace voroform::implicit
