#include "voroform/cvt/energy.hpp"

#include <algorithm>
#include <cmath>

#include "voroform/core/parallel.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::cvt {

namespace {

constexpr std::size_t kGrain = 4096;
// Room around the form's bounds, in units of their diagonal.
constexpr double kDomainMargin = 0.1;
// A cell with less than this share of the mean mass is as good as empty: its centroid is lost in rounding, or it is
// what flat caps leave of a part thinner than they can follow.
constexpr double kEmptyShare = 1e-6;

struct Sums {
  double energy = 0;
  double volume = 0;
  double squaredMoves = 0;
  Index empty = 0;
};

}  // namespace

Box3 siteDomain(const implicit::ImplicitFunction& f) {
  const Box3 bounds = f.bounds();
  const Vec3 margin = Vec3::Constant(kDomainMargin * bounds.diagonal().norm());
  return {bounds.min() - margin, bounds.max() + margin};
}

Evaluation evaluateEnergy(std::span<const Vec3> sites, const implicit::ImplicitFunction& f,
                          const voronoi::ClipOptions& options, const RunContext& context) {
  Evaluation result;
  voronoi::ClipOptions flat = options;
  flat.cap = voronoi::CapKind::flat;
  const voronoi::Diagram diagram = voronoi::buildDiagram(sites, siteDomain(f), context);
  Stopwatch watch;
  const voronoi::ClippedDiagram clipped = voronoi::clip(diagram, f, flat, context);
  result.clip = clipped.summary;
  result.moments = voronoi::siteMoments(diagram, clipped, context);

  double volume = 0;
  for (const voronoi::SiteMoments& site : result.moments) volume += std::max(0.0, site.mass);
  const double least = kEmptyShare * volume / static_cast<double>(sites.size());

  const Sums sums = parallelReduce(
      context, sites.size(), kGrain, Sums{},
      [&](std::size_t begin, std::size_t end, Sums sum) {
        for (std::size_t i = begin; i < end; ++i) {
          voronoi::SiteMoments& site = result.moments[i];
          if (!(site.mass > least)) {
            site = {};
            ++sum.empty;
            continue;
          }
          sum.energy += site.second;
          sum.volume += site.mass;
          sum.squaredMoves += site.first.squaredNorm() / (site.mass * site.mass);
        }
        return sum;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a.energy + b.energy, a.volume + b.volume, a.squaredMoves + b.squaredMoves, a.empty + b.empty};
      });
  result.energy = sums.energy;
  result.volume = sums.volume;
  result.emptyCells = sums.empty;
  const double n = static_cast<double>(sites.size());
  const double filled = n - static_cast<double>(sums.empty);
  if (filled > 0) result.rmsMove = std::sqrt(sums.squaredMoves / filled) / std::cbrt(sums.volume / n);
  result.secondsDelaunay = diagram.secondsDelaunay;
  result.secondsAfterDelaunay = diagram.secondsFlattening + watch.seconds();
  return result;
}

double optimalEnergy(Index sites, double volume) {
  const double regularity = 19 / (192 * std::cbrt(2.0));  // of the truncated octahedron
  const double cell = volume / static_cast<double>(sites);
  return 3 * static_cast<double>(sites) * cell * std::pow(std::cbrt(cell), 2) * regularity;
}

}  // namespace voroform::cvt
