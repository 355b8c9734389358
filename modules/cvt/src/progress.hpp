// Where an optimization stands: shared by all optimizers, across restarts.
#pragma once

#include <span>
#include <vector>

#include "voroform/cvt/optimize.hpp"

namespace voroform::cvt {

// What the stopping rules need of a state.
struct State {
  double energy = 0;
  double volume = 0;
  double rmsMove = 0;
  double relativeGradient = 0;
  double meanRegularity = 0;
  Index emptyCells = 0;
};
template <int M>
State stateOf(const Evaluation<M>& evaluation) {
  return {evaluation.energy,           evaluation.volume,         evaluation.rmsMove,
          evaluation.relativeGradient, evaluation.meanRegularity, evaluation.emptyCells};
}

template <int M>
class Progress {
 public:
  Progress(const Domain<M>& domain, const OptimizeOptions& options, OptimizeSummary& summary, const RunContext& context)
      : domain_(domain), options_(options), summary_(summary), context_(context) {}

  const Domain<M>& domain() const { return domain_; }
  const OptimizeOptions& options() const { return options_; }
  OptimizeSummary& summary() { return summary_; }

  Evaluation<M> evaluate(std::span<const Vec<M>> sites) {
    context_.throwIfCancelled();
    ++summary_.evaluations;
    return domain_.evaluate(sites, context_);
  }

  // Records an accepted state and tells whether to stop there.
  bool accept(const State& state, Index siteCount) {
    summary_.iterations.push_back({state.energy, state.rmsMove, state.meanRegularity, summary_.evaluations});
    summary_.energy = state.energy;
    summary_.optimalEnergy = optimalEnergy<M>(siteCount, state.volume);
    summary_.relativeError = (state.energy - summary_.optimalEnergy) / summary_.optimalEnergy;
    const int done = static_cast<int>(summary_.iterations.size()) - 1 - summary_.restarts;
    summary_.iterationsDone = done;
    if (options_.iterations > 0) context_.report("optimize", static_cast<double>(done) / options_.iterations);
    if ((options_.convergence > 0 && state.rmsMove <= options_.convergence) ||
        (options_.gradientTolerance > 0 && state.relativeGradient <= options_.gradientTolerance)) {
      summary_.stop = StopReason::converged;
      return true;
    }
    if (options_.relativeError > 0 && summary_.relativeError <= options_.relativeError) {
      summary_.stop = StopReason::relativeError;
      return true;
    }
    summary_.stop = StopReason::iterations;
    return done >= options_.iterations;
  }

  // A restart evaluates the state it starts from again: that is no iteration.
  void restarted() { ++summary_.restarts; }
  void stalled() { summary_.stop = StopReason::stalled; }

 private:
  const Domain<M>& domain_;
  const OptimizeOptions& options_;
  OptimizeSummary& summary_;
  const RunContext& context_;
};

// Moves the sites without a cell into the largest cells, one each.
template <int M>
Index reseed(std::vector<Vec<M>>& sites, const std::vector<voronoi::Moments<M>>& moments, std::uint64_t seed,
             int round);

// Minimizes by L-BFGS until the progress says to stop.
template <int M>
void minimizeLbfgs(std::vector<Vec<M>>& sites, Progress<M>& progress);

}  // namespace voroform::cvt
