#include <cmath>
#include <string>

#include "measuring.hpp"
#include "voroform/core/error.hpp"

namespace voroform::pipeline {

double cellSize(double volume, Index cells) { return std::cbrt(volume / static_cast<double>(cells)); }

metrics::SurfaceSamples surfaceSamples(const Form& form, double cellSize, std::uint64_t seed,
                                       const RunContext& context) {
  // Samples this many to a cell's size (thesis 5.3.3: finer than the facets that are measured).
  constexpr double kSamplesPerCell = 3;
  context.report("samples on the surface", 0);
  metrics::ParticleOptions options;
  options.spacing = cellSize / kSamplesPerCell;
  options.seed = seed;
  metrics::SurfaceSamples samples = metrics::particleSamples(*form.function, options, context);
  context.report("samples on the surface", 1);
  return samples;
}

std::optional<metrics::Accuracy> measureAccuracy(const mesh::PolyhedralComplex& complex, const Form& form,
                                                 const Measurement& measurement, std::uint64_t seed,
                                                 const RunContext& context) {
  const double volume = measurement.fidelity.sampledVolume;
  try {
    if (complex.cellCount == 0 || !(volume > 0)) throw MethodError("there is no cell, or no volume");
    metrics::AccuracyOptions options;
    options.cellSize = cellSize(volume, complex.cellCount);
    options.seed = seed;
    const metrics::SurfaceSamples samples = surfaceSamples(form, options.cellSize, seed, context);
    context.report("accuracy", 0);
    std::optional<metrics::Accuracy> result = metrics::accuracy(complex, *form.function, samples, options, context);
    context.report("accuracy", 1);
    return result;
  } catch (const MethodError& error) {
    context.warn(std::string("the accuracy could not be measured: ") + error.what());
    return std::nullopt;
  }
}

}  // namespace voroform::pipeline
