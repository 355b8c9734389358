#include "neighbors.hpp"

#include <algorithm>
#include <cmath>

#include "kd_tree.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::points {

double medianSpacing(const std::vector<Vec3>& positions, const RunContext& context) {
  constexpr unsigned kNeighbors = 6;
  constexpr std::size_t kMostSamples = 100'000;
  constexpr std::size_t kGrain = 1024;
  const KdTree tree(positions);
  const std::size_t step = (positions.size() + kMostSamples - 1) / kMostSamples;
  std::vector<double> means((positions.size() + step - 1) / step);
  parallelFor(context, means.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double sum = 0;
      for (const auto& [neighbor, squaredDistance] : tree.search(i * step, kNeighbors + 1)) {
        sum += std::sqrt(squaredDistance);
      }
      means[i] = sum / kNeighbors;
    }
  });
  const auto middle = means.begin() + static_cast<std::ptrdiff_t>(means.size() / 2);
  std::nth_element(means.begin(), middle, means.end());
  return *middle;
}

}  // namespace voroform::points
