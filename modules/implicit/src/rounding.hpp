// Margins for rounding errors, shared by everything that promises a rigorous clearance or bounds.
#pragma once

#include <cmath>
#include <limits>

#include "voroform/core/types.hpp"

namespace voroform::implicit {

// A bound of the rounding error of a distance computed in a few operations from numbers of this magnitude.
inline double roundingMargin(double magnitude) { return 32 * std::numeric_limits<double>::epsilon() * magnitude; }

// The signed distance moved toward zero by the margin, and zero rather than past it.
inline double shrunk(double signedDistance, double margin) {
  const double rest = std::abs(signedDistance) - margin;
  return rest > 0 ? std::copysign(rest, signedDistance) : 0.0;
}

// The box grown by a billionth of its size and place, far more than any rounding error.
inline Box3 inflated(const Box3& box) {
  if (box.isEmpty()) return box;
  const double grow = 1e-9 * (box.sizes().maxCoeff() + 1e-3 * box.center().norm());
  return {box.min() - Vec3::Constant(grow), box.max() + Vec3::Constant(grow)};
}

}  // namespace voroform::implicit
