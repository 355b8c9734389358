#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

#include "site_candidates.hpp"
#include "voroform/cvt/initial_sites.hpp"

namespace voroform::cvt {

namespace {

// Candidates for each site, and for each cell of the grid that sorts them.
constexpr std::size_t kCandidatesPerSite = 40;
constexpr double kCandidatesPerCell = 6;

// Candidates with their squared distances to the nearest site so far, sorted into the cells of a grid.
template <int M>
class CandidateGrid {
 public:
  explicit CandidateGrid(const std::vector<Vec<M>>& candidates) {
    for (const Vec<M>& p : candidates) box_.extend(p);
    const double cells = std::max(1.0, static_cast<double>(candidates.size()) / kCandidatesPerCell);
    // The box may be flat: its volume is taken with sides that are at least a small part of the longest.
    const Vec<M> sizes = box_.sizes().cwiseMax(1e-6 * box_.sizes().maxCoeff());
    edge_ = std::pow(sizes.prod() / cells, 1.0 / M);
    if (!(edge_ > 0)) edge_ = 1;
    std::size_t cellCount = 1;
    for (Index axis = 0; axis < M; ++axis) {
      counts_[axis] = static_cast<Index>(box_.sizes()[axis] / edge_) + 1;
      cellCount *= static_cast<std::size_t>(counts_[axis]);
    }
    sortIntoCells(candidates, cellCount);
    farthest_.assign(cellCount, -1);
    squaredDistances_.assign(points_.size(), std::numeric_limits<double>::infinity());
  }

  // Takes account of a new site.
  void insert(const Vec<M>& site) {
    // No candidate is farther from the sites than the site was that was the farthest of all: none beyond that distance
    // comes closer.
    const Cell first = cellOf(site - Vec<M>::Constant(reach_));
    const Cell last = cellOf(site + Vec<M>::Constant(reach_));
    Cell cell = first;
    while (true) {
      update(cell, site);
      Index axis = 0;
      while (axis < M && cell[axis] == last[axis]) {
        cell[axis] = first[axis];
        ++axis;
      }
      if (axis == M) return;
      ++cell[axis];
    }
  }

  // The candidate farthest from all sites.
  Vec<M> farthest() {
    if (heap_.empty()) {
      for (std::size_t c = 0; c < farthest_.size(); ++c) heap_.push({farthest_[c], c});
    }
    // Distances only shrink: an entry is an upper bound, put right when it comes up.
    while (heap_.top().squaredDistance != farthest_[heap_.top().cell]) {
      const std::size_t stale = heap_.top().cell;
      heap_.pop();
      heap_.push({farthest_[stale], stale});
    }
    const Entry top = heap_.top();
    reach_ = std::sqrt(top.squaredDistance);
    const auto begin = squaredDistances_.begin() + static_cast<std::ptrdiff_t>(offsets_[top.cell]);
    const auto end = squaredDistances_.begin() + static_cast<std::ptrdiff_t>(offsets_[top.cell + 1]);
    return points_[static_cast<std::size_t>(std::find(begin, end, top.squaredDistance) - squaredDistances_.begin())];
  }

 private:
  using Cell = Eigen::Matrix<Index, M, 1>;
  struct Entry {
    double squaredDistance = 0;
    std::size_t cell = 0;
    bool operator<(const Entry& other) const {
      return squaredDistance != other.squaredDistance ? squaredDistance < other.squaredDistance : cell > other.cell;
    }
  };

  Cell cellOf(const Vec<M>& p) const {
    Cell cell;
    for (Index axis = 0; axis < M; ++axis) {
      const double position = std::floor((p[axis] - box_.min()[axis]) / edge_);
      cell[axis] = static_cast<Index>(std::clamp(position, 0.0, static_cast<double>(counts_[axis] - 1)));
    }
    return cell;
  }

  std::size_t indexOf(const Cell& cell) const {
    std::size_t index = 0;
    for (Index axis = M; axis-- > 0;) {
      index = index * static_cast<std::size_t>(counts_[axis]) + static_cast<std::size_t>(cell[axis]);
    }
    return index;
  }

  void sortIntoCells(const std::vector<Vec<M>>& candidates, std::size_t cellCount) {
    std::vector<std::size_t> cells(candidates.size());
    offsets_.assign(cellCount, 0);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      cells[i] = indexOf(cellOf(candidates[i]));
      ++offsets_[cells[i]];
    }
    exclusiveScan(offsets_);
    points_.resize(candidates.size());
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    for (std::size_t i = 0; i < candidates.size(); ++i) points_[next[cells[i]]++] = candidates[i];
  }

  void update(const Cell& cell, const Vec<M>& site) {
    const std::size_t c = indexOf(cell);
    const Vec<M> corner = box_.min() + edge_ * cell.template cast<double>();
    const Box<M> cellBox(corner, corner + Vec<M>::Constant(edge_));
    if (!heap_.empty() && cellBox.squaredExteriorDistance(site) >= farthest_[c]) return;
    double farthest = -1;
    for (std::size_t i = offsets_[c]; i < offsets_[c + 1]; ++i) {
      squaredDistances_[i] = std::min(squaredDistances_[i], (points_[i] - site).squaredNorm());
      farthest = std::max(farthest, squaredDistances_[i]);
    }
    farthest_[c] = farthest;
  }

  Box<M> box_;
  double edge_ = 1;
  Cell counts_ = Cell::Ones();
  std::vector<std::size_t> offsets_;  // of the cells, into the next two
  std::vector<Vec<M>> points_;
  std::vector<double> squaredDistances_;
  std::vector<double> farthest_;  // of each cell, the largest squared distance; −1 for an empty cell
  double reach_ = std::numeric_limits<double>::infinity();
  std::priority_queue<Entry> heap_;
};

}  // namespace

template <int M>
std::vector<Vec<M>> farthestPointSites(const Domain<M>& domain, Index count, std::uint64_t seed,
                                       const RunContext& context) {
  const auto wanted = static_cast<std::size_t>(count);
  const std::vector<Vec<M>> candidates = randomPointsInside(domain, kCandidatesPerSite * wanted, seed, context);
  std::vector<Vec<M>> sites;
  sites.reserve(wanted);
  CandidateGrid<M> grid(candidates);
  while (sites.size() < wanted) {
    if (sites.size() % 1024 == 0) context.throwIfCancelled();
    sites.push_back(sites.empty() ? candidates.front() : grid.farthest());
    grid.insert(sites.back());
  }
  return inSpatialOrder<M>(sites);
}

template std::vector<Vec2> farthestPointSites<2>(const Domain<2>&, Index, std::uint64_t, const RunContext&);
template std::vector<Vec3> farthestPointSites<3>(const Domain<3>&, Index, std::uint64_t, const RunContext&);

}  // namespace voroform::cvt
