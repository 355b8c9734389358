#include "surface_cvt_grid.hpp"

namespace voroform::metrics {

PointGrid::PointGrid(std::span<const Vec3> points, double edge) {
  Box3 box;
  for (const Vec3& point : points) box.extend(point);
  if (!box.isEmpty()) origin_ = box.min();
  const double extent = box.isEmpty() ? 0 : box.sizes().maxCoeff();
  edge_ = std::max(edge, extent / static_cast<double>(kCellsPerAxis - 1));

  std::vector<std::pair<std::uint64_t, Index>> keyed(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) keyed[i] = {keyOf(cellOf(points[i])), static_cast<Index>(i)};
  std::sort(keyed.begin(), keyed.end());

  unsigned bits = 4;
  while ((std::size_t{1} << bits) < 2 * points.size()) ++bits;
  shift_ = 64 - bits;
  slots_.resize(std::size_t{1} << bits);
  order_.reserve(points.size());
  positions_.reserve(points.size());
  for (std::size_t begin = 0; begin < keyed.size();) {
    std::size_t end = begin;
    for (; end < keyed.size() && keyed[end].first == keyed[begin].first; ++end) {
      order_.push_back(keyed[end].second);
      positions_.push_back(points[static_cast<std::size_t>(keyed[end].second)]);
    }
    std::size_t slot = hash(keyed[begin].first);
    while (slots_[slot].key != kFree) slot = (slot + 1) & (slots_.size() - 1);
    slots_[slot] = {keyed[begin].first, static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
    begin = end;
  }
}

}  // namespace voroform::metrics
