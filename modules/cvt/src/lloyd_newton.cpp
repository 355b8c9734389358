// Lloyd's method, then Newton's for its fixed points (Du and Emelianenko 2006, "Acceleration schemes for computing
// centroidal Voronoi tessellations").
//
// With T Lloyd's map and mᵢ the masses, mᵢ(xᵢ − Tᵢ(X)) is half the energy's gradient, so that Newton's equation for
// X − T(X) = 0 is, near a solution, H·d = −g with the energy's Hessian H, which is symmetric. It is solved by conjugate
// gradients, preconditioned by the masses, as in a trust region (Steihaug 1983), which ends where H has no positive
// curvature; products with H are differences of gradients, one evaluation each.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "progress.hpp"
#include "voroform/core/error.hpp"

namespace voroform::cvt {

namespace {

// Newton's method takes over at this rms‖cᵢ − xᵢ‖/h.
constexpr double kNewtonRange = 0.02;
// Lengths of steps are root mean squares of the sites' moves, in units of the cells' size: of the trust region at
// first and at most, and of the differences, longer than the roots' tolerance on implicit domains asks for.
constexpr double kFirstRadius = 0.05;
constexpr double kMostRadius = 0.2;
constexpr double kDifference = 1e-5;
// Most products with H for one step; a system is solved to kForcing of its right hand side, or better where residuals
// fall fast (Eisenstat and Walker 1996, choice 2).
constexpr int kMostProducts = 50;
constexpr double kForcing = 0.1;
// After a rejected step come Lloyd steps, twice as many each time, at most these.
constexpr int kMostLloydSteps = 32;
// Differences of energies below this are rounding.
constexpr double kRounding = 1e-13;

template <int M>
using Field = std::vector<Vec<M>>;  // a vector for each site

// Products of fields, weighted by the cells' masses; one cell's after the other, so that bits don't depend on threads.
template <int M>
double dot(const Field<M>& a, const Field<M>& b, const Evaluation<M>& state) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += state.moments[i].mass * a[i].dot(b[i]);
  return sum;
}

template <int M>
void add(double factor, const Field<M>& a, Field<M>& sum) {
  for (std::size_t i = 0; i < a.size(); ++i) sum[i] += factor * a[i];
}

template <int M>
class LloydNewton {
 public:
  LloydNewton(std::vector<Vec<M>>& sites, Progress<M>& progress)
      : sites_(sites), progress_(progress), state_(progress.evaluate(sites)) {}

  void run() {
    while (!progress_.accept(stateOf(state_), static_cast<Index>(sites_.size()))) {
      if (state_.emptyCells > 0 || state_.rmsMove > kNewtonRange || wait_-- > 0 || !newtonStep()) lloydStep();
    }
  }

 private:
  struct Direction {
    Field<M> moves;
    bool atRadius = false;
  };

  // The root of the sum of mᵢ times the squared size of cell i, whatever the density: of a field of such vectors.
  double sizeNorm() const { return std::sqrt(state_.energy / (M * optimalRegularity<M>())); }

  // cᵢ − xᵢ, the negative half gradient over the masses.
  Field<M> residuals() const {
    Field<M> result;
    for (const voronoi::Moments<M>& cell : state_.moments) result.push_back(cell.first / cell.mass);
    return result;
  }

  // Half of H times the field, over the masses.
  Field<M> product(const Field<M>& field) {
    const double step = kDifference * sizeNorm() / std::sqrt(dot<M>(field, field, state_));
    std::vector<Vec<M>> moved = sites_;
    add<M>(step, field, moved);
    const Evaluation<M> there = progress_.evaluate(moved);
    Field<M> result(field.size());
    for (std::size_t i = 0; i < field.size(); ++i) {
      result[i] = (state_.moments[i].first - there.moments[i].first) / (step * state_.moments[i].mass);
    }
    return result;
  }

  Direction direction(double radius, double forcing) {
    Field<M> residual = residuals();
    Direction result{Field<M>(sites_.size(), Vec<M>::Zero())};
    Field<M>& moves = result.moves;
    Field<M> search = residual;
    double squared = dot<M>(residual, residual, state_);
    const double enough = forcing * forcing * squared;
    for (int k = 0; k < kMostProducts && squared > enough; ++k) {
      const Field<M> image = product(search);
      const double curvature = dot<M>(search, image, state_);
      const double length = dot<M>(search, search, state_);
      const double along = dot<M>(search, moves, state_);
      // How far along the search direction the trust region ends.
      const double most =
          (std::sqrt(along * along + length * (radius * radius - dot<M>(moves, moves, state_))) - along) / length;
      const double step = curvature > 0 ? squared / curvature : std::numeric_limits<double>::infinity();
      result.atRadius = step >= most;
      add<M>(std::min(step, most), search, moves);
      if (result.atRadius) break;
      add<M>(-step, image, residual);
      const double before = std::exchange(squared, dot<M>(residual, residual, state_));
      for (std::size_t i = 0; i < search.size(); ++i) search[i] = residual[i] + squared / before * search[i];
    }
    return result;
  }

  // Whether it lowered the energy, or the residual by a full Newton step: near a solution the energy is all rounding,
  // and on implicit domains its gradient is not exact.
  bool newtonStep() {
    const double ratio = state_.rmsMove / lastResidual_;
    const double forcing = std::min(kForcing, 0.9 * ratio * ratio);
    try {
      const Direction newton = direction(radius_ * sizeNorm(), forcing);
      std::vector<Vec<M>> moved = sites_;
      add<M>(1, newton.moves, moved);
      Evaluation<M> there = progress_.evaluate(moved);
      const bool lower = there.energy < state_.energy * (1 - kRounding);
      const bool closer = !newton.atRadius && there.rmsMove < state_.rmsMove;
      if (there.emptyCells == 0 && (lower || closer)) {
        lastResidual_ = state_.rmsMove;
        sites_ = std::move(moved);
        state_ = std::move(there);
        if (newton.atRadius) radius_ = std::min(kMostRadius, 2 * radius_);
        lloydSteps_ = 1;
        wait_ = 0;
        return true;
      }
    } catch (const MethodError&) {
      // A step out of the domain or onto another site.
    }
    ++progress_.summary().rejectedSteps;
    radius_ /= 4;
    wait_ = lloydSteps_ - 1;
    lloydSteps_ = std::min(kMostLloydSteps, 2 * lloydSteps_);
    return false;
  }

  void lloydStep() {
    lastResidual_ = 0;
    cvt::lloydStep(sites_, state_, reseedRounds_, progress_);
    state_ = progress_.evaluate(sites_);
  }

  std::vector<Vec<M>>& sites_;
  Progress<M>& progress_;
  Evaluation<M> state_;
  double radius_ = kFirstRadius;
  double lastResidual_ = 0;  // before the Newton step that led here; 0: there was none
  int wait_ = 0;             // Lloyd steps to come before the next Newton step
  int lloydSteps_ = 1;       // after the next rejected step
  int reseedRounds_ = 0;
};

}  // namespace

template <int M>
void minimizeLloydNewton(std::vector<Vec<M>>& sites, Progress<M>& progress) {
  LloydNewton<M>(sites, progress).run();
}

template void minimizeLloydNewton<2>(std::vector<Vec2>&, Progress<2>&);
template void minimizeLloydNewton<3>(std::vector<Vec3>&, Progress<3>&);

}  // namespace voroform::cvt
