// Regular samples of a triangle mesh: the sites of a centroidal Voronoi tessellation restricted to it (thesis 5.3.3;
// restricted cells by clipping triangles: Yan et al. 2009).
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

struct SurfaceCvtOptions {
  // Wanted distance between neighbors, in the mesh's units, > 0: as many samples as a hexagonal lattice with this
  // distance has on the mesh's area, at least 1. The mean distance to the nearest sample, about 0.86 of it after 5
  // iterations, approaches it from below.
  double spacing = 0;
  // Lloyd iterations on the surface, over-relaxed but for the last; at least 0, which leaves random samples, uniform by
  // area.
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

// Samples lie inside triangles; only on saddles and in folds some (measured: 0.6 % at most) lie on edges.
// Sheets nearer to each other than the spacing are sampled each for itself, if they face apart. Deterministic for any
// number of threads. A mesh without area gives no samples. The mesh needs no property but finite coordinates; triangles
// without area get no samples. Throws UsageError for options out of range, coordinates that are not finite, and a
// spacing that asks for more than 10⁸ samples.
MeshSamples surfaceCvt(const mesh::TriangleMesh& mesh, const SurfaceCvtOptions& options, const RunContext& context);

}  // namespace voroform::metrics
