// The dual tetrahedralization of a clipped CVT, with the sites of boundary cells on S (thesis 5.3.4; Yan et al. 2013).
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

struct DualOptions {
  // Iterations of the optimization after the sites of boundary cells were projected.
  int iterations = 10;
  std::uint64_t seed = 0;
};

struct DualSummary {
  Index surfaceSites = 0;     // sites on S
  Index removedTetrahedra = 0;  // taken off so that the boundary is manifold
  double volumeError = 0;     // |volume − volume of the CVT| / volume of the CVT
  double seconds = 0;
};

struct DualResult {
  mesh::PolyhedralComplex complex;  // tetrahedra with a manifold boundary
  DualSummary summary;
};

// `cvt` is a clipped CVT as cvt::tessellate gives it (with cellSites). Deterministic for any number of threads.
DualResult dualTetrahedra(const mesh::PolyhedralComplex& cvt, const implicit::ImplicitFunction& f,
                          const DualOptions& options, const RunContext& context);

}  // namespace voroform::metrics
