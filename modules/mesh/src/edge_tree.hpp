// A tree over the edges of polygons, in the edges' own order: runs of a ring are compact, so no sorting is needed.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <vector>

#include "voroform/core/types.hpp"
#include "voroform/mesh/planar_region.hpp"

namespace voroform::mesh {

struct RingEdge {
  Vec2 from;
  Vec2 to;
};

inline double squaredDistance(const RingEdge& edge, const Vec2& p) {
  const Vec2 along = edge.to - edge.from;
  const Vec2 toPoint = p - edge.from;
  const double t = std::clamp(along.dot(toPoint) / along.squaredNorm(), 0.0, 1.0);
  return (toPoint - t * along).squaredNorm();
}

class RingEdgeTree {
 public:
  explicit RingEdgeTree(std::vector<RingEdge> edges)
      : edges_(std::move(edges)), leaves_(std::bit_ceil((edges_.size() + kLeafEdges - 1) / kLeafEdges)) {
    boxes_.resize(2 * leaves_);
    for (std::size_t k = 0; k < edges_.size(); ++k) {
      boxes_[leaves_ + k / kLeafEdges].extend(edges_[k].from).extend(edges_[k].to);
    }
    for (std::size_t node = leaves_ - 1; node > 0; --node) boxes_[node] = boxes_[2 * node].merged(boxes_[2 * node + 1]);
  }

  std::span<const RingEdge> edges() const { return edges_; }
  const Box2& bounds() const { return boxes_[1]; }

  // Calls visit(edge's number) in ascending order for the edges of all leaves whose boxes, and their parents', pass
  // enter(box).
  template <class Enter, class Visit>
  void forEachEdge(const Enter& enter, const Visit& visit) const {
    std::array<std::size_t, kMaxDepth> stack;
    std::size_t depth = 0;
    stack[depth++] = 1;
    while (depth > 0) {
      const std::size_t node = stack[--depth];
      if (!enter(boxes_[node])) continue;
      if (node < leaves_) {
        stack[depth++] = 2 * node + 1;
        stack[depth++] = 2 * node;
        continue;
      }
      const std::size_t begin = (node - leaves_) * kLeafEdges;
      for (std::size_t k = begin; k < std::min(begin + kLeafEdges, edges_.size()); ++k) visit(k);
    }
  }

  double squaredDistance(const Vec2& p) const {
    struct Entry {
      std::size_t node;
      double lowerBound;
    };
    std::array<Entry, kMaxDepth> stack;
    std::size_t depth = 0;
    stack[depth++] = {1, 0};
    double best = std::numeric_limits<double>::infinity();
    while (depth > 0) {
      const Entry entry = stack[--depth];
      if (!(entry.lowerBound < best)) continue;
      if (entry.node < leaves_) {
        Entry near{2 * entry.node, boxes_[2 * entry.node].squaredExteriorDistance(p)};
        Entry far{2 * entry.node + 1, boxes_[2 * entry.node + 1].squaredExteriorDistance(p)};
        if (far.lowerBound < near.lowerBound) std::swap(near, far);
        stack[depth++] = far;
        stack[depth++] = near;
        continue;
      }
      const std::size_t begin = (entry.node - leaves_) * kLeafEdges;
      for (std::size_t k = begin; k < std::min(begin + kLeafEdges, edges_.size()); ++k) {
        best = std::min(best, mesh::squaredDistance(edges_[k], p));
      }
    }
    return best;
  }

 private:
  static constexpr std::size_t kLeafEdges = 4;
  static constexpr std::size_t kMaxDepth = 64;

  std::vector<RingEdge> edges_;
  std::size_t leaves_;
  std::vector<Box2> boxes_;  // the root is 1, the children of i are 2i and 2i + 1; leaves follow the inner nodes
};

}  // namespace voroform::mesh
