#include "voroform/baselines/cube_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "lattice.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::baselines {

namespace {

// Points along the longest side of the form's bounds among which the solid is looked for; the second count if the first
// finds nothing.
constexpr Index kCoarse[] = {64, 256};
// The search for the outermost points ends at steps this share of the longest side: well under a thousandth.
constexpr double kFinestStep = 1.0 / 4096;
// The outermost points from which each step of the search departs.
constexpr std::size_t kFront = 64;
constexpr Index kMostCubes = 100000;
// Cubes along a side are not added for a remainder that is rounding.
constexpr double kRounding = 1e-9;

using Node = std::array<std::int64_t, 3>;

// A lattice over the form's bounds, and which of its points are inside.
struct CoarseSearch {
  Lattice lattice;
  std::vector<Node> inside;
};

CoarseSearch searchCoarsely(const implicit::ImplicitFunction& f, const Box3& bounds, Index count,
                            const RunContext& context) {
  CoarseSearch search;
  Lattice& lattice = search.lattice;
  lattice.spacing = bounds.sizes().maxCoeff() / static_cast<double>(count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    lattice.counts[axis] =
        std::max<Index>(1, static_cast<Index>(std::ceil(bounds.sizes()[a] / lattice.spacing - kRounding)));
    const double covered = lattice.spacing * static_cast<double>(lattice.counts[axis] - 1);
    lattice.origin[a] = bounds.center()[a] - 0.5 * covered;
  }
  std::int64_t evaluations = 0;
  const std::vector<double> values = latticeValues(f, lattice, 0, context, evaluations);
  for (Index k = 0; k < lattice.counts[2]; ++k) {
    for (Index j = 0; j < lattice.counts[1]; ++j) {
      for (Index i = 0; i < lattice.counts[0]; ++i) {
        if (values[lattice.number(i, j, k)] < 0) search.inside.push_back({i, j, k});
      }
    }
  }
  return search;
}

// The outermost inside points along one direction, climbing from one to the next in ever smaller steps. Points are
// nodes of the lattice refined `levels` times, so that each is tried but once a step.
class Climb {
 public:
  Climb(const implicit::ImplicitFunction& f, const CoarseSearch& search, int levels, std::size_t side)
      : f_(f),
        lattice_(search.lattice),
        step_(std::int64_t{1} << levels),
        spacing_(search.lattice.spacing / static_cast<double>(step_)),
        axis_(side / 2),
        sign_(side % 2 == 0 ? -1 : 1),
        front_(search.inside) {
    keepFront();
    for (Node& node : front_) {
      for (std::int64_t& coordinate : node) coordinate *= step_;
    }
  }

  double outermost() {
    for (; step_ > 1; step_ /= 2) {
      while (advance(step_ / 2)) {
      }
    }
    return point(front_.front())[static_cast<Eigen::Index>(axis_)];
  }

 private:
  Vec3 point(const Node& node) const {
    return lattice_.origin +
           spacing_ * Vec3(static_cast<double>(node[0]), static_cast<double>(node[1]), static_cast<double>(node[2]));
  }

  // Keeps the kFront nodes farthest along the direction.
  void keepFront() {
    const auto before = [&](const Node& a, const Node& b) {
      return a[axis_] != b[axis_] ? sign_ * a[axis_] > sign_ * b[axis_] : a < b;
    };
    const std::size_t most = 32 * kFront;  // more than one step can add
    if (front_.size() > most) {
      std::nth_element(front_.begin(), front_.begin() + static_cast<std::ptrdiff_t>(most), front_.end(), before);
      front_.resize(most);
    }
    std::sort(front_.begin(), front_.end(), before);
    front_.erase(std::unique(front_.begin(), front_.end()), front_.end());
    if (front_.size() > kFront) front_.resize(kFront);
  }

