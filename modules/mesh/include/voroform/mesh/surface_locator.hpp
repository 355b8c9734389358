// Is a point inside a closed surface?
#pragma once

#include <vector>

#include "voroform/core/types.hpp"
#include "voroform/mesh/box_tree.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {

enum class Location {
  outside,
  inside,
  uncertain,  // the ray passes too near to an edge, or the point lies too near to a triangle, to be decided
};

// The parity of the crossings of an axis-parallel ray with a triangle mesh. The mesh must outlive the locator, and its
// coordinates must be finite. Safe to use from many threads at once; O(log n) a point on surfaces of compact triangles.
class SurfaceLocator {
 public:
  // axis: 0, 1, 2 for rays towards +x, +y, +z. Points nearer than `tolerance` to a triangle, or whose ray passes
  // nearer than that to an edge, are uncertain.
  SurfaceLocator(const TriangleMesh& mesh, int axis, double tolerance);

  Location locate(const Vec3& point) const;

 private:
  const TriangleMesh& mesh_;
  int axis_;
  double tolerance_;
  BoxTree tree_;
};

// A tolerance for surfaces and points within this box: far above the rounding of the coordinates, far below any
// length of interest.
double locationTolerance(const Box3& box);

}  // namespace voroform::mesh
