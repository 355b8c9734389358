// Initial sites: every kind that thesis sections 2.4.2 and 4.1.4 name, in the plane and in space.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/domain.hpp"

namespace voroform::cvt {

// All of them give distinct points inside the domain, in spatial order, the same bits for any number of threads, and
// throw MethodError if the domain's bounds hold too little of it, Cancelled.

// `count` points uniform in the domain.
template <int M>
std::vector<Vec<M>> randomSites(const Domain<M>& domain, Index count, std::uint64_t seed, const RunContext& context);

// Of a Hammersley sequence in the domain's bounding box, the points inside; its length is searched so that exactly
// `count` lie there (Quinn et al. 2012). The seed shifts the sequence (modulo the box). If no length does, the search
// goes on with other shifts; throws MethodError when those are used up.
template <int M>
std::vector<Vec<M>> hammersleySites(const Domain<M>& domain, Index count, std::uint64_t seed,
                                    const RunContext& context);

// Points of the hexagonal (M = 2) or body-centered cubic (M = 3) lattice inside the domain; density, offset and
// orientation are searched so that exactly `count` lie inside. Where the search ends without, it returns the nearest
// count that it found: the caller sees it by the size. Sites stay off the boundary where the lattice allows it.
template <int M>
std::vector<Vec<M>> latticeSites(const Domain<M>& domain, Index count, std::uint64_t seed, const RunContext& context);

// Farthest-point sampling: each next site is the one of a dense set of random candidates that is farthest from all
// sites so far (Moriguchi and Sugihara 2006).
template <int M>
std::vector<Vec<M>> farthestPointSites(const Domain<M>& domain, Index count, std::uint64_t seed,
                                       const RunContext& context);

// Greedy edge-collapsing: a dense set of samples joined by their Delaunay edges within the domain; the edge whose
// collapse costs least is collapsed until `count` vertices are left (Moriguchi and Sugihara 2006; Ward's cost).
template <int M>
std::vector<Vec<M>> greedyEdgeCollapseSites(const Domain<M>& domain, Index count, std::uint64_t seed,
                                            const RunContext& context);

}  // namespace voroform::cvt
