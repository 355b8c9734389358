// The dual tetrahedralization of a clipped CVT, with the sites of boundary cells on S (thesis 5.3.4; Yan et al. 2013).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

struct DualOptions {
  // Iterations of the optimization after the sites of boundary cells were projected, at least 0. Each costs about what
  // an evaluation of the CVT's energy does.
  int iterations = 20;
  // Nothing is random so far: the same for any seed.
  std::uint64_t seed = 0;
};
// Every violation of the options, as sentences naming field, value and rule; empty if there is none.
std::vector<std::string> validate(const DualOptions& options);

struct DualSummary {
  Index surfaceSites = 0;       // sites on S
  Index addedSurfaceSites = 0;  // of them, those whose cells reached S only later
  Index unprojectedSites = 0;   // sites that belong on S, but have no point of S within reach
  Index exposedSites = 0;       // vertices of the boundary that are not on S
  Index buriedSites = 0;        // sites on S that are vertices of the mesh but not of its boundary
  Index droppedSites = 0;       // sites without a tetrahedron
  Index removedTetrahedra = 0;  // taken off so that the boundary is manifold, and flat ones
  Index flatTetrahedra = 0;     // of them, flat ones with all four sites on S: each flips an edge of the boundary
  Index addedTetrahedra = 0;    // though their circumcenter is outside, so that the boundary is manifold
  double volumeError = 0;       // |volume − volume of the CVT| / volume of the CVT
  double seconds = 0;
};

struct DualResult {
  mesh::PolyhedralComplex complex;  // tetrahedra with a manifold boundary
  DualSummary summary;
};

// `cvt` is a clipped CVT as cvt::tessellate gives it (with cellSites). The sites of its boundary cells are projected on
// S; then those on S move towards a CVT of S, the others towards one of the volume; the mesh is the dual of the diagram
// inside the solid. Slivers inside are kept (see QualityStatistics). A site becomes a vertex near sharp edges only by
// chance, so the dual cuts them off. Deterministic for any number of threads. Throws UsageError if the complex has no
// sites, MethodError if no tetrahedron is left (too few sites for the solid).
DualResult dualTetrahedra(const mesh::PolyhedralComplex& cvt, const implicit::ImplicitFunction& f,
                          const DualOptions& options, const RunContext& context);

}  // namespace voroform::metrics
