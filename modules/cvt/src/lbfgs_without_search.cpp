// L-BFGS by the gradient alone, for where the energy no longer guides: it is all rounding near a minimum, and on
// implicit domains it disagrees with its gradient by the cap term. Each step is taken in full length, and the memory
// cleared when the residual grows: then the next step is Lloyd's.
#include <Eigen/Core>
#include <cmath>
#include <deque>
#include <utility>
#include <vector>

#include "progress.hpp"
#include "voroform/core/error.hpp"

namespace voroform::cvt {

namespace {

constexpr std::size_t kRank = 20;
// The memory is cleared when the residual exceeds the least since by this factor.
constexpr double kGrowth = 3;
// No step is longer, as the root mean square of the sites' moves in units of the cells' size.
constexpr double kLongestStep = 0.1;
// Iterations in which the residual must fall below its least, or there is nothing to be gained.
constexpr int kPatience = 200;

using Vector = Eigen::VectorXd;

// The inverse Hessian by the two-loop recursion (Nocedal 1980).
class Memory {
 public:
  void clear() { pairs_.clear(); }
  void add(Vector step, Vector change) {
    const double curvature = step.dot(change);
    if (!(curvature > 1e-10 * step.norm() * change.norm())) return;
    pairs_.push_back({std::move(step), std::move(change), curvature});
    if (pairs_.size() > kRank) pairs_.pop_front();
  }
  Vector times(Vector gradient) const {
    std::vector<double> factors;
    for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
      factors.push_back(pair->step.dot(gradient) / pair->curvature);
      gradient -= factors.back() * pair->change;
    }
    if (!pairs_.empty()) gradient *= pairs_.back().curvature / pairs_.back().change.squaredNorm();
    for (const Pair& pair : pairs_) {
      gradient += (factors.back() - pair.change.dot(gradient) / pair.curvature) * pair.step;
      factors.pop_back();
    }
    return gradient;
  }

 private:
  struct Pair {
    Vector step;
    Vector change;  // of the gradient
    double curvature = 0;
  };
  std::deque<Pair> pairs_;
};

}  // namespace

// On y = √mᵢ·xᵢ with the masses at the start: a unit step against the gradient there is Lloyd's.
template <int M>
void minimizeWithoutSearch(std::vector<Vec<M>>& sites, Progress<M>& progress) {
  const auto count = static_cast<Index>(sites.size());
  Memory memory;
  Vector lastStep;
  Vector lastGradient;
  std::vector<double> scales;
  double least = 0;               // residual since the memory was cleared
  std::vector<Vec<M>> bestSites;  // of the least residual since the start
  State best;
  for (int unimproved = 0; unimproved < kPatience; ++unimproved) {
    Evaluation<M> state;
    try {
      state = progress.evaluate(sites);
    } catch (const MethodError&) {
      if (bestSites.empty()) throw;
      break;  // a step out of the domain or onto another site
    }
    if (progress.accept(stateOf(state), count)) return;
    if (scales.empty()) {
      for (const voronoi::Moments<M>& cell : state.moments) scales.push_back(cell.mass > 0 ? std::sqrt(cell.mass) : 1);
    }
    Vector gradient(M * count);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      gradient.template segment<M>(M * static_cast<Index>(i)) = -state.moments[i].first / scales[i];
    }
    if (lastStep.size() > 0) memory.add(std::move(lastStep), gradient - lastGradient);
    if (bestSites.empty() || state.rmsMove < best.rmsMove) {
      bestSites = sites;
      best = stateOf(state);
      unimproved = 0;
    }
    const bool grown = least > 0 && state.rmsMove > kGrowth * least;
    if (grown) memory.clear();
    if (grown || least == 0 || state.rmsMove < least) least = state.rmsMove;

    lastStep = -memory.times(gradient);
    lastGradient = std::move(gradient);
    const double longest = kLongestStep * std::sqrt(state.energy / (M * optimalRegularity<M>()));
    if (lastStep.norm() > longest) lastStep *= longest / lastStep.norm();
    for (std::size_t i = 0; i < sites.size(); ++i) {
      sites[i] += lastStep.template segment<M>(M * static_cast<Index>(i)) / scales[i];
    }
  }
  sites = std::move(bestSites);
  progress.stalledAt(best, count);
}

template void minimizeWithoutSearch<2>(std::vector<Vec2>&, Progress<2>&);
template void minimizeWithoutSearch<3>(std::vector<Vec3>&, Progress<3>&);

}  // namespace voroform::cvt
