// Triangle meshes with known shapes. Header-only test support.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::testing {

// [0, edge]² in the plane z = 0, facing up, as 2·n² triangles.
inline mesh::TriangleMesh squareMesh(int n, double edge) {
  mesh::TriangleMesh mesh;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) mesh.vertices.emplace_back(edge * i / n, edge * j / n, 0);
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const auto corner = [&](int x, int y) { return static_cast<Index>((j + y) * (n + 1) + i + x); };
      mesh.triangles.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
      mesh.triangles.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
    }
  }
  return mesh;
}

// An icosahedron whose triangles are quartered `level` times, with all vertices on the sphere about the origin:
// 20·4^level triangles, outward.
inline mesh::TriangleMesh icosphere(int level, double radius) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  mesh::TriangleMesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int round = 0; round < level; ++round) {
    std::map<std::pair<Index, Index>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [entry, added] = middles.try_emplace(std::minmax(a, b), static_cast<Index>(mesh.vertices.size()));
      if (added) {
        mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(a)].normalized() +
                                mesh.vertices[static_cast<std::size_t>(b)].normalized());
      }
      return entry->second;
    };
    std::vector<std::array<Index, 3>> quarters;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Index ab = middle(a, b);
      const Index bc = middle(b, c);
      const Index ca = middle(c, a);
      quarters.insert(quarters.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = quarters;
  }
  for (Vec3& vertex : mesh.vertices) vertex *= radius / vertex.norm();
  return mesh;
}

inline mesh::TriangleMesh mappedMesh(mesh::TriangleMesh mesh, const Mat3& linear, const Vec3& translation) {
  for (Vec3& vertex : mesh.vertices) vertex = linear * vertex + translation;
  return mesh;
}

// Both meshes in one.
inline mesh::TriangleMesh joined(mesh::TriangleMesh a, const mesh::TriangleMesh& b) {
  const auto first = static_cast<Index>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) a.triangles.push_back({i + first, j + first, k + first});
  return a;
}

// The solid inside a closed mesh as a complex of one cell.
inline mesh::PolyhedralComplex solidOf(const mesh::TriangleMesh& mesh) {
  mesh::PolyhedralComplex complex;
  complex.vertices = mesh.vertices;
  complex.frame = mesh.frame;
  complex.cellCount = 1;
  for (const auto& triangle : mesh.triangles) complex.addFace(triangle, 0, kNone);
  return complex;
}

}  // namespace voroform::testing
