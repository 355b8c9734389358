// The point-location part of the certificate of planar tessellations.
#pragma once

#include <cstdint>

#include "boundary_topology.hpp"
#include "voroform/core/run_context.hpp"
#include "voroform/mesh/planar_region.hpp"
#include "voroform/mesh/planar_tessellation.hpp"

namespace voroform::mesh {

// What rounding may move a point of the region by: far from the origin it is more than a share of the region's size.
double coordinateRounding(const PlanarRegion& region);

struct PlanarPointSamples {
  Index located = 0;      // points that could be decided
  Violations violations;  // elements: numbers of samples
};

// Locates seeded random points, half of them in the region's bounding box and half in boxes of random cells, by their
// winding numbers about the cells: 1 about one cell and 0 about all others inside the region, 0 about all outside. The
// cell's site is to be nearer than its neighbors'. Coordinates must be finite, indices in range.
PlanarPointSamples locateSamples(const PlanarTessellation& tessellation, const PlanarRegion& region, Index samples,
                                 std::uint64_t seed, const RunContext& context);

}  // namespace voroform::mesh
