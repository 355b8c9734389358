// A plain Marching Cubes in double precision, as a yardstick for the accuracy of boundaries. Header-only test support.
#pragma once

#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "voroform/implicit/implicit_function.hpp"
#include "voroform/implicit/roots.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::testing {

// The zero set of f on a grid of cubes with edge `spacing`. Within each face of a cube crossing edges are linked so
// that inside corners stay apart (the same for both cubes of a face, so the surface is closed); the loops of a cube are
// cut into fans. Vertices are exact roots on the grid's edges.
inline mesh::TriangleMesh marchingCubes(const implicit::ImplicitFunction& f, double spacing,
                                        implicit::RootFinder finder, double tolerance) {
  const Box3 bounds = f.bounds();
  const Vec3 origin = bounds.min() - Vec3::Constant(1.5 * spacing);
  std::array<std::int64_t, 3> size{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    size[axis] = static_cast<std::int64_t>(std::ceil(bounds.sizes()[static_cast<Index>(axis)] / spacing)) + 4;
  }
  const auto number = [&](std::int64_t i, std::int64_t j, std::int64_t k) { return (k * size[1] + j) * size[0] + i; };
  const auto corner = [&](std::int64_t n) {
    return Vec3(origin + spacing * Vec3(static_cast<double>(n % size[0]), static_cast<double>(n / size[0] % size[1]),
                                        static_cast<double>(n / size[0] / size[1])));
  };
  std::vector<Vec3> points;
  for (std::int64_t n = 0; n < size[0] * size[1] * size[2]; ++n) points.push_back(corner(n));
  std::vector<double> values(points.size());
  f.values(points, values);

  mesh::TriangleMesh result;
  std::unordered_map<std::int64_t, Index> vertexOnEdge;  // key: 3·lower corner + axis
  std::int64_t evaluations = 0;
  const auto vertexBetween = [&](std::int64_t p, std::int64_t q) {
    const std::int64_t low = std::min(p, q);
    const std::int64_t step = std::abs(p - q);
    const std::int64_t axis = step == 1 ? 0 : (step == size[0] ? 1 : 2);
    const auto [entry, isNew] = vertexOnEdge.try_emplace(3 * low + axis, static_cast<Index>(result.vertices.size()));
    if (isNew) {
      const auto a = static_cast<std::size_t>(low);
      const auto b = static_cast<std::size_t>(low + step);
      const double t =
          implicit::findRoot(f, points[a], points[b], values[a], values[b], tolerance, finder, evaluations);
      result.vertices.push_back(points[a] + t * (points[b] - points[a]));
    }
    return entry->second;
  };

  // Faces of a cube as rings of corners (bit 0: x, bit 1: y, bit 2: z), counter-clockwise seen from outside.
  constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (std::int64_t k = 0; k + 1 < size[2]; ++k) {
    for (std::int64_t j = 0; j + 1 < size[1]; ++j) {
      for (std::int64_t i = 0; i + 1 < size[0]; ++i) {
        std::array<std::int64_t, 8> corners{};
        int insideCount = 0;
        for (int c = 0; c < 8; ++c) {
          corners[static_cast<std::size_t>(c)] = number(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
          insideCount += values[static_cast<std::size_t>(corners[static_cast<std::size_t>(c)])] < 0 ? 1 : 0;
        }
        if (insideCount == 0 || insideCount == 8) continue;
        // In a face's ring the surface leaves from where the ring enters the solid to where it leaves it again.
        std::unordered_map<Index, Index> next;
        for (const auto& face : kFaces) {
          for (std::size_t s = 0; s < 4; ++s) {
            const auto at = [&](std::size_t offset) {
              return corners[static_cast<std::size_t>(face[(s + offset) % 4])];
            };
            const auto inside = [&](std::size_t offset) { return values[static_cast<std::size_t>(at(offset))] < 0; };
            if (inside(0) || !inside(1)) continue;
            std::size_t last = 1;
            while (inside(last + 1)) ++last;
            next[vertexBetween(at(0), at(1))] = vertexBetween(at(last), at(last + 1));
          }
        }
        while (!next.empty()) {
          std::vector<Index> loop;
          for (auto entry = next.begin(); entry != next.end(); entry = next.find(loop.back())) {
            const Index to = entry->second;
            next.erase(entry);
            loop.push_back(to);
          }
          for (std::size_t v = 2; v < loop.size(); ++v) {
            result.triangles.push_back({loop[0], loop[v - 1], loop[v]});
          }
        }
      }
    }
  }
  return result;
}

}  // namespace voroform::testing
