// Regular samples of an implicit surface by a system of particles that repel each other on it (Witkin & Heckbert 1994;
// Meyer et al. 2007; Berger et al. 2013; thesis 5.3.3).
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::metrics {

struct ParticleOptions {
  // Wanted distance between neighbors, in the form's units, > 0.
  double spacing = 0;
  std::uint64_t seed = 0;
};

struct SurfaceSamples {
  std::vector<Vec3> points;   // on S, not on the envelope
  std::vector<Vec3> normals;  // unit, outward
  double meanSpacing = 0;     // mean distance to the nearest other sample
  double variation = 0;       // coefficient of variation of these distances
  int iterations = 0;
  double seconds = 0;
};

// Deterministic for any number of threads. All components of S that are larger than the spacing are sampled. Throws
// MethodError if S has none.
SurfaceSamples particleSamples(const implicit::ImplicitFunction& f, const ParticleOptions& options,
                               const RunContext& context);

}  // namespace voroform::metrics
