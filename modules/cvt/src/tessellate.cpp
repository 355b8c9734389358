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
// Greedy edge-collapsing was measured to take 8.3 kB a site in space and 2.8 kB in the plane, 5.5 and 4 times as much
// as a whole run with random ones; the estimates for these have room to spare.
constexpr std::uint64_t kGreedyFactor = 4;
// Making a density on a grid of 256³ nodes, the finest there is.
constexpr std::uint64_t kDensityBytes = 320'000'000;
// A site without a cell lies in a part too thin for one; when it is dropped, a neighbor's cell reaches into that part.
// Then others may lose theirs: so many times at most.
constexpr int kDropRounds = 3;

MemoryCost costOf(const TessellateOptions& options) {
  return {kBytesPerSite, options.density.kind != DensityKind::constant ? kDensityBytes : 0};
}

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

Index siteCount(const SiteOptions& options, std::size_t given) {
  return options.initialization == Initialization::given ? static_cast<Index>(given) : options.sites;
}

std::uint64_t estimatedMemory(const SiteOptions& options, Index sites, const MemoryCost& cost) {
  const std::uint64_t factor = options.initialization == Initialization::greedyEdgeCollapse ? kGreedyFactor : 1;
  return factor * cost.perSite * static_cast<std::uint64_t>(std::max(sites, 0)) + cost.density;
}

void requireMemory(const SiteOptions& options, Index sites, const MemoryCost& cost, std::uint64_t limit) {
  if (limit == 0) limit = usableMemory();
  const std::uint64_t needed = estimatedMemory(options, sites, cost);
  if (needed <= limit) return;
  std::string advice = "use fewer sites";
  if (options.initialization == Initialization::greedyEdgeCollapse) advice += ", other initial ones";
  if (cost.density > 0) advice += ", no density";
  throw EnvironmentError(std::to_string(sites) + " sites need about " + std::to_string(needed >> 20U) +
                         " MiB of memory, " + std::to_string(limit >> 20U) + " MiB are there: " + advice);
}

std::uint64_t estimatedMemory(const TessellateOptions& options) {
  return estimatedMemory(options, siteCount(options, options.given.size()), costOf(options));
}

void requireMemory(const TessellateOptions& options) {
  requireMemory(options, siteCount(options, options.given.size()), costOf(options), options.memoryLimit);
}

OptimizedSites<3> optimizeSites(const implicit::ImplicitFunction& f, const TessellateOptions& options,
                                const RunContext& context) {
  throwIfInvalid(options);
  requireMemory(options);
  const Stopwatch watch;
  ImplicitDomain domain(f, options.rootFinder, options.seed);
  const double count = std::max(siteCount(options, options.given.size()), 1);
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
