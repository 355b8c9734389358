#include "voroform/mesh/closest_triangle.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace voroform::mesh {

namespace {

constexpr std::uint32_t kLeafSize = 4;
// Some dozen times the rounding of a coordinate.
constexpr double kRelativeSlack = 1e-14;
// Height over longest edge below which a triangle is examined by a method that stands cancellation, and below which its
// inside is not told from its edges.
constexpr double kThin = 1e-4;
constexpr double kFlat = 1e-11;

// All in coordinates relative to the query point.
struct Nearest {
  Vec3 point;
  int feature;
};

// Ericson, Real-Time Collision Detection (2005), section 5.1.5.
Nearest nearestOfTriangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const double d1 = -ab.dot(a);
  const double d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return {a, 4};
  const double d3 = -ab.dot(b);
  const double d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return {b, 5};
  const double d5 = -ab.dot(c);
  const double d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return {c, 6};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + d1 / (d1 - d3) * ab, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + d2 / (d2 - d6) * ac, 3};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), 2};
  const double scale = 1 / (va + vb + vc);
  return {a + ab * (vb * scale) + ac * (vc * scale), 0};
}

// By the normal and the three edges: exact up to rounding however thin the triangle is.
Nearest nearestOfThinTriangle(const std::array<Vec3, 3>& corners) {
  Nearest best{corners[0], 4};
  double bestSquared = std::numeric_limits<double>::infinity();
  const auto offer = [&](const Vec3& point, int feature) {
    const double squared = point.squaredNorm();
    if (!(squared < bestSquared)) return;
    bestSquared = squared;
    best = {point, feature};
  };
  double longest = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3& a = corners[static_cast<std::size_t>(i)];
    const Vec3& b = corners[static_cast<std::size_t>((i + 1) % 3)];
    const Vec3 ab = b - a;
    const double squared = ab.squaredNorm();
    longest = std::max(longest, squared);
    const double t = -ab.dot(a);
    if (!(t > 0)) {
      offer(a, 4 + i);
    } else if (!(t < squared)) {
      offer(b, 4 + (i + 1) % 3);
    } else {
      offer(a + t / squared * ab, 1 + i);
    }
  }
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (!(normal.norm() > kFlat * longest)) return best;
  const Vec3 foot = normal.dot(corners[0]) / normal.squaredNorm() * normal;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& a = corners[i];
    if (!((corners[(i + 1) % 3] - a).cross(foot - a).dot(normal) > 0)) return best;
  }
  offer(foot, 0);
  return best;
}

bool isThin(const std::array<Vec3, 3>& corners) {
  const Vec3 ab = corners[1] - corners[0];
  const Vec3 ac = corners[2] - corners[0];
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (corners[2] - corners[1]).squaredNorm()});
  return !(ab.cross(ac).norm() > kThin * longest);
}

std::array<float, 6> roundedOutward(const Box3& box) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::array<float, 6> result;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    const auto low = static_cast<float>(std::clamp(box.min()[axis], -kLargest, kLargest));
    const auto high = static_cast<float>(std::clamp(box.max()[axis], -kLargest, kLargest));
    const auto i = static_cast<std::size_t>(axis);
    result[i] = static_cast<double>(low) > box.min()[axis] ? std::nextafter(low, -kInfinity) : low;
    result[3 + i] = static_cast<double>(high) < box.max()[axis] ? std::nextafter(high, kInfinity) : high;
  }
  return result;
}

double squaredDistance(const std::array<float, 6>& box, const Vec3& p) {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = p[static_cast<Eigen::Index>(i)];
    const double beyond = std::max(0.0, std::max(static_cast<double>(box[i]) - x, x - static_cast<double>(box[3 + i])));
    sum += beyond * beyond;
  }
  return sum;
}

}  // namespace

ClosestTriangle::ClosestTriangle(const TriangleMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  if (count == 0) return;
  std::vector<Box3> boxes(count);
  Box3 all;
  for (std::uint32_t t = 0; t < count; ++t) {
    for (const Index v : mesh.triangles[t]) boxes[t].extend(mesh.vertices[static_cast<std::size_t>(v)]);
    all.extend(boxes[t]);
  }
  slack_ = kRelativeSlack * (all.diagonal().norm() + std::max(all.min().norm(), all.max().norm()));
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  nodes_.reserve(count / 2 + 1);
  if (count <= kLeafSize) {
    Node& root = nodes_.emplace_back();
    root.boxes.fill(roundedOutward(all));
    root.count[0] = count;
  } else {
    build(order, boxes, 0, count);
  }
  triangles_.reserve(count);
  for (const std::uint32_t t : order) {
    Triangle& triangle = triangles_.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      triangle.corners[i] = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][i])];
    }
    triangle.index = static_cast<Index>(t);
    triangle.thin = isThin(triangle.corners);
  }
}

