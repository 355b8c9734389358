// Regular samples of a triangle mesh: the sites of a centroidal Voronoi tessellation restricted to it (thesis 5.3.3;
// restricted cells by clipping triangles: Yan et al. 2009).
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

struct SurfaceCvtOptions {
  // Wanted distance between neighbors, in the mesh's units, > 0: the number of samples follows from the area.
  double spacing = 0;
  // Lloyd iterations on the surface.
  int iterations = 5;
  std::uint64_t seed = 0;
};

// Samples of the mesh with the triangle that each lies in.
struct MeshSamples {
  std::vector<Vec3> points;
  std::vector<Index> triangles;  // of the mesh that was given
  double meanSpacing = 0;        // mean distance to the nearest other sample
  double variation = 0;          // coefficient of variation of these distances
  double energyDrop = 0;         // share of the initial CVT energy that the iterations removed
  double seconds = 0;
};

// Deterministic for any number of threads. An empty mesh gives no samples. The mesh needs no property but finite
// coordinates.
MeshSamples surfaceCvt(const mesh::TriangleMesh& mesh, const SurfaceCvtOptions& options, const RunContext& context);

}  // namespace voroform::metrics
