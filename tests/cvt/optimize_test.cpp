// The optimizers on exact domains of the plane, where the gradient is that of the energy, and on a ball.
#include "voroform/cvt/optimize.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <vector>

#include "voroform/core/error.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/planar_domain.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::cvt {
namespace {

constexpr Optimizer kAll[] = {Optimizer::lbfgs, Optimizer::lloyd, Optimizer::lloydNewton, Optimizer::monteCarlo};
constexpr double kRounding = 1e-12;

template <int M>
struct Optimized {
  std::vector<Vec<M>> sites;
  OptimizeSummary summary;
};

template <int M>
Optimized<M> runFrom(const Domain<M>& domain, Index count, const OptimizeOptions& options, int threads = 0) {
  RunContext context;
  context.threads = threads;
  Optimized<M> run{randomSites(domain, count, options.seed, context), {}};
  run.summary = optimize(domain, run.sites, options, context);
  return run;
}

Optimized<2> inSquare(Index count, const OptimizeOptions& options, int threads = 0) {
  const mesh::PlanarRegion region = mesh::squareRegion();
  return runFrom(PlanarDomain(region), count, options, threads);
}

Optimized<3> inBall(Index count, const OptimizeOptions& options, int threads = 0) {
  const auto form = implicit::sphere(0.7);
  return runFrom(ImplicitDomain(*form), count, options, threads);
}

// A domain that counts what is asked of it.
class CountingDomain final : public Domain<2> {
 public:
  explicit CountingDomain(const mesh::PlanarRegion& region) : domain_(region) {}
  Box2 bounds() const override { return domain_.bounds(); }
  Box2 siteBox() const override { return domain_.siteBox(); }
  bool contains(const Vec2& p) const override { return domain_.contains(p); }
  double volume() const override { return domain_.volume(); }
  Evaluation<2> evaluate(std::span<const Vec2> sites, const RunContext& context) const override {
    ++evaluations;
    return domain_.evaluate(sites, context);
  }
  SiteGraph graph(std::span<const Vec2> sites, const RunContext& context) const override {
    return domain_.graph(sites, context);
  }

  mutable std::atomic<int> evaluations = 0;

