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
  // Mean distance to the nearest other sample on the same sheet (a sample whose normal does not oppose: the other side
  // of a thin solid does not count), and these distances' coefficient of variation. The mean comes out within a few
  // per cent of the spacing that was asked for.
  double meanSpacing = 0;
  double variation = 0;
  int iterations = 0;
  double seconds = 0;
};

// The same bits for any number of threads. All components of S that are larger than the spacing are sampled. Throws
// MethodError if no point of S is found; UsageError if the spacing is not positive, or so small against the form's
// bounds that the samples could not be held.
SurfaceSamples particleSamples(const implicit::ImplicitFunction& f, const ParticleOptions& options,
                               const RunContext& context);

}  // namespace voroform::metrics
