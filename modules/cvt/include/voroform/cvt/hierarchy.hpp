// The hierarchical CVT: a coarse one, subdivided and optimized again and again (thesis, chapter 4).
#pragma once

#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/domain.hpp"
#include "voroform/cvt/optimize.hpp"

namespace voroform::cvt {

struct HierarchyOptions {
  // Subdivisions; a negative number stands for the most, mostSubdivisions<M>(sites).
  int subdivisions = -1;
  // The coarsest sites: of the lattice, else random.
  bool fromLattice = false;
};

// One level, the coarsest first; the finest has no record: it is what the caller goes on to optimize.
struct HierarchyLevel {
  Index sites = 0;       // of this level
  Index subdivided = 0;  // k: of the next level before sites are inserted
  Index inserted = 0;    // b − k: sites inserted into the next level's cells (negative: removed)
  OptimizeSummary optimization;
  double seconds = 0;
};

template <int M>
struct Hierarchy {
  std::vector<Vec<M>> sites;  // of the finest level, not optimized
  std::vector<HierarchyLevel> levels;
};

// ⌊log_a n⌋ − 1 with a = 4 (M = 2) or 8 (M = 3), at least 0: the most that the papers use.
template <int M>
int mostSubdivisions(Index sites);

// Initial sites for the finest level. The coarser levels are optimized by the given options, `iterations` apart: each
// until it converges, at most kCoarseIterations. The same bits for any number of threads. Throws UsageError,
// MethodError, Cancelled.
inline constexpr int kCoarseIterations = 200;
template <int M>
Hierarchy<M> hierarchicalSites(const Domain<M>& domain, Index count, const HierarchyOptions& options,
                               const OptimizeOptions& optimization, const RunContext& context);

}  // namespace voroform::cvt
