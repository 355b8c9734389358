// Crossings of axis-parallel rays with triangles.
#pragma once

#include <algorithm>
#include <cmath>

#include "voroform/core/types.hpp"

namespace voroform::mesh {

enum class Crossing { none, crossed, uncertain };

// Does the ray from p towards +axis cross the triangle (a, b, c)? Uncertain if it passes an edge nearer than
// `tolerance`, or if p is nearer than that to the triangle's plane at a crossing.
inline Crossing rayCrossing(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c, int axis, double tolerance) {
  const int u = axis == 2 ? 0 : axis + 1;
  const int v = axis == 0 ? 2 : axis - 1;
  const Vec3 corner[3] = {a - p, b - p, c - p};
  if (std::max({corner[0][axis], corner[1][axis], corner[2][axis]}) < -tolerance) return Crossing::none;
  // side[i]: on which side of edge i the ray passes, times the edge's projected length.
  double side[3];
  bool left = false;
  bool right = false;
  bool near = false;
  for (int i = 0; i < 3; ++i) {
    const Vec3& from = corner[i];
    const Vec3& to = corner[i == 2 ? 0 : i + 1];
    side[i] = from[u] * to[v] - from[v] * to[u];
    const double du = to[u] - from[u];
    const double dv = to[v] - from[v];
    // Written so that a value which overflowed counts as near.
    if (!(side[i] * side[i] > tolerance * tolerance * (du * du + dv * dv))) {
      near = true;
    } else {
      (side[i] > 0 ? left : right) = true;
    }
  }
  if (left && right) return Crossing::none;
  if (near) return Crossing::uncertain;
  // With the sides as barycentric weights (edge i lies opposite corner i + 2): height / sum is the plane's height above
  // p.
  const double height = side[1] * corner[0][axis] + side[2] * corner[1][axis] + side[0] * corner[2][axis];
  const double sum = side[0] + side[1] + side[2];
  const double normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).norm();
  if (!(std::abs(height) > tolerance * normal)) return Crossing::uncertain;
  return (height > 0) == (sum > 0) ? Crossing::crossed : Crossing::none;
}

}  // namespace voroform::mesh
