// What the optimizers do where sites can't be evaluated, cells are empty, or no step gains anything.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "voroform/core/error.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/optimize.hpp"
#include "voroform/cvt/planar_domain.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::cvt {
namespace {

constexpr Optimizer kAll[] = {Optimizer::lbfgs, Optimizer::lloyd, Optimizer::lloydNewton, Optimizer::monteCarlo};
constexpr char kFault[] = "these sites lie on the moon";

// The square from −10 to 10. Before each evaluation it asks `refuses`, and throws a MethodError if that says so; after
// it, `alters` may falsify the result.
class FaultyDomain final : public Domain<2> {
 public:
  Box2 bounds() const override { return domain_.bounds(); }
  Box2 siteBox() const override { return roaming.isEmpty() ? domain_.siteBox() : roaming; }
  bool contains(const Vec2& p) const override { return domain_.contains(p); }
  double volume() const override { return domain_.volume(); }
  Evaluation<2> evaluate(std::span<const Vec2> sites, const RunContext& context) const override {
    ++evaluations;
    if (refuses && refuses(sites)) {
      ++refusals;
      throw MethodError(kFault);
    }
    Evaluation<2> evaluation = domain_.evaluate(sites, context);
    if (alters) alters(evaluation);
    return evaluation;
  }
  SiteGraph graph(std::span<const Vec2> sites, const RunContext& context) const override {
    return domain_.graph(sites, context);
  }

  std::function<bool(std::span<const Vec2>)> refuses;
  std::function<void(Evaluation<2>&)> alters;
  Box2 roaming;  // in place of the square's siteBox()
  mutable int evaluations = 0;
  mutable int refusals = 0;

 private:
  mesh::PlanarRegion region_ = mesh::squareRegion();
  PlanarDomain domain_{region_};
};

double largestMove(std::span<const Vec2> from, std::span<const Vec2> to) {
  double largest = 0;
  for (std::size_t i = 0; i < from.size(); ++i) largest = std::max(largest, (to[i] - from[i]).norm());
  return largest;
}

TEST(OptimizeFailures, SitesThatCannotBeEvaluatedAreTheCallersError) {
  FaultyDomain domain;
  const std::vector<Vec2> initial = randomSites<2>(domain, 20, 1, {});
  domain.refuses = [](std::span<const Vec2>) { return true; };
  for (const Optimizer optimizer : kAll) {
    for (const int iterations : {0, 10}) {
      std::vector<Vec2> sites = initial;
      try {
        optimize<2>(domain, sites, {.iterations = iterations, .optimizer = optimizer}, {});
        ADD_FAILURE() << "optimizer " << static_cast<int>(optimizer) << ", " << iterations << " iterations";
      } catch (const MethodError& error) {
        EXPECT_STREQ(error.what(), kFault);
      }
    }
  }
}

TEST(OptimizeFailures, EnergyThatIsNotFiniteIsAnError) {
  FaultyDomain domain;
  std::vector<Vec2> sites = randomSites<2>(domain, 20, 1, {});
  domain.alters = [](Evaluation<2>& evaluation) { evaluation.energy = std::numeric_limits<double>::quiet_NaN(); };
  try {
    optimize<2>(domain, sites, {}, {});
    ADD_FAILURE();
  } catch (const MethodError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("not finite"));
  }
}

TEST(OptimizeFailures, SitesInPlaceAreConverged) {
  for (const Optimizer optimizer : kAll) {
    FaultyDomain domain;
    std::vector<Vec2> sites = {{0, 0}};
    const OptimizeSummary summary = optimize<2>(domain, sites, {.optimizer = optimizer, .perturbations = 2}, {});
    EXPECT_EQ(summary.stop, StopReason::converged);
    EXPECT_EQ(summary.iterationsDone, optimizer == Optimizer::monteCarlo ? 2 : 0);
    EXPECT_DOUBLE_EQ(summary.energy, 2 * 20 * 2000.0 / 3);
    EXPECT_LT(sites[0].norm(), 1e-12);
  }
}

TEST(OptimizeFailures, LbfgsStaysWhereNoStepCanBeEvaluated) {
  FaultyDomain domain;
  const std::vector<Vec2> initial = randomSites<2>(domain, 20, 1, {});
  domain.refuses = [&](std::span<const Vec2> sites) { return largestMove(initial, sites) > 1e-12; };
  std::vector<Vec2> sites = initial;
  const OptimizeSummary summary = optimize<2>(domain, sites, {}, {});
  EXPECT_EQ(summary.stop, StopReason::stalled);
  EXPECT_GT(domain.refusals, 0);
  EXPECT_LE(largestMove(initial, sites), 1e-12);
  EXPECT_EQ(summary.energy, domain.evaluate(sites, {}).energy);
}

