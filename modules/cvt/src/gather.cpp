#include "gather.hpp"

#include <algorithm>
#include <cmath>

#include "voroform/core/parallel.hpp"
#include "voroform/core/regularity.hpp"

namespace voroform::cvt {

namespace {

constexpr std::size_t kGrain = 4096;
// A cell with less than this share of the mean mass is as good as empty: its centroid is lost in rounding, or it is
// what flat caps leave of a part thinner than they can follow.
constexpr double kEmptyShare = 1e-6;

struct Sums {
  double energy = 0;
  double volume = 0;
  double squaredMoves = 0;
  double squaredGradient = 0;
  double squaredSites = 0;
  double regularity = 0;
  Index empty = 0;
};

Sums operator+(const Sums& a, const Sums& b) {
  return {a.energy + b.energy,
          a.volume + b.volume,
          a.squaredMoves + b.squaredMoves,
          a.squaredGradient + b.squaredGradient,
          a.squaredSites + b.squaredSites,
          a.regularity + b.regularity,
          a.empty + b.empty};
}

// x^(1/M).
template <int M>
double root(double x) {
  return M == 2 ? std::sqrt(x) : std::cbrt(x);
}

template <int M>
double regularity(const voronoi::Moments<M>& cell, double size) {
  return dimensionlessSecondMoment<M>(cell.second - cell.first.squaredNorm() / cell.mass, cell.mass, size);
}

}  // namespace

template <int M>
void gather(std::span<const Vec<M>> sites, std::span<const double> volumes, Evaluation<M>& evaluation,
            const RunContext& context) {
  const bool weighted = !volumes.empty();
  std::vector<voronoi::Moments<M>>& moments = evaluation.moments;
  double volume = 0;
  for (const auto& cell : moments) volume += std::max(0.0, cell.mass);
  const auto n = static_cast<double>(sites.size());
  const double least = kEmptyShare * volume / n;
  const Sums sums = parallelReduce(
      context, sites.size(), kGrain, Sums{},
      [&](std::size_t begin, std::size_t end, Sums sum) {
        for (std::size_t i = begin; i < end; ++i) {
          voronoi::Moments<M>& cell = moments[i];
          sum.squaredSites += sites[i].squaredNorm();
          const double cellVolume = weighted ? volumes[i] : cell.mass;
          if (!(cell.mass > least && cellVolume > 0)) {
            cell = {};
            ++sum.empty;
            continue;
          }
          sum.energy += cell.second;
          const double size = root<M>(cellVolume);
          const double squaredMove = cell.first.squaredNorm() / (cell.mass * cell.mass);
          if (weighted) {
            sum.volume += cellVolume * std::pow(cell.mass / cellVolume, M / (M + 2.0));
            sum.squaredMoves += squaredMove / (size * size);
          } else {
            sum.volume += cell.mass;
            sum.squaredMoves += squaredMove;
          }
          sum.squaredGradient += 4 * cell.first.squaredNorm();
          sum.regularity += regularity(cell, size);
        }
        return sum;
      },
      [](const Sums& a, const Sums& b) { return a + b; });
  evaluation.energy = sums.energy;
  evaluation.volume = sums.volume;
  evaluation.emptyCells = sums.empty;
  const double filled = n - static_cast<double>(sums.empty);
  if (filled > 0) {
    evaluation.rmsMove = std::sqrt(sums.squaredMoves / filled);
    if (!weighted) evaluation.rmsMove /= root<M>(sums.volume / n);
    evaluation.meanRegularity = sums.regularity / filled;
  }
  if (sums.squaredSites > 0) evaluation.relativeGradient = std::sqrt(sums.squaredGradient / sums.squaredSites);
}

template <int M>
double optimalRegularity() {
  return kOptimalRegularity<M>;
}

template <int M>
double optimalEnergy(Index sites, double volume) {
  const double cell = volume / static_cast<double>(sites);
  const double size = root<M>(cell);
  return M * static_cast<double>(sites) * cell * (size * size) * optimalRegularity<M>();
}

template void gather<2>(std::span<const Vec2>, std::span<const double>, Evaluation<2>&, const RunContext&);
template void gather<3>(std::span<const Vec3>, std::span<const double>, Evaluation<3>&, const RunContext&);
template double optimalRegularity<2>();
template double optimalRegularity<3>();
template double optimalEnergy<2>(Index, double);
template double optimalEnergy<3>(Index, double);

}  // namespace voroform::cvt
