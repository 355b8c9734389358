#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "site_candidates.hpp"
#include "voroform/cvt/initial_sites.hpp"

namespace voroform::cvt {

namespace {

constexpr std::size_t kSamplesPerSite = 8;
// With fewer samples than this, thin parts of the domain would hold none.
constexpr std::size_t kFewestSamples = 512;

// The samples' graph while its edges collapse. A vertex weighs what the samples it stands for weigh.
template <int M>
class CollapsingGraph {
 public:
  CollapsingGraph(const Domain<M>& domain, std::vector<Vec<M>> samples, const RunContext& context)
      : domain_(domain),
        positions_(std::move(samples)),
        versions_(positions_.size(), 0),
        neighbors_(positions_.size()),
        vertexCount_(positions_.size()) {
    // Sites lie as densely as ρ^(M/(M+2)), samples evenly.
    for (const Vec<M>& p : positions_) weights_.push_back(std::pow(domain.siteDensity(p), (M + 2.0) / M));
    for (const auto& [a, b] : domain.graph(positions_, context).edges) {
      neighbors_[static_cast<std::size_t>(a)].push_back(b);
      neighbors_[static_cast<std::size_t>(b)].push_back(a);
      push(a, b);
    }
  }

  std::size_t vertexCount() const { return vertexCount_; }

  // Collapses the edge that costs least; false if there is none.
  bool collapseCheapest() {
    while (!heap_.empty()) {
      const Edge edge = heap_.top();
      heap_.pop();
      if (version(edge.a) == edge.versionA && version(edge.b) == edge.versionB) {
        collapse(edge.a, edge.b);
        return true;
      }
    }
    return false;
  }

  // The `count` heaviest vertices that are left.
  std::vector<Vec<M>> heaviest(std::size_t count) const {
    std::vector<std::size_t> left;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      if (weights_[i] > 0) left.push_back(i);
    }
    std::stable_sort(left.begin(), left.end(), [&](std::size_t a, std::size_t b) { return weights_[a] > weights_[b]; });
    left.resize(std::min(left.size(), count));
    std::vector<Vec<M>> result;
    for (const std::size_t i : left) result.push_back(positions_[i]);
    return result;
  }

 private:
  struct Edge {
    double cost = 0;
    Index a = kNone;
    Index b = kNone;
    Index versionA = 0;
    Index versionB = 0;
    bool operator<(const Edge& other) const {
      if (cost != other.cost) return cost > other.cost;
      return a != other.a ? a > other.a : b > other.b;
    }
  };

  Index version(Index vertex) const { return versions_[static_cast<std::size_t>(vertex)]; }

  // By how much the samples' squared distances to their vertices' means grow when a and b become one (Ward 1963).
  double cost(Index a, Index b) const {
    const auto i = static_cast<std::size_t>(a);
    const auto j = static_cast<std::size_t>(b);
    return weights_[i] * weights_[j] / (weights_[i] + weights_[j]) * (positions_[i] - positions_[j]).squaredNorm();
  }

  void push(Index a, Index b) {
    if (a > b) std::swap(a, b);
    heap_.push({cost(a, b), a, b, version(a), version(b)});
  }

  // The heavier end stays, with the neighbors of both, and moves to their mean; in a domain that is not convex the mean
  // may lie outside: then it stays where it is.
  void collapse(Index a, Index b) {
    if (weights_[static_cast<std::size_t>(a)] < weights_[static_cast<std::size_t>(b)]) std::swap(a, b);
    const auto kept = static_cast<std::size_t>(a);
    const auto gone = static_cast<std::size_t>(b);
    const double weight = weights_[kept] + weights_[gone];
    const Vec<M> mean = positions_[kept] + weights_[gone] / weight * (positions_[gone] - positions_[kept]);
    if (domain_.contains(mean)) positions_[kept] = mean;
    weights_[kept] = weight;
    weights_[gone] = 0;
    --vertexCount_;
    ++versions_[kept];
    ++versions_[gone];
    joinNeighbors(a, b);
    for (const Index neighbor : neighbors_[kept]) push(a, neighbor);
  }

  void joinNeighbors(Index a, Index b) {
    std::vector<Index>& kept = neighbors_[static_cast<std::size_t>(a)];
    std::vector<Index>& gone = neighbors_[static_cast<std::size_t>(b)];
    std::erase(kept, b);
    for (const Index neighbor : gone) {
      if (neighbor == a) continue;
      std::vector<Index>& back = neighbors_[static_cast<std::size_t>(neighbor)];
      if (std::find(kept.begin(), kept.end(), neighbor) == kept.end()) {
        kept.push_back(neighbor);
        std::replace(back.begin(), back.end(), b, a);
      } else {
        std::erase(back, b);
      }
    }
    gone = {};
  }

  const Domain<M>& domain_;
  std::vector<Vec<M>> positions_;
  std::vector<double> weights_;  // by ρ; 0: collapsed into another vertex
  std::vector<Index> versions_;  // grows with each change: heap entries of another version are outdated
  std::vector<std::vector<Index>> neighbors_;
  std::size_t vertexCount_;
  std::priority_queue<Edge> heap_;
};

}  // namespace

template <int M>
std::vector<Vec<M>> greedyEdgeCollapseSites(const Domain<M>& domain, Index count, std::uint64_t seed,
                                            const RunContext& context) {
  const auto wanted = static_cast<std::size_t>(count);
  const std::size_t sampleCount = std::max(kFewestSamples, kSamplesPerSite * wanted);
  CollapsingGraph<M> graph(domain, inSpatialOrder<M>(hammersleyPointsInside(domain, sampleCount, seed, context)),
                           context);
  while (graph.vertexCount() > wanted) {
    if (graph.vertexCount() % 1024 == 0) context.throwIfCancelled();
    // Without edges each vertex is a part of the domain by itself; the largest parts get a site.
    if (!graph.collapseCheapest()) break;
  }
  return inSpatialOrder<M>(graph.heaviest(wanted));
}

template std::vector<Vec2> greedyEdgeCollapseSites<2>(const Domain<2>&, Index, std::uint64_t, const RunContext&);
template std::vector<Vec3> greedyEdgeCollapseSites<3>(const Domain<3>&, Index, std::uint64_t, const RunContext&);

}  // namespace voroform::cvt
