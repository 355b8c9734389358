// Measuring several tessellations of one form: what depends on the form alone is made once.
#pragma once

#include <cstdint>

#include "voroform/core/run_context.hpp"
#include "voroform/metrics/fidelity.hpp"
#include "voroform/metrics/particles.hpp"
#include "voroform/pipeline/form.hpp"
#include "voroform/pipeline/tessellation.hpp"

namespace voroform::pipeline {

// For measure(), and the volume of {f < 0}.
metrics::InsideSamples insideSamples(const Form& form, std::uint64_t seed, const RunContext& context);

// Samples of S a third of the cell size apart (thesis 5.3.3).
metrics::SurfaceSamples surfaceSamples(const Form& form, double cellSize, std::uint64_t seed,
                                       const RunContext& context);

// As the public measure(), with samples of the form that were made before.
Measurement measure(const mesh::PolyhedralComplex& complex, const Form& form, const metrics::InsideSamples& samples,
                    std::uint64_t seed, const RunContext& context);

// Warns of sites, caps and cells that were lost or made in a simpler way.
void warnOfClipping(const cvt::TessellateSummary& summary, const RunContext& context);

}  // namespace voroform::pipeline
