// Normals for clouds that come without.
#pragma once

#include "voroform/core/run_context.hpp"
#include "voroform/points/prepare.hpp"

namespace voroform::points {

inline constexpr int kFewestNormalNeighbors = 6;

// Fits a plane to each point's neighbors and orients the normals consistently along a minimum spanning tree of the
// neighborhood graph, each connected piece of it for itself (H. Hoppe et al., Surface Reconstruction from Unorganized
// Points, 1992), and outward: the piece encloses a positive volume. Points that the tree does not reach are dropped and
// counted. O(n log n).
void estimateNormals(PointCloud& cloud, const PrepareOptions& options, PrepareSummary& summary,
                     const RunContext& context);

}  // namespace voroform::points
