#include "voroform/cvt/tessellate.hpp"

#include <algorithm>
#include <string>

#include "optimize.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/memory.hpp"
#include "voroform/cvt/energy.hpp"
#include "voroform/cvt/sites.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::cvt {

namespace {

// Measured peaks of whole runs with cvt3 caps, certificate and writers included: 2.0 kB a site at a million sites of
// the torus, up to 2.8 kB at 100,000 sites of thin scans.
constexpr std::uint64_t kBytesPerSite = 3000;
constexpr Index kMostSites = 50'000'000;

void throwIfInvalid(const TessellateOptions& options) {
  if (const auto violations = validate(options); !violations.empty()) throw UsageError(violations.front());
}

}  // namespace

const char* toString(StopReason reason) {
  switch (reason) {
    case StopReason::iterations:
      return "iterations";
    case StopReason::converged:
      return "converged";
    case StopReason::relativeError:
      return "relative-error";
    case StopReason::stalled:
      return "stalled";
  }
  return "";
}

std::vector<std::string> validate(const TessellateOptions& options) {
  std::vector<std::string> violations;
  const auto require = [&](bool holds, const std::string& sentence) {
    if (!holds) violations.push_back(sentence);
  };
  require(options.sites >= 1 && options.sites <= kMostSites,
          "sites is " + std::to_string(options.sites) + ", but must be from 1 to " + std::to_string(kMostSites));
  require(options.iterations >= 0, "iterations is " + std::to_string(options.iterations) + ", but must be at least 0");
  require(options.convergence >= 0,
          "convergence is " + std::to_string(options.convergence) + ", but must be at least 0");
  require(options.relativeError >= 0,
          "relative-error is " + std::to_string(options.relativeError) + ", but must be at least 0");
  require(options.reseedRounds >= 0,
          "reseedRounds is " + std::to_string(options.reseedRounds) + ", but must be at least 0");
  return violations;
}

std::uint64_t estimatedMemory(Index sites) { return kBytesPerSite * static_cast<std::uint64_t>(std::max(sites, 0)); }

void requireMemory(const TessellateOptions& options) {
  const std::uint64_t limit = options.memoryLimit != 0 ? options.memoryLimit : usableMemory();
  const std::uint64_t needed = estimatedMemory(options.sites);
  if (needed <= limit) return;
  throw EnvironmentError(std::to_string(options.sites) + " sites need about " + std::to_string(needed >> 20U) +
                         " MiB of memory, " + std::to_string(limit >> 20U) + " MiB are there: use fewer sites");
}

OptimizedSites optimizeSites(const implicit::ImplicitFunction& f, const TessellateOptions& options,
                             const RunContext& context) {
  throwIfInvalid(options);
  requireMemory(options);
  OptimizedSites result;
  Stopwatch watch;
  result.sites = randomSites(f, options.sites, options.seed, context);
  result.summary.secondsInitial = watch.seconds();

  watch.restart();
  minimizeEnergy(result.sites, f, options, result.summary, context);
  result.summary.secondsOptimization = watch.seconds();
  return result;
}

TessellateResult tessellateSites(const OptimizedSites& optimized, const implicit::ImplicitFunction& f,
                                 const Frame& frame, const TessellateOptions& options, const RunContext& context) {
  throwIfInvalid(options);
  const Stopwatch watch;
  TessellateResult result;
  result.summary = optimized.summary;
  voronoi::ClipOptions clipOptions;
  clipOptions.cap = options.cap;
  clipOptions.fit = options.fit;
  clipOptions.rootFinder = options.rootFinder;
  const voronoi::Diagram diagram = voronoi::buildDiagram(optimized.sites, siteDomain(f), context);
  voronoi::ClippedDiagram clipped = voronoi::clip(diagram, f, clipOptions, context);
  result.complex = voronoi::toComplex(diagram, clipped, f, frame, clipOptions, context);
  result.summary.clip = clipped.summary;
  result.summary.emptySites = static_cast<Index>(optimized.sites.size()) - result.complex.cellCount;
  result.summary.secondsClipping = watch.seconds();
  context.report("clip", 1);
  return result;
}

TessellateResult tessellate(const implicit::ImplicitFunction& f, const Frame& frame, const TessellateOptions& options,
                            const RunContext& context) {
  return tessellateSites(optimizeSites(f, options, context), f, frame, options, context);
}

}  // namespace voroform::cvt
