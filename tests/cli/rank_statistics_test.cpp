// Rank statistics against published constants and worked examples.
#include "voroform/pipeline/rank_statistics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "voroform/core/error.hpp"

namespace voroform::pipeline {
namespace {

using testing::ElementsAre;

constexpr double kFailed = std::numeric_limits<double>::quiet_NaN();

TEST(Ranks, TiesShareTheirMean) {
  EXPECT_THAT(averageRanks(std::array{0.3, 0.1, 0.2}), ElementsAre(3, 1, 2));
  EXPECT_THAT(averageRanks(std::array{1.0, 1.0, 0.5, 2.0}), ElementsAre(2.5, 2.5, 1, 4));
  EXPECT_THAT(averageRanks(std::array{7.0, 7.0, 7.0}), ElementsAre(2, 2, 2));
}

TEST(Ranks, FailuresComeLast) {
  EXPECT_THAT(averageRanks(std::array{kFailed, 5.0, 1.0}), ElementsAre(3, 2, 1));
  EXPECT_THAT(averageRanks(std::array{kFailed, 5.0, std::numeric_limits<double>::infinity()}),
              ElementsAre(2.5, 1, 2.5));
}

TEST(Places, EqualValuesShareTheBetterOne) {
  EXPECT_THAT(places(std::array{0.3, 0.1, 0.2}), ElementsAre(3, 1, 2));
  EXPECT_THAT(places(std::array{1.0, 1.0, 0.5, 2.0}), ElementsAre(2, 2, 1, 4));
  EXPECT_THAT(places(std::array{kFailed, 5.0, kFailed}), ElementsAre(3, 1, 3));
}

// Demšar 2006, table 5 (a): critical values of the two-tailed Nemenyi test.
TEST(NemenyiQuantile, AgreesWithThePublishedTable) {
  constexpr std::array k05 = {1.960, 2.343, 2.569, 2.728, 2.850, 2.949, 3.031, 3.102, 3.164};
  constexpr std::array k10 = {1.645, 2.052, 2.291, 2.459, 2.589, 2.693, 2.780, 2.855, 2.920};
  for (std::size_t i = 0; i < k05.size(); ++i) {
    EXPECT_NEAR(nemenyiQuantile(0.05, i + 2), k05[i], 1e-3) << "k = " << i + 2;
    EXPECT_NEAR(nemenyiQuantile(0.10, i + 2), k10[i], 1e-3) << "k = " << i + 2;
  }
}

// The range of two normal variables is |N(0, 2)|: P(Q ≤ q) = erf(q/2).
TEST(StudentizedRange, IsTheErrorFunctionForTwo) {
  for (const double q : {0.1, 1.0, 2.77, 5.0}) {
    EXPECT_NEAR(studentizedRangeProbability(q, 2), std::erf(0.5 * q), 1e-12) << q;
  }
  EXPECT_NEAR(studentizedRangeProbability(studentizedRangeQuantile(0.37, 6), 6), 0.37, 1e-10);
  EXPECT_THROW(studentizedRangeQuantile(1, 3), UsageError);
}

// Hollander and Wolfe 1973, page 140: times of 22 players rounding first base in three ways, with ties. R's
// friedman.test gives χ² = 11.1429 with 2 degrees of freedom, p = 0.003805.
TEST(Friedman, AgreesWithAWorkedExampleWithTies) {
  const CriterionTable times = {{5.40, 5.50, 5.55}, {5.85, 5.70, 5.75}, {5.20, 5.60, 5.50}, {5.55, 5.50, 5.40},
                                {5.90, 5.85, 5.70}, {5.45, 5.55, 5.60}, {5.40, 5.40, 5.35}, {5.45, 5.50, 5.35},
                                {5.25, 5.15, 5.00}, {5.85, 5.80, 5.70}, {5.25, 5.20, 5.10}, {5.65, 5.55, 5.45},
                                {5.60, 5.35, 5.45}, {5.05, 5.00, 4.95}, {5.50, 5.50, 5.40}, {5.45, 5.55, 5.50},
                                {5.55, 5.55, 5.35}, {5.45, 5.50, 5.55}, {5.50, 5.45, 5.25}, {5.65, 5.60, 5.40},
                                {5.70, 5.65, 5.55}, {6.30, 6.30, 6.25}};
  const RankSummary summary = rankSummary(times);
  EXPECT_NEAR(summary.friedman.chiSquare, 11.1429, 5e-5);
  EXPECT_NEAR(summary.friedman.chiSquareP, 0.003805, 5e-7);
  // F = (n − 1)·χ²/(n(k − 1) − χ²).
  EXPECT_NEAR(summary.friedman.f, 21 * 11.142857 / (44 - 11.142857), 1e-5);
  EXPECT_EQ(summary.inputs, 22U);
}

// Demšar 2006, section 3.2.2: four classifiers on 14 data sets (table 6), by area under the curve: mean ranks 3.143,
// 2.000, 2.893, 1.964, χ² = 9.28, critical difference 1.25 at 0.05 and 1.12 at 0.10. The last but one row is printed
// with 0.975 twice, but its ranks are 2 and 3.
TEST(Friedman, AgreesWithAPublishedComparison) {
  CriterionTable areas = {{0.763, 0.768, 0.771, 0.798}, {0.599, 0.591, 0.590, 0.569}, {0.954, 0.971, 0.968, 0.967},
                          {0.628, 0.661, 0.654, 0.657}, {0.882, 0.888, 0.886, 0.898}, {0.936, 0.931, 0.916, 0.931},
                          {0.661, 0.668, 0.609, 0.685}, {0.583, 0.583, 0.563, 0.625}, {0.775, 0.838, 0.866, 0.875},
                          {1.000, 1.000, 1.000, 1.000}, {0.940, 0.962, 0.965, 0.962}, {0.619, 0.666, 0.614, 0.669},
                          {0.972, 0.981, 0.975, 0.974}, {0.957, 0.978, 0.946, 0.970}};
  for (auto& row : areas) {
    for (double& value : row) value = -value;  // there larger is better
  }
  const RankSummary summary = rankSummary(areas);
  constexpr std::array kMeanRanks = {3.143, 2.000, 2.893, 1.964};
  for (std::size_t j = 0; j < 4; ++j) EXPECT_NEAR(summary.meanRanks[j], kMeanRanks[j], 6e-4) << j;
  // The paper does not correct for ties.
  double squares = 0;
  for (const double rank : summary.meanRanks) squares += rank * rank;
  const double uncorrected = 12.0 * 14 / 20 * (squares - 25);
  EXPECT_NEAR(uncorrected, 9.28, 0.006);
  constexpr double kTied = 3 * (8 - 2) + (64 - 4);  // Σ (t³ − t): three pairs and one of four
  EXPECT_NEAR(summary.friedman.chiSquare, uncorrected / (1 - kTied / (14.0 * 60)), 1e-9);
  EXPECT_NEAR(summary.criticalDifference05, 1.25, 0.006);
  EXPECT_NEAR(summary.criticalDifference10, 1.12, 0.006);
}

TEST(Friedman, SeesNoDifferenceInTiesAndACertainOneInOneOrder) {
  const RankSummary tied = rankSummary({{1, 1, 1}, {2, 2, 2}});
  EXPECT_EQ(tied.friedman.chiSquare, 0);
  EXPECT_EQ(tied.friedman.chiSquareP, 1);
  // The largest χ² is n(k − 1).
  const RankSummary same = rankSummary({{1, 2, 3}, {4, 5, 6}, {1, 5, 9}});
  EXPECT_NEAR(same.friedman.chiSquare, 6, 1e-12);
  EXPECT_TRUE(std::isinf(same.friedman.f));
  EXPECT_EQ(same.friedman.fP, 0);
}

TEST(RankSummary, CountsAddUp) {
  const RankSummary summary = rankSummary({{1, 2, 3}, {2, 1, 3}, {kFailed, 1, 2}, {1, 1, 2}});
  EXPECT_THAT(summary.counts, ElementsAre(ElementsAre(2, 1, 1), ElementsAre(3, 1, 0), ElementsAre(0, 1, 3)));
  EXPECT_THAT(summary.failures, ElementsAre(1, 0, 0));
  EXPECT_THAT(summary.meanRanks, ElementsAre(7.5 / 4, 5.5 / 4, 11.0 / 4));
  EXPECT_THROW(rankSummary({}), UsageError);
  EXPECT_THROW(rankSummary({{1}}), UsageError);
  EXPECT_THROW(rankSummary({{1, 2}, {1}}), UsageError);
}

TEST(PairedRatio, CountsSignsAndInterpolatesQuartiles) {
  const PairedRatio ratio =
      pairedRatio(std::array{1.0, 2.0, 3.0, 8.0, kFailed, 5.0}, std::array{2.0, 2.0, 2.0, 2.0, 1.0, kFailed});
  EXPECT_EQ(ratio.inputs, 4U);  // 0.5, 1, 1.5, 4
  EXPECT_DOUBLE_EQ(ratio.mean, 1.75);
  EXPECT_DOUBLE_EQ(ratio.lowerQuartile, 0.875);
  EXPECT_DOUBLE_EQ(ratio.median, 1.25);
  EXPECT_DOUBLE_EQ(ratio.upperQuartile, 2.125);
  EXPECT_EQ(ratio.better, 1U);
  EXPECT_EQ(ratio.equal, 1U);
  EXPECT_EQ(ratio.worse, 2U);
  EXPECT_TRUE(std::isnan(pairedRatio({}, {}).median));
}

}  // namespace
}  // namespace voroform::pipeline
