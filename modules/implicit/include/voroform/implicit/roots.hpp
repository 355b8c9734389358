// Root finding on a segment with the guarantee of bisection.
#pragma once

#include <functional>

#include "voroform/core/types.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::implicit {

enum class RootFinder {
  itp,  // interpolate–truncate–project (Oliveira & Takahashi 2020): superlinear, at most one step more than bisection
  bisection,  // the thesis's choice (5.2.2.1)
};

// The parameter t in (0, 1) with f(a + t(b − a)) = 0 to within `tolerance` (on t), given the values at the ends, of
// which exactly one is negative (0 counts as outside). `evaluations` is increased by the number of calls of f.
double findRoot(const ImplicitFunction& f, const Vec3& a, const Vec3& b, double valueA, double valueB, double tolerance,
                RootFinder finder, std::int64_t& evaluations);

}  // namespace voroform::implicit
