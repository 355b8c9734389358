// Delaunay refinement of the solid (CGAL Mesh_3, Jamin et al. 2015) as a volumetric tessellation (thesis 5.3.1.1).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::baselines {

struct DelaunayOptions {
  // Edge of the cubes of Marching Cubes at equal resolution, in the form's units, > 0: facet size and cell size are
  // √3/2 of it, the circumradius of such a cube.
  double cubeEdge = 0;
  double facetAngle = 30;      // degrees, in [0, 30]: above, CGAL does not guarantee to end
  double radiusEdgeRatio = 2;  // at least 2 for the same reason
  double facetDistance = 0;    // in the form's units; 0: no such criterion
  // Optimizations after refinement, in this order; 0 and false: none.
  int lloydIterations = 10;
  int odtIterations = 0;
  bool perturb = false;
  bool exude = false;
  // Seconds of wall-clock time; 0: no limit. With a limit the work is done in a child process, for CGAL cannot be
  // interrupted.
  double timeLimit = 0;
  // CGAL's parallel version: faster, but another mesh from run to run.
  bool parallel = false;
  std::uint64_t seed = 0;
};
std::vector<std::string> validate(const DelaunayOptions& options);

enum class DelaunayStatus {
  done,
  timedOut,  // "did not finish in N s"
  failed,    // CGAL threw or crashed, or there is no tetrahedron; the summary's message says which
};

struct DelaunaySummary {
  DelaunayStatus status = DelaunayStatus::done;
  std::string message;           // why there is no result; empty if done
  double secondsRefinement = 0;
  double secondsOptimization = 0;
  double seconds = 0;
  std::uint64_t peakMemoryBytes = 0;  // of the child process; 0 without one
};

struct DelaunayResult {
  mesh::PolyhedralComplex complex;  // tetrahedra; empty unless done. It need not be manifold: validate() says so
  DelaunaySummary summary;
};

// Throws UsageError on bad options and Cancelled; failing and running out of time are results.
DelaunayResult delaunayRefinement(const implicit::ImplicitFunction& f, const Frame& frame,
                                  const DelaunayOptions& options, const RunContext& context);

}  // namespace voroform::baselines
