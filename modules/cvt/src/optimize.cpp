#include "voroform/cvt/optimize.hpp"

#include <algorithm>
#include <cmath>

#include "progress.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"

namespace voroform::cvt {

namespace {

// A re-seeded site is put this far from the centroid of the cell it shares, in units of the cell's size.
constexpr double kReseedOffset = 0.2;

template <int M>
void minimizeLloyd(std::vector<Vec<M>>& sites, Progress<M>& progress) {
  int reseedRound = 0;
  while (true) {
    const Evaluation<M> state = progress.evaluate(sites);
    if (progress.accept(stateOf(state), static_cast<Index>(sites.size()))) return;
    lloydStep(sites, state, reseedRound, progress);
  }
}

}  // namespace

template <int M>
void reseed(std::vector<Vec<M>>& sites, const std::vector<voronoi::Moments<M>>& moments, int round,
            Progress<M>& progress) {
  std::vector<Index> empty;
  std::vector<Index> largest;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    (moments[i].mass > 0 ? largest : empty).push_back(static_cast<Index>(i));
  }
  const std::size_t count = std::min(empty.size(), largest.size());
  std::partial_sort(largest.begin(), largest.begin() + static_cast<std::ptrdiff_t>(count), largest.end(),
                    [&](Index a, Index b) {
                      const double massA = moments[static_cast<std::size_t>(a)].mass;
                      const double massB = moments[static_cast<std::size_t>(b)].mass;
                      return massA != massB ? massA > massB : a < b;
                    });
  const Box<M> cube(Vec<M>::Constant(-1), Vec<M>::Constant(1));
  const Box<M> box = progress.domain().siteBox();
  for (std::size_t k = 0; k < count; ++k) {
    const auto host = static_cast<std::size_t>(largest[k]);
    const voronoi::Moments<M>& cell = moments[host];
    const std::uint64_t key = static_cast<std::uint64_t>(round) * sites.size() + k;
    const Vec<M> direction = randomInBox(progress.options().seed, RandomStream::reseed, key, cube).stableNormalized();
    const Vec<M> place =
        sites[host] + cell.first / cell.mass + kReseedOffset * std::pow(cell.mass, 1.0 / M) * direction;
    if (!box.contains(place)) continue;
    sites[static_cast<std::size_t>(empty[k])] = place;
    ++progress.summary().reseededSites;
  }
}

template <int M>
void lloydStep(std::vector<Vec<M>>& sites, const Evaluation<M>& state, int& reseedRound, Progress<M>& progress) {
  // Before the other sites move: it goes by where they are.
  if (state.emptyCells > 0 && reseedRound < progress.options().reseedRounds) {
    reseed(sites, state.moments, reseedRound++, progress);
  }
  const Box<M> box = progress.domain().siteBox();
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!(state.moments[i].mass > 0)) continue;
    // What flat caps leave of a thin part can have its centroid anywhere.
    const Vec<M> centroid = sites[i] + state.moments[i].first / state.moments[i].mass;
    if (box.contains(centroid)) sites[i] = centroid;
  }
}

const char* toString(StopReason reason) {
  switch (reason) {
    case StopReason::iterations:
      return "iterations";
    case StopReason::converged:
      return "converged";
    case StopReason::relativeError:
      return "relative-error";
    case StopReason::stalled:
      return "stalled";
  }
  return "";
}

std::vector<std::string> validate(const OptimizeOptions& options) {
  std::vector<std::string> violations;
  const auto atLeastZero = [&](const char* name, auto value) {
    if (!(value >= 0)) {
      violations.push_back(std::string(name) + " is " + std::to_string(value) + ", but must be at least 0");
    }
  };
  atLeastZero("iterations", options.iterations);
  atLeastZero("convergence", options.convergence);
  atLeastZero("gradient-tolerance", options.gradientTolerance);
  atLeastZero("relative-error", options.relativeError);
  atLeastZero("reseedRounds", options.reseedRounds);
  atLeastZero("perturbations", options.perturbations);
  return violations;
}

template <int M>
OptimizeSummary optimize(const Domain<M>& domain, std::vector<Vec<M>>& sites, const OptimizeOptions& options,
                         const RunContext& context) {
  if (const auto violations = validate(options); !violations.empty()) throw UsageError(violations.front());
  OptimizeSummary summary;
  Progress<M> progress(domain, options, summary, context);
  if (options.iterations == 0 || options.optimizer == Optimizer::lloyd) {
    minimizeLloyd(sites, progress);
  } else if (options.optimizer == Optimizer::lloydNewton) {
    minimizeLloydNewton(sites, progress);
  } else if (options.optimizer == Optimizer::monteCarlo) {
    minimizeMonteCarlo(sites, progress);
  } else {
    minimizeLbfgs(sites, progress);
  }
  return summary;
}

template void reseed<2>(std::vector<Vec2>&, const std::vector<voronoi::Moments<2>>&, int, Progress<2>&);
template void reseed<3>(std::vector<Vec3>&, const std::vector<voronoi::Moments<3>>&, int, Progress<3>&);
template void lloydStep<2>(std::vector<Vec2>&, const Evaluation<2>&, int&, Progress<2>&);
template void lloydStep<3>(std::vector<Vec3>&, const Evaluation<3>&, int&, Progress<3>&);
template OptimizeSummary optimize<2>(const Domain<2>&, std::vector<Vec2>&, const OptimizeOptions&, const RunContext&);
template OptimizeSummary optimize<3>(const Domain<3>&, std::vector<Vec3>&, const OptimizeOptions&, const RunContext&);

}  // namespace voroform::cvt
