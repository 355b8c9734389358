// Minimizing the CVT energy of sites in a domain.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/domain.hpp"

namespace voroform::cvt {

enum class Optimizer {
  lbfgs,  // quasi-Newton (Liu et al. 2009)
  lloyd,  // to the centroids (Lloyd 1982): the energy falls in each step, but slowly
  // Lloyd's steps, then Newton's for the fixed points of Lloyd's map (Du and Emelianenko 2006), quadratic at the end. A
  // step that lowers neither energy nor residual is rejected for one of Lloyd's. A Newton step takes up to 50
  // evaluations, and what it ends in can be a saddle of the energy.
  lloydNewton,
  // L-BFGS to a local minimum, then again and again from randomly perturbed sites, the best kept (Lu et al. 2012): for
  // the lowest energy, at hundreds of times the cost.
  monteCarlo
};

enum class StopReason {
  iterations,     // the number of iterations asked for was done
  converged,      // rms‖cᵢ − xᵢ‖/h or ‖g‖/‖X‖ fell below its tolerance
  relativeError,  // (E − E_m)/E_m fell below the one asked for (thesis, Algorithm 1)
  // No line search found lower energy (implicit domains: the gradient lacks a small cap term), and going on by the
  // gradient alone the residual did not fall.
  stalled
};
const char* toString(StopReason reason);

struct OptimizeOptions {
  // Iterations of the optimizer, at least 0; 0 keeps the initial sites. With monteCarlo, of L-BFGS: at most as many at
  // first, after each perturbation (there at most 60) and to polish the best.
  int iterations = 10;
  Optimizer optimizer = Optimizer::lbfgs;
  // Stop when rms‖cᵢ − xᵢ‖/h is at most this; 0 never stops for it.
  double convergence = 5e-4;
  // Stop when ‖g‖/‖X‖ is at most this, the thesis's rule (section 4.2.4), which depends on units and origin; 0 never
  // stops for it.
  double gradientTolerance = 0;
  // Stop when (E − E_m)/E_m is at most this; 0 never stops for it.
  double relativeError = 0;
  // How often sites without a cell may be moved into the largest cells.
  int reseedRounds = 3;
  // Perturbations that monteCarlo tries, at least 0.
  int perturbations = 200;
  std::uint64_t seed = 0;
};
// Every violation of the options, as sentences naming field, value and rule; empty if there is none.
std::vector<std::string> validate(const OptimizeOptions& options);

struct IterationRecord {
  double energy = 0;          // E, in units^(m+2)
  double rmsMove = 0;         // rms‖cᵢ − xᵢ‖/h
  double meanRegularity = 0;  // mean of G
  int evaluations = 0;        // of the energy, in all so far
};

struct OptimizeSummary {
  StopReason stop = StopReason::iterations;
  // The first for the initial sites; one more for each restart; where L-BFGS went on by the gradient alone and stalled,
  // the last for the sites of least residual since, gone back to. Of monteCarlo: the first local minimum, each lower
  // one and the polished best.
  std::vector<IterationRecord> iterations;
  int iterationsDone = 0;    // without the states that restarts began with
  int restarts = 0;          // of L-BFGS: sites moved out of empty cells, or a line search failed
  int rejectedSteps = 0;     // of lloydNewton
  double energy = 0;         // of the sites at the end
  double optimalEnergy = 0;  // E_m = m·n·(V/n)^((m+2)/m)·G_m
  double relativeError = 0;  // (energy − optimalEnergy)/optimalEnergy
  int evaluations = 0;
  Index reseededSites = 0;
};

// Moves the sites to lower energy. The same bits for any number of threads. Throws UsageError on bad options,
// MethodError if the initial sites can't be evaluated, Cancelled.
template <int M>
OptimizeSummary optimize(const Domain<M>& domain, std::vector<Vec<M>>& sites, const OptimizeOptions& options,
                         const RunContext& context);

}  // namespace voroform::cvt
