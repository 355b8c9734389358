// The planar Delaunay triangulation behind our own types.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::voronoi {

// The finite triangles with at least one vertex below `realCount`, counter-clockwise, sorted by their lowest vertex.
// neighbors[t][k] is the triangle opposite vertex k, kNone where there is none of that kind.
struct Triangles {
  std::vector<std::array<Index, 3>> vertices;
  std::vector<std::array<Index, 3>> neighbors;
};

// Sequential and deterministic. Throws MethodError if two points coincide.
Triangles delaunayTriangles(std::span<const Vec2> points, Index realCount);

// The circumcenter by exact arithmetic, for triangles too flat for floating point.
Vec2 exactCircumcenter(const Vec2& a, const Vec2& b, const Vec2& c);

}  // namespace voroform::voronoi
