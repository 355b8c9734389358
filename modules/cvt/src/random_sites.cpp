#include "voroform/cvt/initial_sites.hpp"

#include <algorithm>
#include <string>

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
template <int M>
std::vector<Vec<M>> insideCandidates(const Domain<M>& domain, const Box<M>& bounds, std::uint64_t seed,
                                     std::size_t first, std::size_t count, const RunContext& context) {
  std::vector<std::vector<Vec<M>>> chunks((count + kGrain - 1) / kGrain);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec<M> p = randomInBox(seed, RandomStream::sites, first + i, bounds);
      if (domain.contains(p)) chunks[begin / kGrain].push_back(p);
    }
  });
  std::vector<Vec<M>> inside;
  for (const auto& chunk : chunks) inside.insert(inside.end(), chunk.begin(), chunk.end());
  return inside;
}

// Neighbors in the list become neighbors in space.
template <int M>
std::vector<Vec<M>> inSpatialOrder(const std::vector<Vec<M>>& points) {
  std::vector<Vec3> lifted(points.size(), Vec3::Zero());
  for (std::size_t i = 0; i < points.size(); ++i) lifted[i].template head<M>() = points[i];
  std::vector<Vec<M>> sorted;
  sorted.reserve(points.size());
  for (const Index i : voronoi::spatialOrder(lifted)) sorted.push_back(points[static_cast<std::size_t>(i)]);
  return sorted;
}

}  // namespace

template <int M>
std::vector<Vec<M>> randomSites(const Domain<M>& domain, Index count, std::uint64_t seed, const RunContext& context) {
  const Box<M> bounds = domain.bounds();
  const auto wanted = static_cast<std::size_t>(count);
  const std::size_t most = kMostCandidates * (wanted + 100);
  std::vector<Vec<M>> sites;
  std::size_t tried = 0;
  while (sites.size() < wanted) {
    if (tried >= most) {
      throw MethodError("of " + std::to_string(tried) + " random points in the form's bounds only " +
                        std::to_string(sites.size()) + " lie inside, " + std::to_string(count) +
                        " sites are wanted: the solid is empty or too thin; check the form or its envelope");
    }
    const std::size_t round = std::max<std::size_t>(kGrain, kCandidatesPerRound * (wanted - sites.size()));
    const std::vector<Vec<M>> inside = insideCandidates(domain, bounds, seed, tried, round, context);
    tried += round;
    const std::size_t taken = std::min(inside.size(), wanted - sites.size());
    sites.insert(sites.end(), inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(taken));
  }
  return inSpatialOrder<M>(sites);
}

template std::vector<Vec2> randomSites<2>(const Domain<2>&, Index, std::uint64_t, const RunContext&);
template std::vector<Vec3> randomSites<3>(const Domain<3>&, Index, std::uint64_t, const RunContext&);

}  // namespace voroform::cvt