// The run stalled, and its summary describes the sites that it left.
template <int M>
void expectStalledAt(const std::vector<Vec<M>>& sites, const Domain<M>& domain, const OptimizeSummary& summary) {
  EXPECT_EQ(summary.stop, StopReason::stalled);
  const Evaluation<M> evaluation = domain.evaluate(sites, {});
  const IterationRecord& last = summary.iterations.back();
  EXPECT_EQ(evaluation.rmsMove, last.rmsMove);
  EXPECT_EQ(evaluation.meanRegularity, last.meanRegularity);
  EXPECT_EQ(evaluation.energy, last.energy);
  EXPECT_EQ(evaluation.energy, summary.energy);
  EXPECT_EQ(summary.relativeError, (summary.energy - summary.optimalEnergy) / summary.optimalEnergy);
}

template <int M>
void expectReturnToTheLeastResidual(const Domain<M>& domain, Index count) {
  std::vector<Vec<M>> sites = randomSites<M>(domain, count, 3, {});
  const OptimizeSummary summary = optimize<M>(domain, sites, {.iterations = 100'000, .convergence = 0}, {});
  expectStalledAt<M>(sites, domain, summary);
  ASSERT_EQ(summary.restarts, 1) << "a line search was to fail near a minimum";
  const std::vector<IterationRecord>& records = summary.iterations;
  // The initial state, that of the restart and the one gone back to are no iterations.
  EXPECT_EQ(summary.iterationsDone, static_cast<int>(records.size()) - 3);
  EXPECT_GT(records[records.size() - 2].rmsMove, records.back().rmsMove) << "nothing to go back for";
  for (const IterationRecord& record : records) EXPECT_GE(record.rmsMove, records.back().rmsMove);
  EXPECT_EQ(records.back().evaluations, summary.evaluations);
}

TEST(OptimizeFailures, AStalledRunGoesBackToTheLeastResidual) {
  expectReturnToTheLeastResidual<2>(FaultyDomain(), 50);
  const auto ball = implicit::sphere(0.7);
  expectReturnToTheLeastResidual<3>(ImplicitDomain(*ball), 500);
}

TEST(OptimizeFailures, ARunThatStallsFarFromAMinimumStaysThere) {
  // Flat caps of so few cells falsify the gradient.
  const auto ball = implicit::sphere(0.7);
  const ImplicitDomain domain(*ball);
  std::vector<Vec3> sites = randomSites<3>(domain, 50, 3, {});
  const OptimizeSummary summary = optimize<3>(domain, sites, {.iterations = 100'000, .convergence = 0}, {});
  EXPECT_EQ(summary.restarts, 0);
  expectStalledAt<3>(sites, domain, summary);
}

TEST(OptimizeFailures, AStepThatCannotBeEvaluatedEndsARunByTheGradientAlone) {
  // Only the first sites near a minimum can be evaluated again.
  FaultyDomain domain;
  std::vector<Vec2> sites = randomSites<2>(domain, 50, 3, {});
  std::vector<Vec2> trial;
  std::vector<Vec2> last;
  domain.refuses = [&](std::span<const Vec2> asked) {
    trial.assign(asked.begin(), asked.end());
    return !last.empty() && largestMove(last, trial) > 1e-12;
  };
  domain.alters = [&](Evaluation<2>& evaluation) {
    if (last.empty() && evaluation.rmsMove < 1e-6) last = trial;
  };
  const OptimizeSummary summary = optimize<2>(domain, sites, {.iterations = 100'000, .convergence = 0}, {});
  ASSERT_FALSE(last.empty());
  EXPECT_EQ(summary.restarts, 1);
  EXPECT_LE(largestMove(last, sites), 1e-12);
  expectStalledAt<2>(sites, domain, summary);
}

TEST(MonteCarlo, SurvivesDescentsThatCannotBeEvaluated) {
  OptimizeOptions options = {.iterations = 500, .optimizer = Optimizer::monteCarlo, .perturbations = 20};
  FaultyDomain domain;
  std::vector<Vec2> minimum = randomSites<2>(domain, 60, 1, {});
  optimize<2>(domain, minimum, {.iterations = 500}, {});
  const double energy = domain.evaluate(minimum, {}).energy;

  // No perturbed sites can be evaluated: the local minimum stays.
  domain.refuses = [&](std::span<const Vec2> sites) { return largestMove(minimum, sites) > 0.3; };
  domain.evaluations = 0;
  std::vector<Vec2> sites = minimum;
  OptimizeSummary summary = optimize<2>(domain, sites, options, {});
  EXPECT_GE(domain.refusals, options.perturbations);
  EXPECT_EQ(summary.evaluations, domain.evaluations);
  EXPECT_EQ(summary.iterations.size(), 3U);
  EXPECT_EQ(summary.stop, StopReason::converged);
  EXPECT_LT(largestMove(minimum, sites), 0.3);

  // Some can: of these the best is kept.
  domain.refuses = [&](std::span<const Vec2> trial) { return trial[0].x() < minimum[0].x() - 0.1; };
  domain.refusals = 0;
  sites = minimum;
  options.perturbations = 60;
  summary = optimize<2>(domain, sites, options, {});
  EXPECT_GT(domain.refusals, 0);
  EXPECT_LT(summary.energy, energy * (1 - 1e-4));
  EXPECT_EQ(summary.energy, domain.evaluate(sites, {}).energy);
}

TEST(MonteCarlo, KeepsTheSitesOfAFirstDescentThatCannotBeEvaluated) {
  FaultyDomain domain;
  const std::vector<Vec2> initial = randomSites<2>(domain, 60, 1, {});
  domain.evaluations = 0;
  // The second evaluation is the descent's first; it repeats it for its text.
  domain.refuses = [&](std::span<const Vec2>) { return domain.evaluations == 2 || domain.evaluations == 3; };
  std::vector<Vec2> sites = initial;
  const OptimizeSummary summary =
      optimize<2>(domain, sites, {.iterations = 500, .optimizer = Optimizer::monteCarlo, .perturbations = 0}, {});
  EXPECT_EQ(domain.refusals, 2);
  ASSERT_EQ(summary.iterations.size(), 3U);
  EXPECT_EQ(summary.iterations[1].energy, summary.iterations[0].energy);
  EXPECT_LT(summary.iterations[2].energy, 0.9 * summary.iterations[0].energy) << "the polish descends";
}

// One site has the square for itself; the other one's cell lies beyond it.
const std::vector<Vec2> kOneEmpty = {{8.5, 0}, {12.5, 0}};

TEST(Reseeding, GoesByTheCellsAsTheyWere) {
  for (const Optimizer optimizer : {Optimizer::lloyd, Optimizer::lloydNewton}) {
    const FaultyDomain domain;
    std::vector<Vec2> sites = kOneEmpty;
    ASSERT_EQ(domain.evaluate(sites, {}).emptyCells, 1);
    const OptimizeSummary summary = optimize<2>(domain, sites, {.iterations = 1, .optimizer = optimizer}, {});
    EXPECT_EQ(summary.reseededSites, 1);
    // Centroid and size of the cell are the square's; the offset is a fifth of the size.
    EXPECT_LT(sites[0].norm(), 1e-12);
    EXPECT_NEAR(sites[1].norm(), 0.2 * 20, 1e-12);
  }
}

TEST(Reseeding, FillsEmptyCells) {
  for (const Optimizer optimizer : kAll) {
    const FaultyDomain domain;
    std::vector<Vec2> sites = kOneEmpty;
    const OptimizeSummary summary =
        optimize<2>(domain, sites, {.iterations = 500, .optimizer = optimizer, .perturbations = 0}, {});
    EXPECT_EQ(summary.reseededSites, 1);
    EXPECT_EQ(summary.stop, StopReason::converged);
    const Evaluation<2> evaluation = domain.evaluate(sites, {});
    EXPECT_EQ(evaluation.emptyCells, 0);
    // Two halves of 20 by 10: ∫ (x² + y²) over each about its center.
    EXPECT_NEAR(evaluation.energy, 2 * 200 * (400 + 100) / 12.0, 1);
  }
}

TEST(Reseeding, KeepsToTheBoxOfSites) {
  for (const Optimizer optimizer : kAll) {
    FaultyDomain domain;
    // A place at 4 from the origin lies outside of it.
    domain.roaming = Box2(Vec2(-1, -1), Vec2(1, 1));
    std::vector<Vec2> sites = kOneEmpty;
    const OptimizeSummary summary =
        optimize<2>(domain, sites, {.iterations = 50, .optimizer = optimizer, .perturbations = 0}, {});
    EXPECT_EQ(summary.reseededSites, 0);
    if (optimizer == Optimizer::lloyd) {
      EXPECT_EQ(sites[1], kOneEmpty[1]);
    }
  }
}

}  // namespace
}  // namespace voroform::cvt
