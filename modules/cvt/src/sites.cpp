#include "voroform/cvt/sites.hpp"

#include <algorithm>
#include <string>

#include "inside.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/core/random.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::cvt {

namespace {

constexpr std::size_t kGrain = 4096;
// Candidates a round, in units of the sites still missing; and the most candidates a site wanted.
constexpr std::size_t kCandidatesPerRound = 4;
constexpr std::size_t kMostCandidates = 20000;

// Candidate sites [first, first + count) that lie inside, in their order.
std::vector<Vec3> insideCandidates(const implicit::ImplicitFunction& f, const Box3& bounds, std::uint64_t seed,
                                   std::size_t first, std::size_t count, const RunContext& context) {
  std::vector<std::vector<Vec3>> chunks((count + kGrain - 1) / kGrain);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 p = randomInBox(seed, RandomStream::sites, first + i, bounds);
      if (isInside(f, p)) chunks[begin / kGrain].push_back(p);
    }
  });
  std::vector<Vec3> inside;
  for (const auto& chunk : chunks) inside.insert(inside.end(), chunk.begin(), chunk.end());
  return inside;
}

}  // namespace

std::vector<Vec3> randomSites(const implicit::ImplicitFunction& f, Index count, std::uint64_t seed,
                              const RunContext& context) {
  const Box3 bounds = f.bounds();
  const auto wanted = static_cast<std::size_t>(count);
  const std::size_t most = kMostCandidates * (wanted + 100);
  std::vector<Vec3> sites;
  std::size_t tried = 0;
  while (sites.size() < wanted) {
    if (tried >= most) {
      throw MethodError("of " + std::to_string(tried) + " random points in the form's bounds only " +
                        std::to_string(sites.size()) + " lie inside, " + std::to_string(count) +
                        " sites are wanted: the solid is empty or too thin; check the form or its envelope");
    }
    const std::size_t round = std::max<std::size_t>(kGrain, kCandidatesPerRound * (wanted - sites.size()));
    const std::vector<Vec3> inside = insideCandidates(f, bounds, seed, tried, round, context);
    tried += round;
    const std::size_t taken = std::min(inside.size(), wanted - sites.size());
    sites.insert(sites.end(), inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(taken));
  }
  const std::vector<Index> order = voronoi::spatialOrder(sites);
  std::vector<Vec3> sorted;
  sorted.reserve(sites.size());
  for (const Index i : order) sorted.push_back(sites[static_cast<std::size_t>(i)]);
  return sorted;
}

}  // namespace voroform::cvt
