// Statistics over ranks of several methods on many inputs (Friedman 1937; Iman and Davenport 1980; Nemenyi 1963), as
// Demšar 2006, "Statistical comparisons of classifiers over multiple data sets", recommends them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace voroform::pipeline {

// Values of one criterion: one row an input, one column a method; smaller is better. A value that is NaN or infinite
// stands for a failure: it comes behind all finite ones.
using CriterionTable = std::vector<std::vector<double>>;

// Ranks from 1 (smallest); values that are equal share the mean of their ranks, and so do failures.
std::vector<double> averageRanks(std::span<const double> values);
// Places from 1: one more than the number of methods that are better; equal values share the better place. A failure
// has the last place.
std::vector<std::size_t> places(std::span<const double> values);

struct FriedmanTest {
  double chiSquare = 0;  // with the correction for ties; k − 1 degrees of freedom
  double chiSquareP = 1;
  // Iman and Davenport's F, less conservative; k − 1 and (k − 1)(n − 1) degrees of freedom. Infinite if all inputs give
  // the same order.
  double f = 0;
  double fP = 1;
};

// Rank statistics of k methods over n inputs.
struct RankSummary {
  std::size_t inputs = 0;
  std::vector<std::vector<std::size_t>> counts;  // [method][place − 1]: how often; each row adds up to n
  std::vector<std::size_t> failures;             // [method]
  std::vector<double> meanRanks;                 // [method]
  FriedmanTest friedman;
  // Mean ranks that differ by at least this are significantly different: q_α·√(k(k + 1)/(6n)).
  double criticalDifference05 = 0;
  double criticalDifference10 = 0;
};

// Throws UsageError if there are fewer than two methods, no inputs, or rows of different lengths.
RankSummary rankSummary(const CriterionTable& table);

// The ranks [input][method] need no ties treated: see rankSummary. At least two methods and one input.
FriedmanTest friedmanTest(const std::vector<std::vector<double>>& ranks);

// P(Q ≤ q) of the studentized range of k ≥ 2 normal variables with infinite degrees of freedom.
double studentizedRangeProbability(double q, std::size_t k);
// Its quantile; probability in (0, 1).
double studentizedRangeQuantile(double probability, std::size_t k);
// Nemenyi's q_α of k methods: the studentized range's (1 − α) quantile divided by √2 (Demšar 2006, table 5).
double nemenyiQuantile(double alpha, std::size_t k);

// A method against a reference, input by input, where both finished.
struct PairedRatio {
  std::size_t inputs = 0;  // where both finished and the reference is not 0
  double mean = 0;         // of value/reference; NaN without inputs, as the next three
  double lowerQuartile = 0;
  double median = 0;
  double upperQuartile = 0;
  // Sign counts over all inputs where both finished.
  std::size_t better = 0;
  std::size_t equal = 0;
  std::size_t worse = 0;
};
PairedRatio pairedRatio(std::span<const double> values, std::span<const double> reference);

// Quantile of values by linear interpolation between order statistics (type 7 of Hyndman and Fan 1996); share in [0,
// 1]. NaN without values.
double quantile(std::vector<double> values, double share);

}  // namespace voroform::pipeline
