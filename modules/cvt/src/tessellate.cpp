#include "voroform/cvt/tessellate.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "general_position.hpp"
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
// A site without a cell lies in a part too thin for one; when it is dropped, a neighbor's cell reaches into that part.
// Then others may lose theirs: so many times at most.
constexpr int kDropRounds = 3;

void throwIfInvalid(const TessellateOptions& options) {
  if (const auto violations = validate(options); !violations.empty()) throw UsageError(violations.front());
}

}  // namespace

std::vector<std::string> validate(const TessellateOptions& options) {
  std::vector<std::string> violations = validate(static_cast<const SiteOptions&>(options));
  const std::vector<std::string> others = validate(options.density);
  violations.insert(violations.end(), others.begin(), others.end());
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

OptimizedSites<3> optimizeSites(const implicit::ImplicitFunction& f, const TessellateOptions& options,
                                const RunContext& context) {
  throwIfInvalid(options);
  requireMemory(options);
  const Stopwatch watch;
  ImplicitDomain domain(f, options.rootFinder, options.seed);
  const auto count = static_cast<double>(
      options.initialization == Initialization::given ? std::max<std::size_t>(options.given.size(), 1) : options.sites);
  domain.setDensity(makeDensity(f, options.density, std::cbrt(domain.volume() / count), context));
  const double secondsDensity = watch.seconds();
  OptimizedSites<3> result = optimizeSites<3>(domain, options.given, options, context);
  result.summary.secondsInitial += secondsDensity;
  return result;
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
  std::vector<Vec3> sites = optimized.sites;
  const Box3 domain = siteDomain(f);
  voronoi::ClippedDiagram clipped;
  for (int round = 0; round < kDropRounds; ++round) {
    voronoi::Diagram diagram = voronoi::buildDiagram(sites, domain, context);
    result.summary.movedSites += moveToGeneralPosition(sites, diagram, domain, context);
    clipped = voronoi::clip(diagram, f, clipOptions, context);
    result.complex = voronoi::toComplex(diagram, clipped, f, frame, clipOptions, context);
    if (result.complex.cellCount == static_cast<Index>(sites.size()) || result.complex.cellCount == 0) break;
    sites = result.complex.cellSites;
  }
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
