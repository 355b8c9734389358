#include "voroform/metrics/regularity.hpp"

#include <algorithm>
#include <cmath>

namespace voroform::metrics {

namespace {

constexpr double kHistogramMin = 0.078;
constexpr double kHistogramMax = 0.128;
constexpr std::size_t kHistogramBins = 50;

RegularityStatistics statistics(std::vector<double> values, double optimal) {
  RegularityStatistics result;
  result.histogram.assign(kHistogramBins, 0);
  result.cells = static_cast<Index>(values.size());
  if (values.empty()) return result;
  double sum = 0;
  double squares = 0;
  for (const double value : values) {
    sum += value;
    squares += (value - optimal) * (value - optimal);
    const double bin = (value - kHistogramMin) / (kHistogramMax - kHistogramMin) * static_cast<double>(kHistogramBins);
    // The comparison also sends a value that is not a number to the last bin.
    const std::size_t index =
        bin < static_cast<double>(kHistogramBins) ? static_cast<std::size_t>(std::max(bin, 0.0)) : kHistogramBins - 1;
    ++result.histogram[index];
  }
  const auto count = static_cast<double>(values.size());
  result.mean = sum / count;
  result.rmse = std::sqrt(squares / count);
  std::sort(values.begin(), values.end(),
            [](double a, double b) { return a < b || (std::isnan(b) && !std::isnan(a)); });
  result.max = values.back();
  const std::size_t middle = values.size() / 2;
  result.median = values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
  return result;
}

Regularity regularity(std::span<const double> values, std::span<const std::uint8_t> onBoundary, double optimal) {
  std::vector<double> interior;
  std::vector<double> boundary;
  for (std::size_t cell = 0; cell < onBoundary.size(); ++cell) {
    (onBoundary[cell] != 0 ? boundary : interior).push_back(values[cell]);
  }
  return {optimal, statistics({values.begin(), values.end()}, optimal), statistics(std::move(interior), optimal),
          statistics(std::move(boundary), optimal)};
}

}  // namespace

std::vector<double> regularities(std::span<const mesh::CellMoments> moments) {
  std::vector<double> values;
  values.reserve(moments.size());
  for (const mesh::CellMoments& cell : moments) {
    values.push_back(dimensionlessSecondMoment<3>(cell.secondMoment, cell.volume, std::cbrt(cell.volume)));
  }
  return values;
}

std::vector<double> regularities(std::span<const mesh::PlanarCellMoments> moments) {
  std::vector<double> values;
  values.reserve(moments.size());
  for (const mesh::PlanarCellMoments& cell : moments) {
    values.push_back(dimensionlessSecondMoment<2>(cell.secondMoment, cell.area, std::sqrt(cell.area)));
  }
  return values;
}

Regularity regularity(const mesh::PolyhedralComplex& complex, std::span<const double> values) {
  std::vector<std::uint8_t> onBoundary(static_cast<std::size_t>(complex.cellCount), 0);
  for (Index f = 0; f < complex.faceCount(); ++f) {
    if (complex.isBoundary(f))
      onBoundary[static_cast<std::size_t>(complex.faceCells[static_cast<std::size_t>(f)][0])] = 1;
  }
  return regularity(values, onBoundary, kOptimalRegularity<3>);
}

Regularity planarRegularity(std::span<const double> values, std::span<const std::uint8_t> onBoundary) {
  return regularity(values, onBoundary, kOptimalRegularity<2>);
}

}  // namespace voroform::metrics
