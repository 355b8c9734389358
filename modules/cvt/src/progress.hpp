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
  const RunContext& context() const { return context_; }

  Evaluation<M> evaluate(std::span<const Vec<M>> sites) {
    context_.throwIfCancelled();
    ++summary_.evaluations;
    return domain_.evaluate(sites, context_);
  }

  // Records an accepted state; the stop becomes what the tolerances make of it.
  void record(const State& state, Index siteCount) {
    summary_.iterations.push_back({state.energy, state.rmsMove, state.meanRegularity, summary_.evaluations});
    summary_.energy = state.energy;
    summary_.optimalEnergy = optimalEnergy<M>(siteCount, state.volume);
    summary_.relativeError = (state.energy - summary_.optimalEnergy) / summary_.optimalEnergy;
    summary_.iterationsDone = static_cast<int>(summary_.iterations.size()) - 1 - summary_.restarts;
    const bool converged = (options_.convergence > 0 && state.rmsMove <= options_.convergence) ||
                           (options_.gradientTolerance > 0 && state.relativeGradient <= options_.gradientTolerance);
    summary_.stop = converged                ? StopReason::converged
                    : reachedRelativeError() ? StopReason::relativeError
                                             : StopReason::iterations;
  }
  bool reachedRelativeError() const {
    return options_.relativeError > 0 && summary_.relativeError <= options_.relativeError;
  }

  // Records an accepted state and tells whether to stop there.
  bool accept(const State& state, Index siteCount) {
    record(state, siteCount);
    const int done = summary_.iterationsDone;
    if (options_.iterations > 0) context_.report("optimize", static_cast<double>(done) / options_.iterations);
    return summary_.stop != StopReason::iterations || done >= options_.iterations;
  }

  // A restart evaluates the state it starts from again: that is no iteration.
  void restarted() { ++summary_.restarts; }
  void stalled() { summary_.stop = StopReason::stalled; }
  // Stalled, and the sites are back in this state: it is recorded last, but is no iteration.
  void stalledAt(const State& state, Index siteCount) {
    const int done = summary_.iterationsDone;
    record(state, siteCount);
    summary_.iterationsDone = done;
    stalled();
  }

 private:
  const Domain<M>& domain_;
  const OptimizeOptions& options_;
  OptimizeSummary& summary_;
  const RunContext& context_;
};

// Moves the sites without a cell into the largest cells, one each. The moments are those of the sites where they are.
template <int M>
void reseed(std::vector<Vec<M>>& sites, const std::vector<voronoi::Moments<M>>& moments, int round,
            Progress<M>& progress);

// Moves the sites to the centroids of their cells; if cells are empty, their sites too, in the first rounds asked for.
template <int M>
void lloydStep(std::vector<Vec<M>>& sites, const Evaluation<M>& state, int& reseedRound, Progress<M>& progress);

// Each minimizes until the progress says to stop. Throws MethodError if the sites can't be evaluated.
template <int M>
void minimizeLbfgs(std::vector<Vec<M>>& sites, Progress<M>& progress);
// Goes on where a line search failed. The progress stalls when the residual no longer falls; then the sites are those
// of the least one.
template <int M>
void minimizeWithoutSearch(std::vector<Vec<M>>& sites, Progress<M>& progress);
template <int M>
void minimizeLloydNewton(std::vector<Vec<M>>& sites, Progress<M>& progress);
// Until all perturbations are tried.
template <int M>
void minimizeMonteCarlo(std::vector<Vec<M>>& sites, Progress<M>& progress);

}  // namespace voroform::cvt
