// A subdivision of sites, and how their number is brought to the one wanted.
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/cvt/domain.hpp"

namespace voroform::cvt {

// The sites and then the midpoints of the graph's edges: those inside the domain.
template <int M>
std::vector<Vec<M>> subdivide(const Domain<M>& domain, const std::vector<Vec<M>>& sites, const SiteGraph& graph,
                              const RunContext& context);

// Which cells take a site first, and where.
enum class Placement {
  boundaryAtRandom,  // boundary cells in a random order, then the others; uniform in the cell (thesis, section 4.1.2)
  largestFirst,      // largest cells first, neighbors of one that took a site left out; far from the cell's site
};

// Appends `count` sites, at most one a cell and round. Where no cell takes one they are random in the domain. Each
// level has random numbers of its own.
template <int M>
void insertSites(const Domain<M>& domain, std::vector<Vec<M>>& sites, Index count, Placement placement, int level,
                 std::uint64_t seed, const RunContext& context);

// Removes `count` < n sites with the smallest cells, no two neighbors in a round. Keeps the others' order.
template <int M>
void removeSites(const Domain<M>& domain, std::vector<Vec<M>>& sites, Index count, const RunContext& context);

}  // namespace voroform::cvt
