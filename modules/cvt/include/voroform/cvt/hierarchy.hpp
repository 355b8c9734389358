// The hierarchical CVT: a coarse one, subdivided and optimized again and again (thesis, chapter 4).
#pragma once

#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/domain.hpp"
#include "voroform/cvt/optimize.hpp"

namespace voroform::cvt {

// A subdivision adds the midpoints of all edges between neighbors. In a lattice without a boundary that multiplies the
// number of sites by a = 4 (M = 2) or 8 (M = 3) and gives the same lattice, half as wide. At a boundary there are fewer
// edges, and the outermost sites stay where they were: half a layer of the finer cells is missing there.
enum class SubdivisionRule {
  // The thesis's (section 4.1.2): b_s = n, b_i = ⌊b_{i+1}/a⌋, k_0 = ⌊b_1/a⌋. The sites that are missing, about 14 % of
  // 14,474 in space, go to random places in boundary cells, at most one a cell.
  insertion,
  // Ours: the coarser levels have so many sites that subdivision leaves none missing, and fill the domain grown by
  // (2^j − 1)/2 cells of the finest level, j subdivisions before it. So the outermost sites of every level lie as deep
  // as those of the finest should, and the finer lattice fits in.
  matched,
};
const char* toString(SubdivisionRule rule);

struct HierarchyOptions {
  // Subdivisions, at most mostSubdivisions<M>(sites) + 1; a negative number stands for defaultSubdivisions<M>().
  int subdivisions = -1;
  // The coarsest sites: of the lattice, else random.
  bool fromLattice = false;
  SubdivisionRule rule = SubdivisionRule::matched;
  // Most iterations on each coarser level, at least 1. In space 200 instead of 50 lower the mean G of the finest level
  // by less than 0.00003; the thesis goes on until ‖g‖/‖X‖ ≤ 1e-10.
  int coarseIterations = 50;
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
  std::vector<Vec<M>> sites;  // of the finest level, inside the domain, in spatial order, not optimized
  std::vector<HierarchyLevel> levels;
};

// ⌊log_a n⌋ − 1, at least 0: the most that the papers use.
template <int M>
int mostSubdivisions(Index sites);

// These, but with the rule `matched` in space no more than leave the coarsest level some 500 sites, and from a lattice
// no more than one, as subdivision but blurs it; and one if that is possible at all.
template <int M>
int defaultSubdivisions(Index sites, SubdivisionRule rule, bool fromLattice);

// Initial sites for the finest level: `count` of them. The coarser levels are optimized by the given options, but for
// `iterations` and `relativeError`, until they converge; by L-BFGS where the options ask for Monte-Carlo.
//
// Midpoints outside of the domain are left out. Sites that are still missing go into further cells, at most one a cell
// and round, and where no cell takes one, to random places in the domain. Where subdivision gives too many, those with
// the smallest cells are removed. The same bits for any number of threads. Throws UsageError on bad options,
// MethodError, Cancelled.
template <int M>
Hierarchy<M> hierarchicalSites(const Domain<M>& domain, Index count, const HierarchyOptions& options,
                               const OptimizeOptions& optimization, const RunContext& context);

}  // namespace voroform::cvt
