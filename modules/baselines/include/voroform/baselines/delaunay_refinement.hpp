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
  // Seconds of wall-clock time; 0: no limit.
  double timeLimit = 0;
  // Places the grid on which the first points are found, and seeds CGAL's random numbers.
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
  std::string message;  // why there is no result; empty if done
  double secondsRefinement = 0;
  double secondsOptimization = 0;
  double seconds = 0;
  // Most memory resident at a time in the child process, with what the calling process held when it started: f too.
  std::uint64_t peakMemoryBytes = 0;
};

struct DelaunayResult {
  mesh::PolyhedralComplex complex;  // tetrahedra; empty unless done. It need not be manifold: validate() says so
  DelaunaySummary summary;
};

// Throws UsageError on bad options, Cancelled, and EnvironmentError if the system grants no child process; failing and
// running out of time are results.
//
// CGAL can run for ever and cannot be interrupted, so all its work is done in a forked child process, on one thread: it
// can be cancelled, its crash is a result, its memory is counted. The child calls f, which may therefore not wait for a
// lock that another thread of the calling process can hold, nor count on other threads. The same options give the same
// bits in every run.
DelaunayResult delaunayRefinement(const implicit::ImplicitFunction& f, const Frame& frame,
                                  const DelaunayOptions& options, const RunContext& context);

}  // namespace voroform::baselines