 private:
  PlanarDomain domain_;
};

TEST(Optimize, NoOptimizerRaisesTheEnergyOfAnExactDomain) {
  for (const Optimizer optimizer : kAll) {
    const Optimized<2> run =
        inSquare(200, {.iterations = 60, .optimizer = optimizer, .convergence = 1e-9, .perturbations = 20});
    const auto& records = run.summary.iterations;
    ASSERT_GT(records.size(), 5U);
    for (std::size_t k = 1; k < records.size(); ++k) {
      EXPECT_LE(records[k].energy, records[k - 1].energy * (1 + kRounding))
          << "optimizer " << static_cast<int>(optimizer) << ", iteration " << k;
    }
    EXPECT_LT(records.back().energy, 0.6 * records.front().energy);
    EXPECT_EQ(run.summary.energy, records.back().energy);
  }
}

TEST(Optimize, CountsEveryEvaluation) {
  const mesh::PlanarRegion region = mesh::starRegion();
  for (const Optimizer optimizer : kAll) {
    const CountingDomain domain(region);
    const Optimized<2> run = runFrom<2>(domain, 100, {.iterations = 40, .optimizer = optimizer, .perturbations = 5});
    EXPECT_EQ(run.summary.evaluations, domain.evaluations.load());
    EXPECT_EQ(run.summary.iterations.back().evaluations, run.summary.evaluations);
  }
}

TEST(Optimize, ThreadsGiveTheSameBits) {
  for (const Optimizer optimizer : kAll) {
    const OptimizeOptions options = {
        .iterations = 30, .optimizer = optimizer, .convergence = 0, .perturbations = 3, .seed = 5};
    EXPECT_EQ(inSquare(300, options, 1).sites, inSquare(300, options, 2).sites);
    EXPECT_EQ(inBall(200, options, 1).sites, inBall(200, options, 2).sites);
  }
}

// How many iterations took the residual from below `from` to `to`; −1 if it did not get there.
int iterationsBetween(const OptimizeSummary& summary, double from, double to) {
  int count = 0;
  for (const IterationRecord& record : summary.iterations) {
    if (record.rmsMove <= to) return count;
    if (record.rmsMove <= from) ++count;
  }
  return -1;
}

TEST(LloydNewton, IsQuadraticWhereLloydIsLinear) {
  OptimizeOptions options = {.iterations = 2000, .optimizer = Optimizer::lloydNewton, .convergence = 1e-13};
  const Optimized<2> newton = inSquare(30, options);
  EXPECT_EQ(newton.summary.stop, StopReason::converged);
  // 4e-4, 5e-5, 7e-7, 1e-10, 1e-16.
  const int steps = iterationsBetween(newton.summary, 1e-4, 1e-13);
  EXPECT_GE(steps, 1);
  EXPECT_LE(steps, 5);

  options.optimizer = Optimizer::lloyd;
  options.convergence = 1e-8;
  const OptimizeSummary lloyd = inSquare(30, options).summary;
  EXPECT_EQ(lloyd.stop, StopReason::converged);
  EXPECT_GT(iterationsBetween(lloyd, 1e-4, 1e-8), 50);
}

TEST(LloydNewton, EachStepLowersEnergyOrResidual) {
  const OptimizeSummary summary =
      inSquare(200, {.iterations = 1000, .optimizer = Optimizer::lloydNewton, .convergence = 1e-12}).summary;
  EXPECT_EQ(summary.stop, StopReason::converged);
  EXPECT_GT(summary.rejectedSteps, 0);
  for (std::size_t k = 1; k < summary.iterations.size(); ++k) {
    const IterationRecord& before = summary.iterations[k - 1];
    const IterationRecord& after = summary.iterations[k];
    EXPECT_TRUE(after.energy < before.energy || after.rmsMove < before.rmsMove) << "iteration " << k;
  }
}

TEST(LloydNewton, ConvergesInABall) {
  const Optimized<3> run = inBall(300, {.iterations = 1000, .optimizer = Optimizer::lloydNewton, .convergence = 1e-4});
  EXPECT_EQ(run.summary.stop, StopReason::converged);
  EXPECT_LT(run.summary.relativeError, 0.05);
}

TEST(MonteCarlo, FindsLowerEnergyThanLbfgs) {
  for (const std::uint64_t seed : {1, 2}) {
    OptimizeOptions options = {.iterations = 1000, .perturbations = 60, .seed = seed};
    const OptimizeSummary local = inSquare(300, options).summary;
    options.optimizer = Optimizer::monteCarlo;
    const OptimizeSummary global = inSquare(300, options).summary;
    EXPECT_EQ(global.stop, StopReason::converged);
    // Both lie 1 to 2 per cent above the optimum that no square can have.
    EXPECT_LT(global.relativeError, 0.9 * local.relativeError);
    EXPECT_LT(global.iterations.back().meanRegularity, local.iterations.back().meanRegularity);
  }
}

TEST(MonteCarlo, FindsLowerEnergyInABall) {
  OptimizeOptions options = {.iterations = 200, .perturbations = 30};
  const OptimizeSummary local = inBall(150, options).summary;
  options.optimizer = Optimizer::monteCarlo;
  const OptimizeSummary global = inBall(150, options).summary;
  EXPECT_LT(global.energy, local.energy * (1 - 1e-4));
}

TEST(MonteCarlo, WithoutPerturbationsIsLocal) {
  const OptimizeSummary summary =
      inSquare(100, {.iterations = 1000, .optimizer = Optimizer::monteCarlo, .perturbations = 0}).summary;
  EXPECT_EQ(summary.stop, StopReason::converged);
  EXPECT_EQ(summary.iterations.size(), 3U);
}

TEST(Optimize, StopsAtTheGradientTolerance) {
  constexpr double kTolerance = 1e-10;
  const mesh::PlanarRegion region = mesh::squareRegion();
  const PlanarDomain domain(region);
  for (const Optimizer optimizer : {Optimizer::lbfgs, Optimizer::lloydNewton, Optimizer::monteCarlo}) {
    const OptimizeOptions options = {.iterations = 5000,
                                     .optimizer = optimizer,
                                     .convergence = 0,
                                     .gradientTolerance = kTolerance,
                                     .perturbations = 3};
    const Optimized<2> run = runFrom<2>(domain, 200, options);
    EXPECT_EQ(run.summary.stop, StopReason::converged);
    EXPECT_LE(domain.evaluate(run.sites, {}).relativeGradient, kTolerance);
    // Not much earlier than it must.
    EXPECT_LT(run.summary.iterationsDone, 5000);
    EXPECT_LT(run.summary.iterations.back().rmsMove, 1e-7);
  }
}

TEST(Optimize, StopsAtTheRelativeError) {
  constexpr double kError = 0.05;
  for (const Optimizer optimizer : kAll) {
    const OptimizeOptions options = {
        .iterations = 1000, .optimizer = optimizer, .convergence = 0, .relativeError = kError, .perturbations = 5};
    for (const OptimizeSummary& summary : {inSquare(400, options).summary, inBall(400, options).summary}) {
      EXPECT_EQ(summary.stop, StopReason::relativeError);
      EXPECT_LE(summary.relativeError, kError);
      EXPECT_LE(summary.energy, (1 + kError) * summary.optimalEnergy);
      // The state before was not there yet.
      const IterationRecord& before = summary.iterations[summary.iterations.size() - 2];
      EXPECT_GT(before.energy, (1 + kError) * summary.optimalEnergy * 0.999);
    }
  }
}

TEST(OptimizeOptions, ListEveryViolation) {
  const OptimizeOptions bad = {.iterations = -1,
                               .convergence = -1,
                               .gradientTolerance = std::numeric_limits<double>::quiet_NaN(),
                               .relativeError = -1e-9,
                               .reseedRounds = -2,
                               .perturbations = -3};
  using ::testing::HasSubstr;
  EXPECT_THAT(validate(bad), ::testing::ElementsAre(HasSubstr("iterations is -1"), HasSubstr("convergence"),
                                                    HasSubstr("gradient-tolerance"), HasSubstr("relative-error"),
                                                    HasSubstr("reseedRounds is -2"), HasSubstr("perturbations is -3")));
  EXPECT_THAT(validate(OptimizeOptions{}), ::testing::IsEmpty());
  EXPECT_THROW(inSquare(10, bad), UsageError);
}

}  // namespace
}  // namespace voroform::cvt
