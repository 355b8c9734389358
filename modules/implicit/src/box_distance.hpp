// Exact signed distance to an axis-aligned box.
#pragma once

#include <algorithm>

#include "rounding.hpp"

namespace voroform::implicit {

// By axis the signed distance to the nearer of the box's two planes. Its sign is exact: a difference of two doubles is
// zero or has the sign of the true one.
inline Vec3 slabDistances(const Box3& box, const Vec3& p) { return (box.min() - p).cwiseMax(p - box.max()); }

inline double boxDistance(const Box3& box, const Vec3& p) {
  const Vec3 slabs = slabDistances(box, p);
  const double largest = slabs.maxCoeff();
  // On a face's side the plain difference avoids the rounding of a square root.
  if (largest < 0) return largest;
  const Vec3 beyond = slabs.cwiseMax(0.0);
  return std::max(largest, beyond.norm());
}

// The unit gradient; inside, that of the nearest plane, on ties of the lowest axis.
inline Vec3 boxGradient(const Box3& box, const Vec3& p) {
  const Vec3 slabs = slabDistances(box, p);
  Vec3 signs;
  for (int axis = 0; axis < 3; ++axis) signs[axis] = p[axis] - box.max()[axis] >= box.min()[axis] - p[axis] ? 1 : -1;
  const Vec3 beyond = slabs.cwiseMax(0.0);
  const double length = beyond.norm();
  if (length > 0) return beyond.cwiseProduct(signs) / length;
  int nearest = 0;
  slabs.maxCoeff(&nearest);
  return signs[nearest] * Vec3::Unit(nearest);
}

inline double boxClearance(const Box3& box, const Vec3& p) {
  return shrunk(boxDistance(box, p), roundingMargin(p.norm() + box.min().norm() + box.max().norm()));
}

}  // namespace voroform::implicit