  // One step from each node of the front, level or outward; whether the front came farther out.
  bool advance(std::int64_t step) {
    const std::int64_t reached = front_.front()[axis_];
    std::vector<Node> tried;
    for (const Node& node : front_) {
      for (int n = 0; n < 27; ++n) {
        const Node offset = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        if (sign_ * offset[axis_] < 0 || n == 13) continue;
        Node next = node;
        // Sideways twice as far as outward: a blunt corner's flanks are nearly level.
        for (std::size_t a = 0; a < 3; ++a) next[a] += (a == axis_ ? 1 : 2) * step * offset[a];
        tried.push_back(next);
      }
    }
    std::vector<Vec3> points;
    for (const Node& node : tried) points.push_back(point(node));
    std::vector<double> values(tried.size());
    f_.values(points, values);
    for (std::size_t i = 0; i < tried.size(); ++i) {
      if (values[i] < 0) front_.push_back(tried[i]);
    }
    keepFront();
    return front_.front()[axis_] != reached;
  }

  const implicit::ImplicitFunction& f_;
  const Lattice& lattice_;
  std::int64_t step_;
  double spacing_;
  std::size_t axis_;
  std::int64_t sign_;
  std::vector<Node> front_;
};

}  // namespace

Box3 solidBox(const implicit::ImplicitFunction& f, const RunContext& context) {
  const Box3 bounds = f.bounds();
  if (bounds.isEmpty() || !bounds.sizes().allFinite() || !(bounds.sizes().maxCoeff() > 0)) {
    throw MethodError("the form has no inside: its bounds are empty");
  }
  CoarseSearch search;
  for (const Index count : kCoarse) {
    if (search.inside.empty()) search = searchCoarsely(f, bounds, count, context);
  }
  if (search.inside.empty()) {
    throw MethodError("no inside point of the form was found on a grid of " + std::to_string(kCoarse[1]) +
                      " points along its bounds: is the solid empty or thinner than that?");
  }
  Box3 found;
  for (const auto& [i, j, k] : search.inside) {
    found.extend(search.lattice.point(static_cast<Index>(i), static_cast<Index>(j), static_cast<Index>(k)));
  }
  const double size = found.sizes().maxCoeff() + search.lattice.spacing;
  const int levels = std::max(1, static_cast<int>(std::ceil(std::log2(search.lattice.spacing / (kFinestStep * size)))));
  std::array<double, 6> sides{};
  parallelFor(context, 6, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t side = begin; side < end; ++side) sides[side] = Climb(f, search, levels, side).outermost();
  });
  return {Vec3(sides[0], sides[2], sides[4]), Vec3(sides[1], sides[3], sides[5])};
}

CubeGrid gridOf(const Box3& solidBox, Index resolution) {
  if (resolution < 2 || resolution > kMostCubes) {
    throw UsageError("resolution: between 2 and " + std::to_string(kMostCubes) + " cubes are possible, found " +
                     std::to_string(resolution));
  }
  if (solidBox.isEmpty() || !solidBox.sizes().allFinite() || !(solidBox.sizes().maxCoeff() > 0)) {
    throw UsageError("the solid's box must be finite and not empty");
  }
  CubeGrid grid;
  grid.edge = solidBox.sizes().maxCoeff() / static_cast<double>(resolution);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const double cubes = std::ceil(solidBox.sizes()[a] / grid.edge - kRounding);
    grid.cubes[axis] = std::max<Index>(1, static_cast<Index>(cubes)) + 2;
    grid.origin[a] = solidBox.center()[a] - 0.5 * grid.edge * static_cast<double>(grid.cubes[axis]);
  }
  return grid;
}

Index insideCubes(const implicit::ImplicitFunction& f, const CubeGrid& grid, const RunContext& context) {
  const Lattice centers{grid.corner(0, 0, 0) + Vec3::Constant(0.5 * grid.edge), grid.edge, grid.cubes};
  std::int64_t evaluations = 0;
  const std::vector<double> values = latticeValues(f, centers, 0, context, evaluations);
  return static_cast<Index>(std::count_if(values.begin(), values.end(), [](double value) { return value < 0; }));
}

}  // namespace voroform::baselines
