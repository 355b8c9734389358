// Nearest neighbors in a point cloud.
#pragma once

#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"

namespace voroform::points {

// Median over the points of the mean distance to their six nearest neighbors. Clouds of more than 100,000 points are
// sampled evenly in their order. Needs seven points; O(n log n).
double medianSpacing(const std::vector<Vec3>& positions, const RunContext& context);

}  // namespace voroform::points
