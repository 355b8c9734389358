#include "lattice.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "voroform/core/parallel.hpp"

namespace voroform::baselines {

namespace {

// Points are visited in cubes of this many a side, so that one question can settle a cube and neighbors in a list are
// neighbors in space.
constexpr Index kBlock = 8;
constexpr std::size_t kGrain = 8;
// Allowance for the rounding of points, relative to the lengths compared.
constexpr double kRounding = 1 + 1e-9;

double sureValue(double clearance) { return std::copysign(std::numeric_limits<double>::infinity(), clearance); }

struct Block {
  std::array<Index, 3> first;
  std::array<Index, 3> last;
};

// Fills in a block's values; returns the number of calls of f.
std::int64_t evaluateBlock(const implicit::ImplicitFunction& f, const Lattice& lattice, const Block& block,
                           double reach, std::vector<double>& values) {
  const auto& [first, last] = block;
  const Vec3 low = lattice.point(first[0], first[1], first[2]);
  const Vec3 high = lattice.point(last[0] - 1, last[1] - 1, last[2] - 1);
  const double coarse = f.clearance(0.5 * (low + high));
  const bool settled = std::abs(coarse) > kRounding * (reach + 0.5 * (high - low).norm());

  std::vector<std::size_t> numbers;
  std::vector<Vec3> points;
  for (Index k = first[2]; k < last[2]; ++k) {
    for (Index j = first[1]; j < last[1]; ++j) {
      const std::size_t row = lattice.number(first[0], j, k);
      if (settled) {
        std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(row), last[0] - first[0], sureValue(coarse));
        continue;
      }
      for (Index i = first[0]; i < last[0]; ++i) {
        numbers.push_back(row + static_cast<std::size_t>(i - first[0]));
        points.push_back(lattice.point(i, j, k));
      }
    }
  }
  if (settled) return 0;

  std::vector<double> clearances(points.size());
  f.clearances(points, clearances);
  std::size_t asked = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (std::abs(clearances[p]) > kRounding * reach) {
      values[numbers[p]] = sureValue(clearances[p]);
    } else {
      numbers[asked] = numbers[p];
      points[asked++] = points[p];
    }
  }
  points.resize(asked);
  clearances.resize(asked);
  f.values(points, clearances);
  for (std::size_t p = 0; p < asked; ++p) values[numbers[p]] = clearances[p];
  return static_cast<std::int64_t>(asked);
}

}  // namespace

std::vector<double> latticeValues(const implicit::ImplicitFunction& f, const Lattice& lattice, double reach,
                                  const RunContext& context, std::int64_t& evaluations) {
  std::vector<double> values(lattice.size());
  std::array<Index, 3> blocks{};
  for (std::size_t axis = 0; axis < 3; ++axis) blocks[axis] = (lattice.counts[axis] + kBlock - 1) / kBlock;
  const std::size_t layer = static_cast<std::size_t>(blocks[0]) * static_cast<std::size_t>(blocks[1]);
  const auto evaluateBlocks = [&](std::size_t begin, std::size_t end, std::int64_t calls) {
    for (std::size_t b = begin; b < end; ++b) {
      const std::array<std::size_t, 3> place = {b % static_cast<std::size_t>(blocks[0]),
                                                b % layer / static_cast<std::size_t>(blocks[0]), b / layer};
      Block block{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        block.first[axis] = kBlock * static_cast<Index>(place[axis]);
        block.last[axis] = std::min(block.first[axis] + kBlock, lattice.counts[axis]);
      }
      calls += evaluateBlock(f, lattice, block, reach, values);
    }
    return calls;
  };
  evaluations += parallelReduce(context, layer * static_cast<std::size_t>(blocks[2]), kGrain, std::int64_t{0},
                                evaluateBlocks, std::plus<>());
  return values;
}

}  // namespace voroform::baselines
