// Planar tessellations made by hand.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "voroform/mesh/planar_region.hpp"
#include "voroform/mesh/planar_tessellation.hpp"

namespace voroform::testing {

// Loops of vertices for each cell; neighbors are found by the edges' opposites.
inline mesh::PlanarTessellation joinLoops(std::vector<Vec2> vertices,
                                          const std::vector<std::vector<std::vector<Index>>>& cells,
                                          std::vector<Vec2> sites) {
  mesh::PlanarTessellation result;
  result.vertices = std::move(vertices);
  result.sites = std::move(sites);
  std::map<std::array<Index, 2>, Index> owners;
  const auto edge = [](const std::vector<Index>& loop, std::size_t k) {
    return std::array<Index, 2>{loop[k], loop[(k + 1) % loop.size()]};
  };
  for (std::size_t cell = 0; cell < cells.size(); ++cell) {
    for (const auto& loop : cells[cell]) {
      for (std::size_t k = 0; k < loop.size(); ++k) owners[edge(loop, k)] = static_cast<Index>(cell);
    }
  }
  for (const auto& loops : cells) {
    for (const auto& loop : loops) {
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const auto [from, to] = edge(loop, k);
        const auto opposite = owners.find({to, from});
        result.loopVertices.push_back(from);
        result.neighbors.push_back(opposite == owners.end() ? kNone : opposite->second);
      }
      result.loopOffsets.push_back(static_cast<std::uint32_t>(result.loopVertices.size()));
    }
    result.cellOffsets.push_back(static_cast<std::uint32_t>(result.loopOffsets.size() - 1));
  }
  return result;
}

// n × n unit squares from the origin.
inline mesh::PlanarTessellation squares(int n) {
  std::vector<Vec2> vertices;
  for (int y = 0; y <= n; ++y) {
    for (int x = 0; x <= n; ++x) vertices.emplace_back(x, y);
  }
  std::vector<std::vector<std::vector<Index>>> cells;
  std::vector<Vec2> sites;
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      const Index corner = y * (n + 1) + x;
      cells.push_back({{corner, corner + 1, corner + n + 2, corner + n + 1}});
      sites.emplace_back(x + 0.5, y + 0.5);
    }
  }
  return joinLoops(std::move(vertices), cells, std::move(sites));
}

inline mesh::PlanarRegion squareOf(double edge) {
  return mesh::PlanarRegion(std::vector<std::vector<Vec2>>{{{0, 0}, {edge, 0}, {edge, edge}, {0, edge}}});
}

// The square of edge 6 with a hole of edge 1, in two cells: the second is an inner square of edge 2 around the hole;
// the first has the rest, a ring, and a triangle apart, the second outline of it, that touches nothing.
inline mesh::PlanarTessellation ringAndIsland() {
  std::vector<Vec2> vertices = {{0, 0}, {6, 0}, {6, 6}, {0, 6}};
  for (const Vec2& corner : {Vec2(2, 2), Vec2(4, 2), Vec2(4, 4), Vec2(2, 4)}) vertices.push_back(corner);
  for (const Vec2& corner : {Vec2(2.5, 2.5), Vec2(3.5, 2.5), Vec2(3.5, 3.5), Vec2(2.5, 3.5)})
    vertices.push_back(corner);
  for (const Vec2& corner : {Vec2(8, 0), Vec2(10, 0), Vec2(8, 3)}) vertices.push_back(corner);
  return joinLoops(std::move(vertices), {{{0, 1, 2, 3}, {4, 7, 6, 5}, {12, 13, 14}}, {{4, 5, 6, 7}, {8, 11, 10, 9}}},
                   {{1, 1}, {2.2, 2.2}});
}

// One cell: a regular polygon about a center.
inline mesh::PlanarTessellation regularPolygon(int corners, double radius, const Vec2& center) {
  std::vector<Vec2> vertices;
  std::vector<Index> loop;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * k / corners;
    vertices.emplace_back(center + radius * Vec2(std::cos(angle), std::sin(angle)));
    loop.push_back(k);
  }
  return joinLoops(std::move(vertices), {{loop}}, {center});
}

}  // namespace voroform::testing
