// Initial sites and their optimization in one.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/domain.hpp"
#include "voroform/cvt/hierarchy.hpp"
#include "voroform/cvt/optimize.hpp"

namespace voroform::cvt {

// Where the sites come from; see initial_sites.hpp and hierarchy.hpp.
enum class Initialization {
  random,
  hammersley,
  lattice,
  farthestPoint,
  greedyEdgeCollapse,
  hierarchicalRandom,
  hierarchicalLattice,
  given,
};

struct SiteOptions : OptimizeOptions {
  // Number of sites, at least 1; of no meaning for given ones.
  Index sites = 1000;
  Initialization initialization = Initialization::random;
  // Of the hierarchical ones; see HierarchyOptions. Each coarser level gets 50 iterations; in the plane as many as the
  // finest, if they are more.
  int subdivisions = -1;
  SubdivisionRule subdivisionRule = SubdivisionRule::matched;
};
// Every violation of the options, as sentences naming field, value and rule; empty if there is none.
std::vector<std::string> validate(const SiteOptions& options);

struct SiteSummary : OptimizeSummary {
  Index sites = 0;                     // a lattice may have other than were asked for
  std::vector<HierarchyLevel> levels;  // of the hierarchical ones, the coarsest first, without the finest
  double secondsInitial = 0;           // coarser levels included
  double secondsOptimization = 0;
};

template <int M>
struct OptimizedSites {
  std::vector<Vec<M>> sites;
  SiteSummary summary;
};

// The same bits for any number of threads. `given` holds the initial sites for Initialization::given, else it is not
// looked at; given sites outside of the domain are an error. A lattice of exactly that number of sites need not exist:
// then their number differs, with a warning. Throws UsageError on bad options, MethodError if the domain has no inside
// that the sites could be placed in, Cancelled.
template <int M>
OptimizedSites<M> optimizeSites(const Domain<M>& domain, std::span<const Vec<M>> given, const SiteOptions& options,
                                const RunContext& context);

}  // namespace voroform::cvt
