// The surface of an implicit form on a regular grid: for each node the nearest of the points where grid edges cross S.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::cvt {

struct NodeGrid {
  // Holds the box, with room for a node beyond each side.
  NodeGrid(const Box3& box, double nodeSpacing);

  Vec3 origin;
  double spacing;
  std::array<int, 3> counts;

  std::size_t size() const {
    return static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1]) *
           static_cast<std::size_t>(counts[2]);
  }
  std::size_t stride(std::size_t axis) const {
    std::size_t stride = 1;
    for (std::size_t a = 0; a < axis; ++a) stride *= static_cast<std::size_t>(counts[a]);
    return stride;
  }
  std::array<int, 3> coordinates(std::size_t node) const {
    const auto x = static_cast<std::size_t>(counts[0]);
    const auto y = static_cast<std::size_t>(counts[1]);
    return {static_cast<int>(node % x), static_cast<int>(node / x % y), static_cast<int>(node / (x * y))};
  }
  Vec3 position(std::size_t node) const {
    const auto [x, y, z] = coordinates(node);
    return origin + spacing * Vec3(x, y, z);
  }
};

// Trilinear between nodes; beyond the grid the value of the nearest point on it.
class GridFunction {
 public:
  GridFunction(const NodeGrid& grid, std::vector<float> values);
  double operator()(const Vec3& p) const;

  // Replaces values by means over neighbors with the weights ¼, ½, ¼ along each axis, `passes` times.
  void smooth(int passes, const RunContext& context);

 private:
  NodeGrid grid_;
  double nodesPerUnit_;
  Vec3 last_;  // the last node's coordinates
  std::size_t rowStride_;
  std::size_t planeStride_;
  std::vector<float> values_;
};

struct SurfaceGrid {
  NodeGrid grid;
  std::vector<std::uint8_t> inside;  // of each node: 1 where f < 0
  std::vector<Vec3> points;          // where edges of the grid cross S, by linear interpolation
  std::vector<Index> nearest;        // of each node, in `points`
};

// Throws MethodError if no edge crosses S. The nearest points come from sweeps over neighbors (Danielsson 1980), wrong
// in rare places by a small part of the spacing.
SurfaceGrid surfaceGrid(const implicit::ImplicitFunction& f, double spacing, const RunContext& context);

}  // namespace voroform::cvt
