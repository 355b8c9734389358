#include "voroform/cvt/tessellate.hpp"

#include <algorithm>
#include <string>

#include "voroform/core/error.hpp"
#include "voroform/core/memory.hpp"
#include "voroform/cvt/energy.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::cvt {

namespace {

// Measured peaks of whole runs with cvt3 caps, certificate and writers included: 2.0 kB a site at a million sites of
// the torus, up to 2.8 kB at 100,000 sites of thin scans.
constexpr std::uint64_t kBytesPerSite = 3000;

void throwIfInvalid(const TessellateOptions& options) {
  if (const auto violations = validate(options); !violations.empty()) throw UsageError(violations.front());
}

}  // namespace

std::uint64_t estimatedMemory(Index sites) { return kBytesPerSite * static_cast<std::uint64_t>(std::max(sites, 0)); }

void requireMemory(const TessellateOptions& options) {
  const std::uint64_t limit = options.memoryLimit != 0 ? options.memoryLimit : usableMemory();
  const std::uint64_t needed = estimatedMemory(options.sites);
  if (needed <= limit) return;
  throw EnvironmentError(std::to_string(options.sites) + " sites need about " + std::to_string(needed >> 20U) +
                         " MiB of memory, " + std::to_string(limit >> 20U) + " MiB are there: use fewer sites");
}

OptimizedSites<3> optimizeSites(const implicit::ImplicitFunction& f, const TessellateOptions& options,
                                const RunContext& context) {
  throwIfInvalid(options);
  requireMemory(options);
  return optimizeSites<3>(ImplicitDomain(f, options.rootFinder, options.seed), options.given, options, context);
}

TessellateResult tessellateSites(const OptimizedSites<3>& optimized, const implicit::ImplicitFunction& f,
                                 const Frame& frame, const TessellateOptions& options, const RunContext& context) {
  throwIfInvalid(options);
  const Stopwatch watch;
  TessellateResult result;
  static_cast<SiteSummary&>(result.summary) = optimized.summary;
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
