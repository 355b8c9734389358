// Oriented point clouds of shapes that are known exactly.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "voroform/core/random.hpp"
#include "voroform/points/point_cloud.hpp"

namespace voroform::test {

// Uniform by area, at random; axis z. The normals point outward.
inline points::PointCloud torusCloud(std::size_t count, std::uint64_t seed, double majorRadius = 1,
                                     double minorRadius = 0.4) {
  points::PointCloud cloud;
  for (std::uint64_t i = 0; cloud.positions.size() < count; ++i) {
    const double u = 2 * std::numbers::pi * randomUnit(seed, RandomStream::test, 3 * i);
    const double v = 2 * std::numbers::pi * randomUnit(seed, RandomStream::test, 3 * i + 1);
    // The area element grows with the distance from the axis: rejection.
    const double ring = majorRadius + minorRadius * std::cos(v);
    if (randomUnit(seed, RandomStream::test, 3 * i + 2) * (majorRadius + minorRadius) > ring) continue;
    cloud.positions.emplace_back(ring * std::cos(u), ring * std::sin(u), minorRadius * std::sin(v));
    cloud.normals.emplace_back(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v));
  }
  return cloud;
}

// The spherical Fibonacci lattice: evenly spread.
inline points::PointCloud sphereCloud(std::size_t count, double radius = 1) {
  points::PointCloud cloud;
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double ring = std::sqrt(1 - z * z);
    const double angle = turn * static_cast<double>(i);
    cloud.normals.emplace_back(ring * std::cos(angle), ring * std::sin(angle), z);
    cloud.positions.push_back(radius * cloud.normals.back());
  }
  return cloud;
}

// The distance at which the points of a surface of this area lie apart.
inline double spacingOf(double area, std::size_t count) { return std::sqrt(area / static_cast<double>(count)); }

inline Box3 grownBox(const points::PointCloud& cloud, double margin) {
  Box3 box;
  for (const Vec3& p : cloud.positions) box.extend(p);
  const Vec3 border = Vec3::Constant(margin * box.diagonal().norm());
  return {box.min() - border, box.max() + border};
}

}  // namespace voroform::test
