// Whether a point lies in the solid.
#pragma once

#include "voroform/implicit/implicit_function.hpp"

namespace voroform::cvt {

// By the oracle, and where it is silent by f.
inline bool isInside(const implicit::ImplicitFunction& f, const Vec3& p) {
  const double clearance = f.clearance(p);
  return clearance < 0 || (clearance == 0 && f.value(p) < 0);
}

}  // namespace voroform::cvt
