#include "voroform/mesh/box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace voroform::mesh {

namespace {

constexpr std::uint32_t kLeafSize = 4;

}  // namespace

BoxTree::BoxTree(std::span<const Box3> boxes) : order_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(order_.begin(), order_.end(), Index{0});
  nodes_.reserve(boxes.size());
  build(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
  boxes_.reserve(boxes.size());
  for (const Index i : order_) boxes_.push_back(boxes[static_cast<std::size_t>(i)]);
}

void BoxTree::build(std::span<const Box3> boxes, std::uint32_t begin, std::uint32_t end) {
  const std::size_t position = nodes_.size();
  nodes_.emplace_back();
  Box3 box;
  Box3 centers;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Box3& member = boxes[static_cast<std::size_t>(order_[i])];
    box.extend(member);
    centers.extend(Vec3(member.min() + member.max()));
  }
  nodes_[position].box = box;
  if (end - begin <= kLeafSize) {
    nodes_[position].first = begin;
    nodes_[position].count = end - begin;
    return;
  }
  Eigen::Index axis = 0;
  centers.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [&](Index a, Index b) {
    const Box3& first = boxes[static_cast<std::size_t>(a)];
    const Box3& second = boxes[static_cast<std::size_t>(b)];
    const double left = first.min()[axis] + first.max()[axis];
    const double right = second.min()[axis] + second.max()[axis];
    return left < right || (left == right && a < b);
  });
  build(boxes, begin, middle);
  nodes_[position].first = static_cast<std::uint32_t>(nodes_.size());
  build(boxes, middle, end);
}

}  // namespace voroform::mesh
