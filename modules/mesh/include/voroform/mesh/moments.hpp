// Volumes, centroids and second moments of the cells of a complex.
#pragma once

#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {

// Moments of one cell by the divergence theorem over its oriented faces (a face is cut into a fan about its first
// vertex), so they hold for cells that are not convex or not connected.
struct CellMoments {
  double volume = 0;
  Vec3 centroid = Vec3::Zero();
  // ∫ ‖x − centroid‖² dx, in units⁵.
  double secondMoment = 0;
};

// One entry a cell. Computed about the cell's own first vertex, so that the result does not lose digits far from the
// origin.
std::vector<CellMoments> cellMoments(const PolyhedralComplex& complex, const RunContext& context);

// Volume enclosed by a closed, outward mesh (divergence theorem about the center of its bounding box); 0 if it is
// empty.
double enclosedVolume(const TriangleMesh& mesh);

}  // namespace voroform::mesh
