#include "subdivision.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>

#include "site_candidates.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/initial_sites.hpp"

namespace voroform::cvt {

namespace {

// Random points tried in a cell.
constexpr std::uint64_t kTries = 256;
// Half the edge of the cube around a site that they come from, in units of the distance to its farthest neighbor: the
// corners of a lattice's cells lie at 0.56 of it (M = 3) and 0.58 (M = 2), those of boundary cells a little farther.
constexpr double kReach = 0.75;

// Compressed rows from each site to its neighbors.
struct Neighbors {
  std::vector<std::size_t> offsets;
  std::vector<Index> rows;

  Neighbors(const SiteGraph& graph, std::size_t siteCount) : offsets(siteCount, 0), rows(2 * graph.edges.size()) {
    for (const auto& [a, b] : graph.edges) {
      ++offsets[static_cast<std::size_t>(a)];
      ++offsets[static_cast<std::size_t>(b)];
    }
    exclusiveScan(offsets);
    std::vector<std::size_t> next = offsets;
    for (const auto& [a, b] : graph.edges) {
      rows[next[static_cast<std::size_t>(a)]++] = b;
      rows[next[static_cast<std::size_t>(b)]++] = a;
    }
  }
  std::span<const Index> of(Index site) const {
    const auto i = static_cast<std::size_t>(site);
    return {rows.data() + offsets[i], offsets[i + 1] - offsets[i]};
  }
};

std::vector<Index> allSites(std::size_t count) {
  std::vector<Index> result(count);
  std::iota(result.begin(), result.end(), 0);
  return result;
}

template <int M>
std::vector<Index> byMass(const Domain<M>& domain, const std::vector<Vec<M>>& sites, const RunContext& context) {
  const auto moments = domain.evaluate(sites, context).moments;
  std::vector<Index> order = allSites(sites.size());
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return moments[static_cast<std::size_t>(a)].mass < moments[static_cast<std::size_t>(b)].mass;
  });
  return order;
}

std::vector<Index> boundaryFirst(const SiteGraph& graph, std::uint64_t seed) {
  std::vector<Index> order = allSites(graph.onBoundary.size());
  const auto key = [&](Index i) {
    return randomBits(seed, RandomStream::insertionOrder, static_cast<std::uint64_t>(i));
  };
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    const auto boundaryA = graph.onBoundary[static_cast<std::size_t>(a)];
    const auto boundaryB = graph.onBoundary[static_cast<std::size_t>(b)];
    return boundaryA != boundaryB ? boundaryA > boundaryB : key(a) < key(b);
  });
  return order;
}

// A point in the cell of a site: the first random one, or the one farthest from the site.
template <int M>
std::optional<Vec<M>> pointInCell(const Domain<M>& domain, const std::vector<Vec<M>>& sites, Index host,
                                  std::span<const Index> neighbors, bool farthest, std::uint64_t seed) {
  const Vec<M>& site = sites[static_cast<std::size_t>(host)];
  double reach = 0;
  for (const Index j : neighbors) reach = std::max(reach, (sites[static_cast<std::size_t>(j)] - site).norm());
  reach = neighbors.empty() ? domain.bounds().diagonal().norm() : kReach * reach;
  const Box<M> box(site - Vec<M>::Constant(reach), site + Vec<M>::Constant(reach));
  std::optional<Vec<M>> best;
  double bestDistance = 0;
  for (std::uint64_t t = 0; t < kTries; ++t) {
    const std::uint64_t key = static_cast<std::uint64_t>(host) * kTries + t;
    const Vec<M> p = randomInBox(seed, RandomStream::insertion, key, box);
    const double distance = (p - site).squaredNorm();
    if (distance <= bestDistance) continue;
    const bool inCell = std::none_of(neighbors.begin(), neighbors.end(), [&](Index j) {
      return (p - sites[static_cast<std::size_t>(j)]).squaredNorm() < distance;
    });
    if (!inCell || !domain.contains(p)) continue;
    best = p;
    bestDistance = distance;
    if (!farthest) break;
  }
  return best;
}

