#include "voroform/pipeline/tessellation.hpp"

#include <cmath>
#include <cstdio>

#include "measuring.hpp"
#include "voroform/core/error.hpp"
#include "warnings.hpp"

namespace voroform::pipeline {

namespace {

// Above these, what was lost is worth a warning.
constexpr double kVolumeErrorWarning = 0.02;
constexpr double kMissedShareWarning = 0.02;
constexpr double kFallbackShareWarning = 0.01;
constexpr double kMultiLoopShareWarning = 0.01;

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100 * share);
  return text;
}

double share(Index part, Index whole) { return whole > 0 ? static_cast<double>(part) / whole : 0; }

void warnOfLosses(const Measurement& measurement, const RunContext& context) {
  const metrics::Fidelity& fidelity = measurement.fidelity;
  if (fidelity.volumeError > kVolumeErrorWarning) {
    context.warn("the tessellation's volume differs from that of the form by " + percent(fidelity.volumeError) +
                 ": parts of the solid are thinner than the cell size; more sites help");
  }
  if (fidelity.missedShare > kMissedShareWarning) {
    context.warn(percent(fidelity.missedShare) +
                 " of the solid's inside is held by no cell: parts thinner than the cell size; more sites help");
  }
  if (!measurement.certificate.valid) warnOfProblems(measurement.certificate.problems, context);
}

}  // namespace

void warnOfClipping(const cvt::TessellateSummary& summary, const RunContext& context) {
  const voronoi::ClipSummary& clip = summary.clip;
  warnOfEmptySites(summary.emptySites, "solid", context);
  if (share(clip.multiLoopCells, clip.boundaryCells) > kMultiLoopShareWarning) {
    context.warn(std::to_string(clip.multiLoopCells) + " of " + std::to_string(clip.boundaryCells) +
                 " boundary cells are cut by the surface more than once: sheets or gaps thinner than the cell size; "
                 "more sites help");
  }
  if (share(clip.fallbackCaps, clip.loops) > kFallbackShareWarning) {
    context.warn(std::to_string(clip.fallbackCaps) + " of " + std::to_string(clip.loops) +
                 " caps were closed in a simpler way than asked for");
  }
}

const char* toString(ExtraFormat format) {
  switch (format) {
    case ExtraFormat::obj:
      return "obj";
    case ExtraFormat::off:
      return "off";
    case ExtraFormat::stl:
      return "stl";
    case ExtraFormat::adjacency:
      return "adjacency";
  }
  throw UsageError("unknown format");
}

namespace {

struct NamedMethod {
  const char* name;
  CvtMethod method;
};
constexpr NamedMethod kCvtMethods[] = {
    {"cvt1", {voronoi::CapKind::cvt1, false}},    {"cvt2", {voronoi::CapKind::cvt2, false}},
    {"cvt3", {voronoi::CapKind::cvt3, false}},    {"cvt4", {voronoi::CapKind::cvt3, true}},
    {"cvt1+fit", {voronoi::CapKind::cvt1, true}}, {"cvt2+fit", {voronoi::CapKind::cvt2, true}}};

}  // namespace

std::string toString(const CvtMethod& method) {
  for (const NamedMethod& known : kCvtMethods) {
    if (known.method.cap == method.cap && known.method.fit == method.fit) return known.name;
  }
  throw UsageError("flat caps are for the optimization only");
}

CvtMethod cvtMethod(const std::string& name) {
  for (const NamedMethod& known : kCvtMethods) {
    if (name == known.name) return known.method;
  }
  throw UsageError("unknown method " + name);
}

const char* toString(implicit::RootFinder finder) { return finder == implicit::RootFinder::itp ? "itp" : "bisection"; }

Measurement measure(const mesh::PolyhedralComplex& complex, const Form& form, const metrics::InsideSamples& samples,
                    std::uint64_t seed, const RunContext& context) {
  const Stopwatch watch;
  Measurement result;
  context.report("moments", 0);
  result.moments = mesh::cellMoments(complex, context);
  result.regularities = metrics::regularities(result.moments);
  result.regularity = metrics::regularity(complex, result.regularities);
  result.boundaryFlags.assign(static_cast<std::size_t>(complex.cellCount), 0.0);
  for (Index f = 0; f < complex.faceCount(); ++f) {
    if (complex.isBoundary(f)) {
      result.boundaryFlags[static_cast<std::size_t>(complex.faceCells[static_cast<std::size_t>(f)][0])] = 1.0;
    }
  }
  context.throwIfCancelled();

  context.report("certificate", 0);
  mesh::ValidateOptions validateOptions;
  validateOptions.seed = seed;
  result.certificate = mesh::validate(complex, validateOptions, context);
  context.throwIfCancelled();

  context.report("fidelity", 0);
  metrics::FidelityOptions fidelityOptions;
  fidelityOptions.points = form.cloud.positions;
  fidelityOptions.spacing = form.record.points ? form.record.points->spacing : 0;
  result.fidelity = metrics::fidelity(complex, samples, fidelityOptions, context);
  context.report("fidelity", 1);
  warnOfLosses(result, context);
  result.seconds = watch.seconds();
  return result;
}

metrics::InsideSamples insideSamples(const Form& form, std::uint64_t seed, const RunContext& context) {
  context.report("volume", 0);
  metrics::FidelityOptions options;
  options.seed = seed;
  metrics::InsideSamples samples = metrics::insideSamples(*form.function, options, context);
  context.report("volume", 1);
  return samples;
}

Measurement measure(const mesh::PolyhedralComplex& complex, const Form& form, std::uint64_t seed,
                    const RunContext& context) {
  const Stopwatch watch;
  const metrics::InsideSamples samples = insideSamples(form, seed, context);
  Measurement result = measure(complex, form, samples, seed, context);
  result.seconds = watch.seconds();
  return result;
}

Tessellation tessellate(const Form& form, const cvt::TessellateOptions& options, const RunContext& context,
                        bool withAccuracy) {
  Tessellation result;
  result.warnings = form.record.warnings;
  const RunContext recording = recordWarnings(context, result.warnings);
  Stopwatch watch;
  cvt::TessellateResult tessellated = cvt::tessellate(*form.function, form.record.frame, options, recording);
  result.complex = std::move(tessellated.complex);
  result.summary = std::move(tessellated.summary);
  result.seconds = watch.seconds();
  if (result.complex.cellCount == 0) {
    throw MethodError("the surface cuts no edge between the cells of the " + std::to_string(result.summary.sites) +
                      " sites, so that no cell is left: use more sites");
  }
  warnOfClipping(result.summary, recording);
  watch.restart();
  result.measurement = measure(result.complex, form, options.seed, recording);
  if (withAccuracy) {
    result.accuracy = measureAccuracy(result.complex, form, result.measurement, options.seed, recording);
  }
  result.secondsMetrics = watch.seconds();
  return result;
}

}  // namespace voroform::pipeline
