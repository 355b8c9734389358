// Self-intersections of a triangle mesh, decided exactly.
#pragma once

#include <array>
#include <cstdint>

#include "voroform/core/run_context.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {

struct SelfIntersections {
  std::int64_t pairs = 0;
  // The first pair of triangles found, if there is one.
  std::array<Index, 2> first = {kNone, kNone};
};

// Counts pairs of triangles that share a point which is not on a vertex or an edge that both name. Coordinates must be
// finite, indices in range. Triangles whose corners are collinear are left out: each lies on edges of its neighbors,
// which are examined.
SelfIntersections selfIntersections(const TriangleMesh& mesh, const RunContext& context);

}  // namespace voroform::mesh