// One round, with a seed of its own: at most one site a cell. Returns how many were added.
template <int M>
Index insertOnce(const Domain<M>& domain, std::vector<Vec<M>>& sites, Index count, Placement placement,
                 std::uint64_t seed, const RunContext& context) {
  const SiteGraph graph = domain.graph(sites, context);
  const Neighbors neighbors(graph, sites.size());
  const bool largest = placement == Placement::largestFirst;
  std::vector<Index> order = largest ? byMass(domain, sites, context) : boundaryFirst(graph, seed);
  if (largest) std::reverse(order.begin(), order.end());
  std::vector<std::uint8_t> blocked(sites.size(), 0);
  std::vector<Vec<M>> added;
  for (const Index host : order) {
    if (static_cast<Index>(added.size()) == count) break;
    if (blocked[static_cast<std::size_t>(host)] != 0) continue;
    const auto point = pointInCell(domain, sites, host, neighbors.of(host), largest, seed);
    if (!point) continue;
    added.push_back(*point);
    if (largest) {
      for (const Index j : neighbors.of(host)) blocked[static_cast<std::size_t>(j)] = 1;
    }
  }
  sites.insert(sites.end(), added.begin(), added.end());
  return static_cast<Index>(added.size());
}

}  // namespace

template <int M>
std::vector<Vec<M>> subdivide(const Domain<M>& domain, const std::vector<Vec<M>>& sites, const SiteGraph& graph,
                              const RunContext& context) {
  const auto pointAt = [&](std::size_t i) -> Vec<M> {
    if (i < sites.size()) return sites[i];
    const auto& [a, b] = graph.edges[i - sites.size()];
    return 0.5 * (sites[static_cast<std::size_t>(a)] + sites[static_cast<std::size_t>(b)]);
  };
  return pointsInside<M>(domain, sites.size() + graph.edges.size(), pointAt, context);
}

template <int M>
void insertSites(const Domain<M>& domain, std::vector<Vec<M>>& sites, Index count, Placement placement, int level,
                 std::uint64_t seed, const RunContext& context) {
  std::uint64_t round = 0;
  const auto nextSeed = [&] {
    return randomBits(seed, RandomStream::insertion, (static_cast<std::uint64_t>(level) << 32U) + round++);
  };
  while (count > 0 && !sites.empty()) {
    const Index added = insertOnce(domain, sites, count, placement, nextSeed(), context);
    if (added == 0) break;
    count -= added;
  }
  if (count == 0) return;
  const auto random = randomSites<M>(domain, count, nextSeed(), context);
  sites.insert(sites.end(), random.begin(), random.end());
}

template <int M>
void removeSites(const Domain<M>& domain, std::vector<Vec<M>>& sites, Index count, const RunContext& context) {
  while (count > 0) {
    const Neighbors neighbors(domain.graph(sites, context), sites.size());
    std::vector<std::uint8_t> blocked(sites.size(), 0);
    std::vector<std::uint8_t> removed(sites.size(), 0);
    for (const Index site : byMass(domain, sites, context)) {
      if (count == 0) break;
      if (blocked[static_cast<std::size_t>(site)] != 0) continue;
      removed[static_cast<std::size_t>(site)] = 1;
      for (const Index j : neighbors.of(site)) blocked[static_cast<std::size_t>(j)] = 1;
      --count;
    }
    std::vector<Vec<M>> kept;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (removed[i] == 0) kept.push_back(sites[i]);
    }
    sites = std::move(kept);
  }
}

template std::vector<Vec2> subdivide<2>(const Domain<2>&, const std::vector<Vec2>&, const SiteGraph&,
                                        const RunContext&);
template std::vector<Vec3> subdivide<3>(const Domain<3>&, const std::vector<Vec3>&, const SiteGraph&,
                                        const RunContext&);
template void insertSites<2>(const Domain<2>&, std::vector<Vec2>&, Index, Placement, int, std::uint64_t,
                             const RunContext&);
template void insertSites<3>(const Domain<3>&, std::vector<Vec3>&, Index, Placement, int, std::uint64_t,
                             const RunContext&);
template void removeSites<2>(const Domain<2>&, std::vector<Vec2>&, Index, const RunContext&);
template void removeSites<3>(const Domain<3>&, std::vector<Vec3>&, Index, const RunContext&);

}  // namespace voroform::cvt
