// Which points lie near a given place: a hash of the occupied cubes of a grid.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::metrics {

// Built in O(n log n). Space and time don't depend on the extent of the points, so sets that fill little of their
// bounding box, as samples of surfaces do, cost no more than others. Safe to query from many threads at once.
class PointGrid {
 public:
  // `edge` > 0 is the cubes' edge; queries of about half that radius are the fastest. The points must outlive the grid.
  PointGrid(std::span<const Vec3> points, double edge);

  // Calls visit(index, squared distance) for the points within `radius` of p, in an order that depends on the grid.
  template <class Visit>
  void forEachWithin(const Vec3& p, double radius, const Visit& visit) const {
    const double limit = radius * radius;
    const auto visitRange = [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t k = begin; k < end; ++k) {
        const double squaredDistance = (positions_[k] - p).squaredNorm();
        if (squaredDistance <= limit) visit(order_[k], squaredDistance);
      }
    };
    if (lookUps(radius) > static_cast<double>(order_.size())) {
      visitRange(0, static_cast<std::uint32_t>(order_.size()));
      return;
    }
    const auto low = cellOf(p - Vec3::Constant(radius));
    const auto high = cellOf(p + Vec3::Constant(radius));
    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        for (std::int64_t x = low[0]; x <= high[0]; ++x) {
          const Slot* slot = find(keyOf({x, y, z}));
          if (slot != nullptr) visitRange(slot->begin, slot->end);
        }
      }
    }
  }

  // The nearest to p of the points within `reach` that accept(index) lets pass, the lowest index of those equally near;
  // kNone if there is none. `radius` > 0 is a guess of its distance.
  template <class Accept>
  Index nearest(const Vec3& p, double radius, double reach, const Accept& accept) const {
    for (radius = std::min(radius, reach);; radius = std::min(2 * radius, reach)) {
      // A search that looks at all points need not be repeated with a larger radius.
      const bool last = radius >= reach || lookUps(radius) > static_cast<double>(order_.size());
      std::pair<double, Index> best(std::numeric_limits<double>::infinity(), kNone);
      forEachWithin(p, last ? reach : radius, [&](Index i, double squaredDistance) {
        if (std::pair(squaredDistance, i) < best && accept(i)) best = {squaredDistance, i};
      });
      if (best.second != kNone || last) return best.second;
    }
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Slot {
    std::uint64_t key = kFree;
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
  };
  static constexpr std::uint64_t kFree = ~std::uint64_t{0};
  static constexpr std::int64_t kCellsPerAxis = std::int64_t{1} << 20U;

  double lookUps(double radius) const {
    const double perAxis = 2 * radius / edge_ + 1;
    return perAxis * perAxis * perAxis;
  }
  Cell cellOf(const Vec3& p) const {
    Cell cell{};
    for (Index axis = 0; axis < 3; ++axis) {
      const double place = std::floor((p[axis] - origin_[axis]) / edge_);
      cell[static_cast<std::size_t>(axis)] =
          static_cast<std::int64_t>(std::clamp(place, 0.0, static_cast<double>(kCellsPerAxis)));
    }
    return cell;
  }
  static std::uint64_t keyOf(const Cell& cell) {
    return static_cast<std::uint64_t>(cell[2]) << 42U | static_cast<std::uint64_t>(cell[1]) << 21U |
           static_cast<std::uint64_t>(cell[0]);
  }
  std::size_t hash(std::uint64_t key) const {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> shift_);
  }
  const Slot* find(std::uint64_t key) const {
    for (std::size_t i = hash(key);; i = (i + 1) & (slots_.size() - 1)) {
      if (slots_[i].key == key) return &slots_[i];
      if (slots_[i].key == kFree) return nullptr;
    }
  }

  Vec3 origin_ = Vec3::Zero();
  double edge_ = 1;
  unsigned shift_ = 60;
  std::vector<Slot> slots_;
  std::vector<Index> order_;
  std::vector<Vec3> positions_;  // in the order of order_
};

}  // namespace voroform::metrics
