// Small complexes with known answers. Header-only test support.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::testing {

using Loop = std::vector<Index>;

// Joins cells, given as faces that run counter-clockwise seen from outside, into a complex: faces with the same set of
// vertices are shared.
inline mesh::PolyhedralComplex joinCells(std::vector<Vec3> vertices, const std::vector<std::vector<Loop>>& cells) {
  mesh::PolyhedralComplex complex;
  complex.vertices = std::move(vertices);
  complex.cellCount = static_cast<Index>(cells.size());
  std::map<Loop, std::size_t> known;
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    for (const Loop& loop : cells[cell]) {
      Loop key = loop;
      std::sort(key.begin(), key.end());
      const auto [place, added] = known.emplace(std::move(key), complex.faceCells.size());
      if (added) {
        complex.addFace(loop, static_cast<Index>(cell), kNone);
      } else {
        complex.faceCells[place->second][1] = static_cast<Index>(cell);
      }
    }
  }
  return complex;
}

// Unit cubes at the given places of the integer lattice; cubes that touch share their corners.
inline mesh::PolyhedralComplex cubes(const std::vector<std::array<int, 3>>& places) {
  std::map<std::array<int, 3>, Index> corners;
  std::vector<Vec3> vertices;
  std::vector<std::vector<Loop>> cells;
  for (const auto& place : places) {
    std::array<Index, 8> v{};
    for (std::size_t i = 0; i < 8; ++i) {
      const std::array<int, 3> corner = {place[0] + static_cast<int>(i & 1U), place[1] + static_cast<int>(i >> 1U & 1U),
                                         place[2] + static_cast<int>(i >> 2U)};
      const auto [known, added] = corners.emplace(corner, static_cast<Index>(vertices.size()));
      if (added) vertices.emplace_back(corner[0], corner[1], corner[2]);
      v[i] = known->second;
    }
    cells.push_back({{v[0], v[4], v[6], v[2]},
                     {v[1], v[3], v[7], v[5]},
                     {v[0], v[1], v[5], v[4]},
                     {v[2], v[6], v[7], v[3]},
                     {v[0], v[2], v[3], v[1]},
                     {v[4], v[5], v[7], v[6]}});
  }
  return joinCells(std::move(vertices), cells);
}

// An n × n × n block of unit cubes from the origin; cell (i, j, k) has the number (k·n + j)·n + i.
inline mesh::PolyhedralComplex block(int n) {
  std::vector<std::array<int, 3>> places;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) places.push_back({i, j, k});
    }
  }
  return cubes(places);
}

// Two complexes side by side in one, without any vertex in common.
inline mesh::PolyhedralComplex sideBySide(const mesh::PolyhedralComplex& a, const mesh::PolyhedralComplex& b) {
  mesh::PolyhedralComplex result = a;
  const auto firstVertex = static_cast<Index>(a.vertices.size());
  result.vertices.insert(result.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (Index f = 0; f < b.faceCount(); ++f) {
    Loop loop(b.face(f).begin(), b.face(f).end());
    for (Index& v : loop) v += firstVertex;
    const auto [behind, ahead] = b.faceCells[static_cast<std::size_t>(f)];
    result.addFace(loop, behind + a.cellCount, ahead == kNone ? kNone : ahead + a.cellCount);
  }
  result.cellCount += b.cellCount;
  return result;
}

inline mesh::PolyhedralComplex mapped(mesh::PolyhedralComplex complex, const Mat3& linear, const Vec3& translation) {
  for (Vec3& vertex : complex.vertices) vertex = linear * vertex + translation;
  return complex;
}

// One convex cell: the points that lie on each plane normal·x = offset, in angular order about the normal.
inline mesh::PolyhedralComplex convexCell(const std::vector<Vec3>& points,
                                          const std::vector<std::pair<Vec3, double>>& planes) {
  std::vector<Loop> faces;
  for (const auto& [normal, offset] : planes) {
    Loop loop;
    Vec3 center = Vec3::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::abs(normal.dot(points[i]) - offset) > 1e-9) continue;
      loop.push_back(static_cast<Index>(i));
      center += points[i];
    }
    center /= static_cast<double>(loop.size());
    const Vec3 u = (points[static_cast<std::size_t>(loop[0])] - center).normalized();
    const Vec3 v = normal.normalized().cross(u);
    const auto angle = [&](Index i) {
      const Vec3 d = points[static_cast<std::size_t>(i)] - center;
      return std::atan2(d.dot(v), d.dot(u));
    };
    std::sort(loop.begin(), loop.end(), [&](Index a, Index b) { return angle(a) < angle(b); });
    faces.push_back(loop);
  }
  return joinCells(points, {faces});
}

// The regular tetrahedron of edge 2√2.
inline mesh::PolyhedralComplex tetrahedron() {
  return joinCells({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}, {{{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}});
}

// The truncated octahedron of edge √2: the permutations of (0, ±1, ±2).
inline mesh::PolyhedralComplex truncatedOctahedron() {
  std::vector<Vec3> points;
  for (int zero = 0; zero < 3; ++zero) {
    for (const double one : {-1.0, 1.0}) {
      for (const double two : {-2.0, 2.0}) {
        Vec3 point = Vec3::Zero();
        point[(zero + 1) % 3] = one;
        point[(zero + 2) % 3] = two;
        points.push_back(point);
        std::swap(point[(zero + 1) % 3], point[(zero + 2) % 3]);
        points.push_back(point);
      }
    }
  }
  std::vector<std::pair<Vec3, double>> planes;
  for (const double x : {-1.0, 1.0}) {
    for (int axis = 0; axis < 3; ++axis) planes.emplace_back(x * Vec3::Unit(axis), 2.0);
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) planes.emplace_back(Vec3(x, y, z), 3.0);
    }
  }
  return convexCell(points, planes);
}

}  // namespace voroform::testing
