#include "optimize.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include "inside.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/energy.hpp"

namespace voroform::cvt {

namespace {

// L-BFGS with 7 pairs: more gain nothing and cost memory.
constexpr int kRank = 7;
// A re-seeded site is put this far from the centroid of the cell it shares, in units of the cell's size.
constexpr double kReseedOffset = 0.2;

// Where an optimization stands: shared by all optimizers, across restarts.
class Progress {
 public:
  Progress(const implicit::ImplicitFunction& f, const TessellateOptions& options, TessellateSummary& summary,
           const RunContext& context)
      : f_(f), options_(options), summary_(summary), context_(context) {
    clip_.rootFinder = options.rootFinder;
    clip_.rootTolerance = kOptimizationRootTolerance;
  }

  Evaluation evaluate(std::span<const Vec3> sites) {
    context_.throwIfCancelled();
    ++summary_.evaluations;
    return evaluateEnergy(sites, f_, clip_, context_);
  }

  // Records an accepted state and tells whether to stop there.
  bool accept(double energy, double volume, double rmsMove, Index siteCount) {
    summary_.iterations.push_back({energy, rmsMove, summary_.evaluations});
    summary_.energy = energy;
    summary_.optimalEnergy = optimalEnergy(siteCount, volume);
    summary_.relativeError = (energy - summary_.optimalEnergy) / summary_.optimalEnergy;
    const int done = static_cast<int>(summary_.iterations.size()) - 1 - summary_.restarts;
    summary_.iterationsDone = done;
    if (options_.iterations > 0) context_.report("optimize", static_cast<double>(done) / options_.iterations);
    if (options_.convergence > 0 && rmsMove <= options_.convergence) {
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
  const implicit::ImplicitFunction& f_;
  const TessellateOptions& options_;
  TessellateSummary& summary_;
  const RunContext& context_;
  voronoi::ClipOptions clip_;
};

// Moves the sites without a cell into the largest cells, one each.
Index reseed(std::vector<Vec3>& sites, const std::vector<voronoi::SiteMoments>& moments, std::uint64_t seed,
             int round) {
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
  const Box3 cube(Vec3::Constant(-1), Vec3::Constant(1));
  for (std::size_t k = 0; k < count; ++k) {
    const auto host = static_cast<std::size_t>(largest[k]);
    const voronoi::SiteMoments& cell = moments[host];
    const std::uint64_t key = static_cast<std::uint64_t>(round) * sites.size() + k;
    const Vec3 direction = randomInBox(seed, RandomStream::reseed, key, cube).stableNormalized();
    sites[static_cast<std::size_t>(empty[k])] =
        sites[host] + cell.first / cell.mass + kReseedOffset * std::cbrt(cell.mass) * direction;
  }
  return static_cast<Index>(count);
}

// The energy as Ceres sees it: in units of the mean cell, on y = √2·(x − center)/h, so that E/(m̄h²) has the gradient
// √2·(mᵢ/m̄)(xᵢ − cᵢ)/h and a unit step against it is Lloyd's. Free of the input's units.
class ScaledEnergy final : public ceres::FirstOrderFunction {
 public:
  struct State {
    double cost = 0;
    double energy = 0;
    double volume = 0;
    double rmsMove = 0;
    Index emptyCells = 0;
  };

  ScaledEnergy(Progress& progress, const Vec3& center, double spacing, double mass, std::size_t count)
      : progress_(progress), center_(center), spacing_(spacing), mass_(mass), count_(count) {}

  int NumParameters() const override { return static_cast<int>(3 * count_); }

  bool Evaluate(const double* parameters, double* cost, double* gradient) const override {
    try {
      Evaluation evaluation = progress_.evaluate(toSites(parameters));
      *cost = evaluation.energy / (mass_ * spacing_ * spacing_);
      lastMoments_ = std::move(evaluation.moments);
      states_.push_back({*cost, evaluation.energy, evaluation.volume, evaluation.rmsMove, evaluation.emptyCells});
      if (gradient != nullptr) {
        for (std::size_t i = 0; i < count_; ++i) {
          const voronoi::SiteMoments& site = lastMoments_[i];
          const bool filled = site.mass > 0;
          for (Index axis = 0; axis < 3; ++axis) {
            gradient[3 * i + static_cast<std::size_t>(axis)] =
                filled ? -std::sqrt(2.0) * site.first[axis] / (mass_ * spacing_) : 0.0;
          }
        }
      }
      return std::isfinite(*cost);
    } catch (const MethodError&) {
      return false;  // a step out of the domain or onto another site: the line search takes a shorter one
    } catch (...) {
      failure_ = std::current_exception();
      return false;
    }
  }

  std::vector<Vec3> toSites(const double* parameters) const {
    std::vector<Vec3> sites(count_);
    const double scale = spacing_ / std::sqrt(2.0);
    for (std::size_t i = 0; i < count_; ++i) sites[i] = center_ + scale * Eigen::Map<const Vec3>(parameters + 3 * i);
    return sites;
  }

  std::vector<double> toParameters(std::span<const Vec3> sites) const {
    std::vector<double> parameters(3 * count_);
    const double scale = std::sqrt(2.0) / spacing_;
    for (std::size_t i = 0; i < count_; ++i) {
      Eigen::Map<Vec3>(parameters.data() + 3 * i) = scale * (sites[i] - center_);
    }
    return parameters;
  }

  // The evaluation with this cost, of those since the last call.
  State accepted(double cost) {
    const auto match = std::find_if(states_.rbegin(), states_.rend(), [&](const State& s) { return s.cost == cost; });
    if (match != states_.rend()) last_ = *match;
    acceptedLast_ = !states_.empty() && match == states_.rbegin();
    states_.clear();
    return last_;
  }

  // The moments of the state accepted last, whose sites these are: at hand if it was also evaluated last.
  std::vector<voronoi::SiteMoments> acceptedMoments(std::span<const Vec3> sites) const {
    return acceptedLast_ ? lastMoments_ : progress_.evaluate(sites).moments;
  }

  void rethrowFailure() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  Progress& progress_;
  Vec3 center_;
  double spacing_;
  double mass_;
  std::size_t count_;
  mutable std::vector<State> states_;
  mutable std::vector<voronoi::SiteMoments> lastMoments_;
  mutable std::exception_ptr failure_;
  State last_;
  bool acceptedLast_ = false;
};

class AcceptedStep final : public ceres::IterationCallback {
 public:
  AcceptedStep(ScaledEnergy& energy, Progress& progress, bool mayReseed, Index siteCount)
      : energy_(energy), progress_(progress), mayReseed_(mayReseed), siteCount_(siteCount) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    const ScaledEnergy::State state = energy_.accepted(iteration.cost);
    stop = progress_.accept(state.energy, state.volume, state.rmsMove, siteCount_);
    wantsReseed = !stop && mayReseed_ && state.emptyCells > 0;
    return stop || wantsReseed ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  bool stop = false;
  bool wantsReseed = false;

 private:
  ScaledEnergy& energy_;
  Progress& progress_;
  bool mayReseed_;
  Index siteCount_;
};

Vec3 centerOf(std::span<const Vec3> sites) {
  Box3 box;
  for (const Vec3& site : sites) box.extend(site);
  return box.center();
}

void minimizeLbfgs(std::vector<Vec3>& sites, double volume, const TessellateOptions& options, Progress& progress,
                   TessellateSummary& summary) {
  for (int round = 0;; ++round) {
    const double mass = volume / static_cast<double>(sites.size());
    auto* energy = new ScaledEnergy(progress, centerOf(sites), std::cbrt(mass), mass, sites.size());
    const ceres::GradientProblem problem(energy);  // owns it
    AcceptedStep callback(*energy, progress, round < options.reseedRounds, static_cast<Index>(sites.size()));
    ceres::GradientProblemSolver::Options solver;
    solver.line_search_direction_type = ceres::LBFGS;
    solver.line_search_type = ceres::WOLFE;
    solver.max_lbfgs_rank = kRank;
    solver.max_num_iterations = options.iterations + 1;  // the callback stops it
    // The stopping rules are ours alone.
    solver.function_tolerance = 0;
    solver.gradient_tolerance = 0;
    solver.parameter_tolerance = 0;
    solver.logging_type = ceres::SILENT;
    solver.update_state_every_iteration = true;
    solver.callbacks.push_back(&callback);
    std::vector<double> parameters = energy->toParameters(sites);
    ceres::GradientProblemSolver::Summary solverSummary;
    ceres::Solve(solver, problem, parameters.data(), &solverSummary);
    energy->rethrowFailure();
    sites = energy->toSites(parameters.data());
    if (callback.stop) return;
    if (!callback.wantsReseed) {
      progress.stalled();
      return;
    }
    summary.reseededSites += reseed(sites, energy->acceptedMoments(sites), options.seed, round);
    progress.restarted();
  }
}

void minimizeLloyd(std::vector<Vec3>& sites, const Box3& domain, const TessellateOptions& options, Progress& progress,
                   TessellateSummary& summary) {
  int round = 0;
  while (true) {
    const Evaluation state = progress.evaluate(sites);
    if (progress.accept(state.energy, state.volume, state.rmsMove, static_cast<Index>(sites.size()))) return;
    for (std::size_t i = 0; i < sites.size(); ++i) {
      if (!(state.moments[i].mass > 0)) continue;
      // What flat caps leave of a thin part can have its centroid anywhere.
      const Vec3 centroid = sites[i] + state.moments[i].first / state.moments[i].mass;
      if (domain.contains(centroid)) sites[i] = centroid;
    }
    if (state.emptyCells > 0 && round < options.reseedRounds) {
      summary.reseededSites += reseed(sites, state.moments, options.seed, round++);
    }
  }
}

}  // namespace

void minimizeEnergy(std::vector<Vec3>& sites, const implicit::ImplicitFunction& f, const TessellateOptions& options,
                    TessellateSummary& summary, const RunContext& context) {
  Progress progress(f, options, summary, context);
  if (options.iterations == 0 || options.optimizer == Optimizer::lloyd) {
    minimizeLloyd(sites, siteDomain(f), options, progress, summary);
    return;
  }
  // The scale of the variables needs a volume: a quasi-random estimate costs less than an evaluation.
  const Box3 bounds = f.bounds();
  constexpr std::uint64_t kSamples = 20000;
  std::uint64_t inside = 0;
  for (std::uint64_t k = 0; k < kSamples; ++k) {
    if (isInside(f, quasiRandomInBox(options.seed, k, bounds))) ++inside;
  }
  const double share = static_cast<double>(std::max<std::uint64_t>(inside, 1)) / static_cast<double>(kSamples);
  minimizeLbfgs(sites, share * bounds.volume(), options, progress, summary);
}

}  // namespace voroform::cvt
