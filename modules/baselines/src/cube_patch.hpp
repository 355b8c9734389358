// The triangles of the surface in one cube.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "cube_topology.hpp"
#include "voroform/core/types.hpp"

namespace voroform::baselines {

// Points 0 … 11 are those on the cube's edges, the following ones lie in its interior, in the unit cube's coordinates.
// Triangles run counter-clockwise seen from outside the solid.
struct CubePatch {
  std::vector<std::array<std::uint8_t, 3>> triangles;
  std::vector<Vec3> interior;
};

// Point of a cut edge in the unit cube; t in (0, 1) is its place along the edge.
Vec3 pointOnEdge(int edge, double t);

// Triangulates the cut without crossings wherever in the open edges its vertices lie. No triangle, and no edge but the
// loops' segments, lies in a face of the cube, so patches of different cubes meet in their loops alone.
// edgeParameters[e] is read for cut edges only. `patch` is overwritten.
void triangulateCut(const CubeTopology& cube, const std::array<double, 12>& edgeParameters, CubePatch& patch);

}  // namespace voroform::baselines
