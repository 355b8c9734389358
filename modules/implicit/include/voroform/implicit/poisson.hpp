// Poisson surface reconstruction: an implicit form from oriented points (Kazhdan et al. 2006, by way of CGAL).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/points/point_cloud.hpp"

namespace voroform::implicit {

// f linear in each tetrahedron of a triangulation: CGAL's triangulation and values copied into flat arrays, with an
// exact inside oracle (see implicit/tetrahedral_form.hpp).
class TetrahedralForm;

struct PoissonOptions {
  // Voxels of the clearance grid along the longest side of the form's bounds; in [16, 512]. Memory grows with its cube
  // (three bytes a voxel while building, one after).
  int gridResolution = 192;
};
// Every violation, in words; empty if there is none.
std::vector<std::string> validate(const PoissonOptions& options);

struct PoissonSummary {
  Index vertices = 0;  // of the refined triangulation
  Index tetrahedra = 0;
  bool signTurned = false;      // f was turned to be negative inside against the normals: all of them seem flipped
  double wrongNormalShare = 0;  // share of the points whose n·∇f has the wrong sign, once a turn of all is allowed for
  double seconds = 0;
};

struct PoissonResult {
  std::shared_ptr<const TetrahedralForm> form;
  PoissonSummary summary;
};

// Throws MethodError with advice if the solver fails, if f is negative nowhere (or everywhere) in `region`, or if more
// than a quarter of the normals contradict ∇f. Warns if signTurned or if some normals contradict. Deterministic.
PoissonResult fitPoisson(const points::PointCloud& cloud, const Box3& region, const PoissonOptions& options,
                         const RunContext& context);

}  // namespace voroform::implicit
