// Disjoint sets of indices.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::mesh {

// With path halving; joins to the lower root, so that the roots do not depend on the order.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), Index{0}); }
  Index find(Index i) {
    while (at(i) != i) {
      at(i) = at(at(i));
      i = at(i);
    }
    return i;
  }
  // True if the two were apart.
  bool join(Index a, Index b) {
    a = find(a);
    b = find(b);
    if (a == b) return false;
    at(std::max(a, b)) = std::min(a, b);
    return true;
  }

 private:
  Index& at(Index i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<Index> parent_;
};

}  // namespace voroform::mesh
