#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include "progress.hpp"
#include "voroform/core/error.hpp"

namespace voroform::cvt {

namespace {

// L-BFGS with 7 pairs: more gain nothing and cost memory.
constexpr int kRank = 7;
// A line search that took so many evaluations, the most that Ceres allows it, has failed; for want of an exact gradient
// if rms‖cᵢ − xᵢ‖/h is at most that.
constexpr int kFailedSearch = 20;
constexpr double kSearchlessRange = 5e-3;

// The energy as Ceres sees it: in units of the mean cell, on y = √2·(x − center)/h, so that E/(m̄h²) has the gradient
// √2·(mᵢ/m̄)(xᵢ − cᵢ)/h and a unit step against it is Lloyd's. Free of the input's units.
//
// With a density cells of size sᵢ·h have the mass sᵢ⁻²·m̄, where h and m̄ are of the smallest cells and sᵢ^(−M) is the
// relative density of sites: y = √2·(x − center)/(sᵢh) makes the unit step Lloyd's again, for cells of all sizes.
template <int M>
class ScaledEnergy final : public ceres::FirstOrderFunction {
 public:
  ScaledEnergy(Progress<M>& progress, const Vec<M>& center, double spacing, double mass, std::span<const Vec<M>> sites)
      : progress_(progress), center_(center), spacing_(spacing), mass_(mass), count_(sites.size()) {
    for (const Vec<M>& site : sites) weights_.push_back(std::pow(progress.domain().siteDensity(site), 1.0 / M));
  }

  int NumParameters() const override { return static_cast<int>(M * count_); }

  bool Evaluate(const double* parameters, double* cost, double* gradient) const override {
    try {
      Evaluation<M> evaluation = progress_.evaluate(toSites(parameters));
      *cost = evaluation.energy / (mass_ * spacing_ * spacing_);
      lastMoments_ = std::move(evaluation.moments);
      states_.push_back({*cost, stateOf(evaluation)});
      if (gradient != nullptr) {
        for (std::size_t i = 0; i < count_; ++i) {
          const voronoi::Moments<M>& site = lastMoments_[i];
          const bool filled = site.mass > 0;
          for (Index axis = 0; axis < M; ++axis) {
            gradient[M * i + static_cast<std::size_t>(axis)] =
                filled ? -std::sqrt(2.0) * site.first[axis] / (mass_ * spacing_ * weights_[i]) : 0.0;
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

  std::vector<Vec<M>> toSites(const double* parameters) const {
    std::vector<Vec<M>> sites(count_);
    const double scale = spacing_ / std::sqrt(2.0);
    for (std::size_t i = 0; i < count_; ++i) {
      sites[i] = center_ + scale / weights_[i] * Eigen::Map<const Vec<M>>(parameters + M * i);
    }
    return sites;
  }

  std::vector<double> toParameters(std::span<const Vec<M>> sites) const {
    std::vector<double> parameters(M * count_);
    const double scale = std::sqrt(2.0) / spacing_;
    for (std::size_t i = 0; i < count_; ++i) {
      Eigen::Map<Vec<M>>(parameters.data() + M * i) = scale * weights_[i] * (sites[i] - center_);
    }
    return parameters;
  }

  // The evaluation with this cost, of those since the last call.
  State accepted(double cost) {
    const auto match =
        std::find_if(states_.rbegin(), states_.rend(), [&](const Evaluated& e) { return e.cost == cost; });
    if (match != states_.rend()) last_ = match->state;
    acceptedLast_ = !states_.empty() && match == states_.rbegin();
    states_.clear();
    return last_;
  }

  // The moments of the state accepted last, whose sites these are: at hand if it was also evaluated last.
  std::vector<voronoi::Moments<M>> acceptedMoments(std::span<const Vec<M>> sites) const {
    return acceptedLast_ ? lastMoments_ : progress_.evaluate(sites).moments;
  }

  void rethrowFailure() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  struct Evaluated {
    double cost = 0;
    State state;
  };

  Progress<M>& progress_;
  Vec<M> center_;
  double spacing_;
  double mass_;
  std::size_t count_;
  std::vector<double> weights_;  // 1/sᵢ
  mutable std::vector<Evaluated> states_;
  mutable std::vector<voronoi::Moments<M>> lastMoments_;
  mutable std::exception_ptr failure_;
  State last_;
  bool acceptedLast_ = false;
};

template <int M>
class AcceptedStep final : public ceres::IterationCallback {
 public:
  AcceptedStep(ScaledEnergy<M>& energy, Progress<M>& progress, bool mayReseed, Index siteCount)
      : energy_(energy),
        progress_(progress),
        mayReseed_(mayReseed),
        siteCount_(siteCount),
        lastEvaluations_(progress.summary().evaluations) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    const State state = energy_.accepted(iteration.cost);
    stop = progress_.accept(state, siteCount_);
    wantsReseed = !stop && mayReseed_ && state.emptyCells > 0;
    const int evaluations = progress_.summary().evaluations;
    const bool searchFailed = evaluations - lastEvaluations_ >= kFailedSearch && state.rmsMove <= kSearchlessRange;
    lastEvaluations_ = evaluations;
    return stop || wantsReseed || searchFailed ? ceres::SOLVER_TERMINATE_SUCCESSFULLY : ceres::SOLVER_CONTINUE;
  }

  bool stop = false;
  bool wantsReseed = false;

 private:
  ScaledEnergy<M>& energy_;
  Progress<M>& progress_;
  bool mayReseed_;
  Index siteCount_;
  int lastEvaluations_;
};

template <int M>
Vec<M> centerOf(std::span<const Vec<M>> sites) {
  Box<M> box;
  for (const Vec<M>& site : sites) box.extend(site);
  return box.center();
}

}  // namespace

template <int M>
void minimizeLbfgs(std::vector<Vec<M>>& sites, Progress<M>& progress) {
  const OptimizeOptions& options = progress.options();
  // Where sites lie as densely as they should, the sum is n·V/∫ siteDensity: then this is the mass of a smallest cell.
  double inverse = 0;
  for (const Vec<M>& site : sites) inverse += 1 / progress.domain().siteDensity(site);
  const double mass = progress.domain().volume() / inverse;
  const std::vector<IterationRecord>& records = progress.summary().iterations;
  for (int round = 0;; ++round) {
    const std::size_t recordsBefore = records.size();
    auto* energy = new ScaledEnergy<M>(progress, centerOf<M>(sites), std::pow(mass, 1.0 / M), mass, sites);
    const ceres::GradientProblem problem(energy);  // owns it
    AcceptedStep<M> callback(*energy, progress, round < options.reseedRounds, static_cast<Index>(sites.size()));
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
    if (records.size() == recordsBefore) {
      // The solver ended at once: the sites can't be evaluated, which throws here, or none of them would move.
      const State state = stateOf(progress.evaluate(sites));
      if (!std::isfinite(state.energy)) throw MethodError("the energy of the sites is not finite");
      if (!progress.accept(state, static_cast<Index>(sites.size()))) progress.stalled();
      return;
    }
    if (!callback.wantsReseed) {
      if (records.back().rmsMove > kSearchlessRange) {
        progress.stalled();
        return;
      }
      progress.restarted();
      minimizeWithoutSearch(sites, progress);
      return;
    }
    reseed(sites, energy->acceptedMoments(sites), round, progress);
    progress.restarted();
  }
}

template void minimizeLbfgs<2>(std::vector<Vec2>&, Progress<2>&);
template void minimizeLbfgs<3>(std::vector<Vec3>&, Progress<3>&);

}  // namespace voroform::cvt
