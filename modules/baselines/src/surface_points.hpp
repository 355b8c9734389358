// A few points on every piece of the surface, for Delaunay refinement to start from.
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/core/types.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::baselines {

// Where Delaunay refinement looks for the surface, and how precisely.
struct SurfaceSearch {
  Box3 box;                         // contains the solid, with room around it
  double spacing = 0;               // of the grid whose edges are searched, and at least that of the points found
  double tolerance = 0;             // length of the bracket at which root finding stops
  std::uint64_t seed = 0;           // places the grid
  std::size_t pointsPerPiece = 24;  // at most
};

// Asks the oracle first, which is cheaper than f and cannot contradict it.
bool inside(const implicit::ImplicitFunction& f, const Vec3& p);

// The root of f on the segment from a to b, one of which is inside and the other is not.
Vec3 surfacePoint(const implicit::ImplicitFunction& f, const Vec3& a, const Vec3& b, double tolerance);

// Points on S for each connected piece of it that edges of the grid cross: well spread, so many at most. Pieces
// that share a cube of the grid count as one. Runs on one thread.
std::vector<Vec3> initialSurfacePoints(const implicit::ImplicitFunction& f, const SurfaceSearch& search);

}  // namespace voroform::baselines
