#include "voroform/cvt/optimized_sites.hpp"

#include <algorithm>

#include "voroform/core/error.hpp"
#include "voroform/cvt/initial_sites.hpp"

namespace voroform::cvt {

namespace {

constexpr Index kMostSites = 50'000'000;

template <int M>
std::vector<Vec<M>> checkedSites(const Domain<M>& domain, std::span<const Vec<M>> given) {
  if (given.empty()) throw MethodError("no site is given");
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (!given[i].allFinite() || !domain.contains(given[i])) {
      throw MethodError("given site " + std::to_string(i) + " (counted from 0) lies outside the domain");
    }
  }
  return {given.begin(), given.end()};
}

template <int M>
std::vector<Vec<M>> initialSites(const Domain<M>& domain, std::span<const Vec<M>> given, const SiteOptions& options,
                                 const RunContext& context, std::vector<HierarchyLevel>& levels) {
  const auto hierarchical = [&](bool fromLattice) {
    HierarchyOptions hierarchy;
    hierarchy.subdivisions = options.subdivisions;
    hierarchy.fromLattice = fromLattice;
    hierarchy.rule = options.subdivisionRule;
    if (M == 2) hierarchy.coarseIterations = std::max(hierarchy.coarseIterations, options.iterations);
    Hierarchy<M> result = hierarchicalSites(domain, options.sites, hierarchy, options, context);
    levels = std::move(result.levels);
    return std::move(result.sites);
  };
  switch (options.initialization) {
    case Initialization::random:
      return randomSites(domain, options.sites, options.seed, context);
    case Initialization::hammersley:
      return hammersleySites(domain, options.sites, options.seed, context);
    case Initialization::lattice:
      return latticeSites(domain, options.sites, options.seed, context);
    case Initialization::farthestPoint:
      return farthestPointSites(domain, options.sites, options.seed, context);
    case Initialization::greedyEdgeCollapse:
      return greedyEdgeCollapseSites(domain, options.sites, options.seed, context);
    case Initialization::hierarchicalRandom:
      return hierarchical(false);
    case Initialization::hierarchicalLattice:
      return hierarchical(true);
    case Initialization::given:
      return checkedSites(domain, given);
  }
  throw UsageError("unknown initialization");
}

}  // namespace

std::vector<std::string> validate(const SiteOptions& options) {
  std::vector<std::string> violations;
  if (options.sites < 1 || options.sites > kMostSites) {
    violations.push_back("sites is " + std::to_string(options.sites) + ", but must be from 1 to " +
                         std::to_string(kMostSites));
  }
  const std::vector<std::string> others = validate(static_cast<const OptimizeOptions&>(options));
  violations.insert(violations.end(), others.begin(), others.end());
  return violations;
}

template <int M>
OptimizedSites<M> optimizeSites(const Domain<M>& domain, std::span<const Vec<M>> given, const SiteOptions& options,
                                const RunContext& context) {
  if (const auto violations = validate(options); !violations.empty()) throw UsageError(violations.front());
  OptimizedSites<M> result;
  Stopwatch watch;
  result.sites = initialSites(domain, given, options, context, result.summary.levels);
  result.summary.secondsInitial = watch.seconds();
  if (options.initialization != Initialization::given && static_cast<Index>(result.sites.size()) != options.sites) {
    context.warn("no lattice has " + std::to_string(options.sites) + " sites inside; the nearest that was found has " +
                 std::to_string(result.sites.size()));
  }
  watch.restart();
  static_cast<OptimizeSummary&>(result.summary) = optimize(domain, result.sites, options, context);
  result.summary.sites = static_cast<Index>(result.sites.size());
  result.summary.secondsOptimization = watch.seconds();
  return result;
}

template OptimizedSites<2> optimizeSites<2>(const Domain<2>&, std::span<const Vec2>, const SiteOptions&,
                                            const RunContext&);
template OptimizedSites<3> optimizeSites<3>(const Domain<3>&, std::span<const Vec3>, const SiteOptions&,
                                            const RunContext&);

}  // namespace voroform::cvt
