// Initial sites: every kind that thesis sections 2.4.2 and 4.1.4 name, in the plane and in space.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/domain.hpp"

namespace voroform::cvt {

// All of them give distinct points inside the domain, in spatial order, the same bits for any number of threads. They
// throw MethodError if the domain's bounds hold too little of it, Cancelled.

// `count` points at random in the domain, as dense as siteDensity() says.
template <int M>
std::vector<Vec<M>> randomSites(const Domain<M>& domain, Index count, std::uint64_t seed, const RunContext& context);

// Of a Hammersley sequence in the domain's bounding box, the points inside, thinned to siteDensity(). The seed shifts
// the sequence modulo the box. Its length is searched so that exactly `count` points are left (Quinn et al. 2012); if
// the search meets none, the best one slides along the first axis until that is so. Some twenty to sixty countings of
// the sequence. Throws MethodError if it still fails, which only a domain with symmetries of the sequence's can cause.
template <int M>
std::vector<Vec<M>> hammersleySites(const Domain<M>& domain, Index count, std::uint64_t seed,
                                    const RunContext& context);

// Points of the hexagonal (M = 2) or body-centered cubic (M = 3) lattice inside the domain, even without regard to
// siteDensity(). Orientations and offsets are tried, first those along the axes of the bounds, then random ones of the
// seed; for each the spacing is searched that puts exactly `count` points inside. Of those found, the one whose cells
// fit the domain best is taken: that with the lowest energy once the sites move to their centroids. Where no placement
// has exactly `count` points inside, it returns the nearest count found: the caller sees it by the size.
template <int M>
std::vector<Vec<M>> latticeSites(const Domain<M>& domain, Index count, std::uint64_t seed, const RunContext& context);

// Farthest-point sampling: the first site is random; each next one is, of a dense set of random candidates inside, the
// one farthest from all sites so far (Moriguchi and Sugihara 2006). Even without regard to siteDensity(). 40 candidates
// a site, O(count·log count) time.
template <int M>
std::vector<Vec<M>> farthestPointSites(const Domain<M>& domain, Index count, std::uint64_t seed,
                                       const RunContext& context);

// Greedy edge-collapsing (Moriguchi and Sugihara 2006): eight Hammersley points inside for each site, joined by the
// Delaunay edges within the domain. The edge whose collapse costs least collapses to the weighted mean of its ends, or
// to the heavier one if the mean lies outside, until `count` vertices are left. The cost is Ward's,
// w_a·w_b/(w_a + w_b)·‖a − b‖², with the weights ρ of the samples: what the collapse adds to the samples' part of the
// energy. If the domain has more separate parts than `count`, the largest get a site each. Takes the memory of a
// diagram of 8·count sites.
template <int M>
std::vector<Vec<M>> greedyEdgeCollapseSites(const Domain<M>& domain, Index count, std::uint64_t seed,
                                            const RunContext& context);

}  // namespace voroform::cvt
