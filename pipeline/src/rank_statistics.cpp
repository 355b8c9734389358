#include "voroform/pipeline/rank_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/tools/toms748_solve.hpp>

#include "voroform/core/error.hpp"

namespace voroform::pipeline {

namespace {

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

double normalDensity(double z) { return std::exp(-0.5 * z * z) * (std::numbers::inv_sqrtpi / std::numbers::sqrt2); }
double normalProbability(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

// Failures alike, and behind all else.
double comparable(double value) { return std::isfinite(value) ? value : std::numeric_limits<double>::infinity(); }

}  // namespace

std::vector<double> averageRanks(std::span<const double> values) {
  std::vector<double> ranks(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::size_t below = 0;
    std::size_t equal = 0;
    for (const double other : values) {
      if (comparable(other) < comparable(values[i])) ++below;
      if (comparable(other) == comparable(values[i])) ++equal;
    }
    ranks[i] = static_cast<double>(below) + 0.5 * static_cast<double>(equal + 1);
  }
  return ranks;
}

std::vector<std::size_t> places(std::span<const double> values) {
  std::vector<std::size_t> result(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      result[i] = values.size();
      continue;
    }
    result[i] = 1 + static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [&](double other) {
                  return std::isfinite(other) && other < values[i];
                }));
  }
  return result;
}

FriedmanTest friedmanTest(const std::vector<std::vector<double>>& ranks) {
  const auto n = static_cast<double>(ranks.size());
  const std::size_t methods = ranks.front().size();
  const auto k = static_cast<double>(methods);
  std::vector<double> sums(methods, 0.0);
  double squares = 0;
  for (const std::vector<double>& row : ranks) {
    for (std::size_t j = 0; j < methods; ++j) {
      sums[j] += row[j];
      squares += row[j] * row[j];
    }
  }
  // Conover 1999, Practical Nonparametric Statistics, section 5.8: the form that holds with ties.
  double between = 0;
  for (const double sum : sums) between += (sum - 0.5 * n * (k + 1)) * (sum - 0.5 * n * (k + 1));
  const double spread = squares - 0.25 * n * k * (k + 1) * (k + 1);
  FriedmanTest test;
  if (!(spread > 0)) return test;  // all tied everywhere: no difference
  test.chiSquare = (k - 1) * between / spread;
  test.chiSquareP = boost::math::cdf(boost::math::complement(boost::math::chi_squared(k - 1), test.chiSquare));
  const double rest = n * (k - 1) - test.chiSquare;
  if (n < 2) {
    test.f = kUndefined;  // no degrees of freedom are left
    test.fP = kUndefined;
  } else if (rest <= 1e-12 * n * (k - 1)) {
    test.f = std::numeric_limits<double>::infinity();
    test.fP = 0;
  } else {
    test.f = (n - 1) * test.chiSquare / rest;
    test.fP = boost::math::cdf(boost::math::complement(boost::math::fisher_f(k - 1, (k - 1) * (n - 1)), test.f));
  }
  return test;
}

double studentizedRangeProbability(double q, std::size_t k) {
  if (!(q > 0)) return 0;
  // The density is below 1e-17 beyond 9.
  constexpr double kEnd = 9;
  const auto integrand = [q, k](double z) {
    return normalDensity(z) * std::pow(normalProbability(z) - normalProbability(z - q), static_cast<double>(k - 1));
  };
  using Quadrature = boost::math::quadrature::gauss_kronrod<double, 61>;
  return std::min(1.0, static_cast<double>(k) * Quadrature::integrate(integrand, -kEnd, kEnd, 8, 1e-13));
}

double studentizedRangeQuantile(double probability, std::size_t k) {
  if (!(probability > 0 && probability < 1)) throw UsageError("probability: must lie in (0, 1)");
  if (k < 2) throw UsageError("a range needs at least two variables");
  const auto excess = [&](double q) { return studentizedRangeProbability(q, k) - probability; };
  double high = 4;
  while (excess(high) < 0 && high < 64) high *= 2;
  std::uintmax_t iterations = 100;
  const auto bracket =
      boost::math::tools::toms748_solve(excess, 0.0, high, boost::math::tools::eps_tolerance<double>(40), iterations);
  return 0.5 * (bracket.first + bracket.second);
}

double nemenyiQuantile(double alpha, std::size_t k) {
  return studentizedRangeQuantile(1 - alpha, k) / std::numbers::sqrt2;
}

RankSummary rankSummary(const CriterionTable& table) {
  if (table.empty()) throw UsageError("ranks need at least one input");
  const std::size_t methods = table.front().size();
  if (methods < 2) throw UsageError("ranks need at least two methods");
  RankSummary summary;
  summary.inputs = table.size();
  summary.counts.assign(methods, std::vector<std::size_t>(methods, 0));
  summary.failures.assign(methods, 0);
  summary.meanRanks.assign(methods, 0.0);
  std::vector<std::vector<double>> ranks;
  for (const std::vector<double>& row : table) {
    if (row.size() != methods) throw UsageError("ranks need a value of every method for every input");
    ranks.push_back(averageRanks(row));
    const std::vector<std::size_t> rowPlaces = places(row);
    for (std::size_t j = 0; j < methods; ++j) {
      ++summary.counts[j][rowPlaces[j] - 1];
      if (!std::isfinite(row[j])) ++summary.failures[j];
      summary.meanRanks[j] += ranks.back()[j];
    }
  }
  const auto n = static_cast<double>(table.size());
  for (double& rank : summary.meanRanks) rank /= n;
  summary.friedman = friedmanTest(ranks);
  const auto k = static_cast<double>(methods);
  const double unit = std::sqrt(k * (k + 1) / (6 * n));
  summary.criticalDifference05 = nemenyiQuantile(0.05, methods) * unit;
  summary.criticalDifference10 = nemenyiQuantile(0.10, methods) * unit;
  return summary;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return kUndefined;
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(place);
  if (low + 1 >= values.size()) return values.back();
  const double part = place - static_cast<double>(low);
  return part == 0 ? values[low] : values[low] + part * (values[low + 1] - values[low]);
}

PairedRatio pairedRatio(std::span<const double> values, std::span<const double> reference) {
  PairedRatio result;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i]) || !std::isfinite(reference[i])) continue;
    ++(values[i] < reference[i] ? result.better : values[i] > reference[i] ? result.worse : result.equal);
    if (reference[i] != 0) ratios.push_back(values[i] / reference[i]);
  }
  result.inputs = ratios.size();
  result.mean = ratios.empty()
                    ? kUndefined
                    : std::accumulate(ratios.begin(), ratios.end(), 0.0) / static_cast<double>(ratios.size());
  result.lowerQuartile = quantile(ratios, 0.25);
  result.median = quantile(ratios, 0.5);
  result.upperQuartile = quantile(ratios, 0.75);
  return result;
}

}  // namespace voroform::pipeline
