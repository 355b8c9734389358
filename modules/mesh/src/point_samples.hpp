// The point-location part of the certificate.
#pragma once

#include <cstdint>

#include "boundary_topology.hpp"
#include "voroform/core/run_context.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {

struct PointSamples {
  Index located = 0;      // points that could be decided
  Violations violations;  // elements: numbers of samples
};

// Locates seeded random points, half of them in the complex's bounding box and half in boxes of random cells, in the
// cells (rays towards +z) and, independently, in the boundary (rays towards +x). Each must lie in exactly one cell and
// inside, or in none and outside. Coordinates must be finite, indices in range.
PointSamples locateSamples(const PolyhedralComplex& complex, const CellFaces& rows, const TriangleMesh& boundary,
                           Index samples, std::uint64_t seed, const RunContext& context);

}  // namespace voroform::mesh
