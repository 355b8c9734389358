#include "surface_grid.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::cvt {

namespace {

constexpr std::size_t kGrain = 1 << 14;

// f at the nodes whose sign or whose edges' roots need it: elsewhere the oracle's clearance, which has the same sign.
std::vector<double> nodeValues(const implicit::ImplicitFunction& f, const NodeGrid& grid, const RunContext& context) {
  std::vector<double> values(grid.size());
  parallelFor(context, grid.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Vec3> points;
    for (std::size_t node = begin; node < end; ++node) points.push_back(grid.position(node));
    f.clearances(points, std::span(values).subspan(begin, end - begin));
    std::vector<std::size_t> asked;
    std::vector<Vec3> near;
    for (std::size_t node = begin; node < end; ++node) {
      if (std::abs(values[node]) > grid.spacing) continue;
      asked.push_back(node);
      near.push_back(points[node - begin]);
    }
    std::vector<double> answers(near.size());
    f.values(near, answers);
    for (std::size_t k = 0; k < asked.size(); ++k) values[asked[k]] = answers[k];
  });
  return values;
}

// Makes the crossings of the edges between neighbors, each nearest to its two nodes so far.
void findCrossings(const std::vector<double>& values, SurfaceGrid& surface) {
  const NodeGrid& grid = surface.grid;
  const auto offer = [&](std::size_t node, Index point) {
    Index& best = surface.nearest[node];
    const Vec3 p = grid.position(node);
    const auto squared = [&](Index i) { return (surface.points[static_cast<std::size_t>(i)] - p).squaredNorm(); };
    if (best == kNone || squared(point) < squared(best)) best = point;
  };
  for (std::size_t node = 0; node < values.size(); ++node) {
    const auto place = grid.coordinates(node);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (place[axis] + 1 == grid.counts[axis]) continue;
      const std::size_t next = node + grid.stride(axis);
      if ((values[node] < 0) == (values[next] < 0)) continue;
      const double t = values[node] / (values[node] - values[next]);
      surface.points.push_back(grid.position(node) + t * grid.spacing * Vec3::Unit(static_cast<Eigen::Index>(axis)));
      const auto point = static_cast<Index>(surface.points.size() - 1);
      offer(node, point);
      offer(next, point);
    }
  }
}

// Hands nearest points on from neighbors, along all eight directions of the grid's diagonals.
void sweep(SurfaceGrid& surface, const RunContext& context) {
  const NodeGrid& grid = surface.grid;
  std::vector<float> squared(grid.size(), std::numeric_limits<float>::infinity());
  const auto squaredDistance = [&](const Vec3& p, Index point) {
    return static_cast<float>((surface.points[static_cast<std::size_t>(point)] - p).squaredNorm());
  };
  for (std::size_t node = 0; node < grid.size(); ++node) {
    if (surface.nearest[node] != kNone) squared[node] = squaredDistance(grid.position(node), surface.nearest[node]);
  }
  const auto at = [](int step, int count, int k) { return step > 0 ? k : count - 1 - k; };
  for (int direction = 0; direction < 8; ++direction) {
    context.throwIfCancelled();
    const std::array<int, 3> steps = {direction & 1 ? -1 : 1, direction & 2 ? -1 : 1, direction & 4 ? -1 : 1};
    for (int k = 0; k < grid.counts[2]; ++k) {
      for (int j = 0; j < grid.counts[1]; ++j) {
        for (int i = 0; i < grid.counts[0]; ++i) {
          const std::array<int, 3> ahead = {i, j, k};
          std::size_t node = 0;
          Vec3 p = grid.origin;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const int c = at(steps[axis], grid.counts[axis], ahead[axis]);
            node += static_cast<std::size_t>(c) * grid.stride(axis);
            p[static_cast<Eigen::Index>(axis)] += grid.spacing * c;
          }
          for (std::size_t axis = 0; axis < 3; ++axis) {
            if (ahead[axis] == 0) continue;
            const std::size_t stride = grid.stride(axis);
            const Index candidate = surface.nearest[steps[axis] > 0 ? node - stride : node + stride];
            if (candidate == kNone || candidate == surface.nearest[node]) continue;
            const float distance = squaredDistance(p, candidate);
            if (distance < squared[node]) {
              squared[node] = distance;
              surface.nearest[node] = candidate;
            }
          }
        }
      }
    }
  }
}

}  // namespace

NodeGrid::NodeGrid(const Box3& box, double nodeSpacing)
    : origin(box.min() - Vec3::Constant(nodeSpacing)), spacing(nodeSpacing) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double length = box.sizes()[static_cast<Eigen::Index>(axis)];
    counts[axis] = static_cast<int>(std::ceil(length / spacing)) + 3;
  }
}

GridFunction::GridFunction(const NodeGrid& grid, std::vector<float> values)
    : grid_(grid),
      nodesPerUnit_(1 / grid.spacing),
      last_(grid.counts[0] - 1, grid.counts[1] - 1, grid.counts[2] - 1),
      rowStride_(grid.stride(1)),
      planeStride_(grid.stride(2)),
      values_(std::move(values)) {}

double GridFunction::operator()(const Vec3& p) const {
  const Vec3 place = (nodesPerUnit_ * (p - grid_.origin)).cwiseMax(0).cwiseMin(last_);
  const Eigen::Vector3i low = place.cwiseMin(last_ - Vec3::Ones()).cast<int>();
  const Vec3 t = place - low.cast<double>();
  const std::size_t node = static_cast<std::size_t>(low.z()) * planeStride_ +
                           static_cast<std::size_t>(low.y()) * rowStride_ + static_cast<std::size_t>(low.x());
  const float* first = &values_[node];
  const auto along = [&](std::size_t offset) {
    const auto a = static_cast<double>(first[offset]);
    return a + t.x() * (static_cast<double>(first[offset + 1]) - a);
  };
  const auto across = [&](std::size_t offset) {
    const double a = along(offset);
    return a + t.y() * (along(offset + rowStride_) - a);
  };
  const double a = across(0);
  return a + t.z() * (across(planeStride_) - a);
}

void GridFunction::smooth(int passes, const RunContext& context) {
  std::vector<float> before(values_.size());
  for (int pass = 0; pass < passes; ++pass) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::swap(before, values_);
      const std::size_t stride = grid_.stride(axis);
      parallelFor(context, values_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t node = begin; node < end; ++node) {
          const int place = grid_.coordinates(node)[axis];
          const float low = place > 0 ? before[node - stride] : before[node];
          const float high = place + 1 < grid_.counts[axis] ? before[node + stride] : before[node];
          values_[node] = 0.25F * (low + high) + 0.5F * before[node];
        }
      });
    }
  }
}

SurfaceGrid surfaceGrid(const implicit::ImplicitFunction& f, double spacing, const RunContext& context) {
  SurfaceGrid surface{NodeGrid(f.bounds(), spacing), {}, {}, {}};
  const std::vector<double> values = nodeValues(f, surface.grid, context);
  surface.inside.resize(values.size());
  for (std::size_t node = 0; node < values.size(); ++node) surface.inside[node] = values[node] < 0 ? 1 : 0;
  surface.nearest.assign(values.size(), kNone);
  findCrossings(values, surface);
  if (surface.points.empty()) {
    throw MethodError("the grid of the density meets no surface: the solid is empty or too thin; check the form");
  }
  sweep(surface, context);
  return surface;
}

}  // namespace voroform::cvt
