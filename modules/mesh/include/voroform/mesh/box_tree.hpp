// A tree of bounding boxes: which of many boxes meet a given one.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::mesh {

// Built in O(n log n) whatever the boxes' distribution; queries take O(log n + found) on boxes that overlap little.
// Safe to query from many threads at once.
class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::span<const Box3> boxes);

  // Calls visit(index) for each box that meets `query`, borders included, in an order that depends on the tree alone.
  template <class Visit>
  void forEachOverlap(const Box3& query, const Visit& visit) const {
    if (nodes_.empty()) return;
    // The tree is halved by count, so its depth is at most 32.
    std::array<std::uint32_t, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::uint32_t position = stack[--depth];
      const Node& node = nodes_[position];
      if (!overlap(node.box, query)) continue;
      if (node.count == 0) {
        stack[depth++] = node.first;
        stack[depth++] = position + 1;
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        if (overlap(boxes_[i], query)) visit(order_[i]);
      }
    }
  }

 private:
  // A leaf holds the boxes first … first + count − 1; an inner node's children are the next node and node `first`.
  struct Node {
    Box3 box;
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  static bool overlap(const Box3& a, const Box3& b) {
    return a.min()[0] <= b.max()[0] && b.min()[0] <= a.max()[0] && a.min()[1] <= b.max()[1] &&
           b.min()[1] <= a.max()[1] && a.min()[2] <= b.max()[2] && b.min()[2] <= a.max()[2];
  }
  void build(std::span<const Box3> boxes, std::uint32_t begin, std::uint32_t end);

  std::vector<Node> nodes_;
  std::vector<Index> order_;
  std::vector<Box3> boxes_;  // in the order of order_
};

}  // namespace voroform::mesh