// Halves by count along the longest side of the centers' box, so that the depth is logarithmic.
std::uint32_t ClosestTriangle::build(std::vector<std::uint32_t>& order, const std::vector<Box3>& boxes,
                                     std::uint32_t begin, std::uint32_t end) {
  const auto position = static_cast<std::uint32_t>(nodes_.size());
  nodes_.emplace_back();
  Box3 centers;
  for (std::uint32_t i = begin; i < end; ++i) centers.extend(boxes[order[i]].center());
  Eigen::Index axis = 0;
  centers.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [&](std::uint32_t a, std::uint32_t b) {
    const double left = boxes[a].min()[axis] + boxes[a].max()[axis];
    const double right = boxes[b].min()[axis] + boxes[b].max()[axis];
    return left < right || (left == right && a < b);
  });
  const std::array<std::array<std::uint32_t, 2>, 2> halves = {{{begin, middle}, {middle, end}}};
  for (std::size_t side = 0; side < 2; ++side) {
    const auto [from, to] = halves[side];
    Box3 box;
    for (std::uint32_t i = from; i < to; ++i) box.extend(boxes[order[i]]);
    nodes_[position].boxes[side] = roundedOutward(box);
    if (to - from <= kLeafSize) {
      nodes_[position].first[side] = from;
      nodes_[position].count[side] = to - from;
    } else {
      const std::uint32_t child = build(order, boxes, from, to);
      nodes_[position].first[side] = child;
    }
  }
  return position;
}

void ClosestTriangle::visitLeaf(const Vec3& p, std::uint32_t first, std::uint32_t count, double& bestSquared,
                                Hit& best) const {
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Triangle& triangle = triangles_[i];
    const Vec3 a = triangle.corners[0] - p;
    const Vec3 b = triangle.corners[1] - p;
    const Vec3 c = triangle.corners[2] - p;
    const Nearest nearest = triangle.thin ? nearestOfThinTriangle({a, b, c}) : nearestOfTriangle(a, b, c);
    const double squared = nearest.point.squaredNorm();
    if (squared > bestSquared || (squared == bestSquared && !(triangle.index < best.triangle))) continue;
    bestSquared = squared;
    best.triangle = triangle.index;
    best.point = nearest.point;
    best.feature = nearest.feature;
  }
}

ClosestTriangle::Hit ClosestTriangle::find(const Vec3& p, double bound) const {
  Hit best;
  if (nodes_.empty() || !(bound > 0)) return best;
  double bestSquared = bound * bound;
  // Boxes beyond cannot hold a triangle whose computed distance is as small; so the order of the search, and where it
  // began, leave no trace in the result.
  const double slack = slack_ + kRelativeSlack * p.norm();
  const auto limitOf = [slack](double squared) {
    const double reach = std::sqrt(squared) + slack;
    return reach * reach;
  };
  double limit = limitOf(bestSquared);

  struct Pending {
    std::uint32_t node;
    double squared;
  };
  // The tree is halved by count, so its depth is at most 32.
  std::array<Pending, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, 0.0};
  while (depth > 0) {
    const Pending pending = stack[--depth];
    if (pending.squared > limit) continue;
    const Node& node = nodes_[pending.node];
    const std::array<double, 2> squared = {squaredDistance(node.boxes[0], p), squaredDistance(node.boxes[1], p)};
    const std::size_t near = squared[1] < squared[0] ? 1 : 0;
    for (const std::size_t side : {near, 1 - near}) {
      if (node.count[side] == 0 || squared[side] > limit) continue;
      const double before = bestSquared;
      visitLeaf(p, node.first[side], node.count[side], bestSquared, best);
      if (bestSquared < before) limit = limitOf(bestSquared);
    }
    for (const std::size_t side : {1 - near, near}) {
      if (node.count[side] != 0 || squared[side] > limit) continue;
      if (nodes_.size() == 1) continue;  // the only node of a small mesh has one leaf
      stack[depth++] = {node.first[side], squared[side]};
    }
  }
  if (best.triangle == kNone) return best;
  best.distance = std::sqrt(bestSquared);
  best.point += p;
  return best;
}

}  // namespace voroform::mesh
