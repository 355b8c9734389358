// The point of S nearest to a given point.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::implicit {

struct ClosestPoint {
  Vec3 position = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // ∇f/‖∇f‖ there
  double distance = 0;         // from the query point to `position`
  bool found = false;          // a sign change of f brackets `position`
};

// Nearest point of S by a safeguarded projection, for p near S (|distance| up to about `reach`): the result is a point
// where f changes sign, refined until the line p–position is normal to S (or the distance no longer falls).
// `reach` > 0 also bounds the steps; found is false if no sign change lies within it.
ClosestPoint closestPoint(const ImplicitFunction& f, const Vec3& p, double reach);

// One entry a point; in parallel, the same bits for any number of threads.
std::vector<ClosestPoint> closestPoints(const ImplicitFunction& f, std::span<const Vec3> points, double reach,
                                        const RunContext& context);

}  // namespace voroform::implicit
