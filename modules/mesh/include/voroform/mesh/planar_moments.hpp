// Areas, centroids and second moments of the cells of a planar tessellation.
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/mesh/planar_tessellation.hpp"

namespace voroform::mesh {

// Moments of one cell by Green's theorem over its loops, so they hold for cells that are not convex, not connected or
// have holes. All 0 for an empty cell.
struct PlanarCellMoments {
  double area = 0;
  Vec2 centroid = Vec2::Zero();
  // ∫ ‖x − centroid‖² dx, in units⁴.
  double secondMoment = 0;
};

// One entry a cell. Computed about the cell's own first vertex, so that the result does not lose digits far from the
// origin.
std::vector<PlanarCellMoments> cellMoments(const PlanarTessellation& tessellation, const RunContext& context);

// One entry a cell: 1 if an edge of it lies on the region's boundary, else 0.
std::vector<std::uint8_t> boundaryCells(const PlanarTessellation& tessellation);

}  // namespace voroform::mesh
