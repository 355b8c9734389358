// The Delaunay triangulation behind our own types: the only place in this module that knows CGAL's triangulation.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::voronoi {

// The finite tetrahedra with at least one vertex below `realCount`, positively oriented, sorted by their lowest vertex.
// neighbors[t][k] is the tetrahedron opposite vertex k, kNone where there is none of that kind.
struct Tetrahedra {
  std::vector<std::array<Index, 4>> vertices;
  std::vector<std::array<Index, 4>> neighbors;
};

// Sequential and deterministic. Throws MethodError if two points coincide.
Tetrahedra delaunayTetrahedra(std::span<const Vec3> points, Index realCount);

// The circumcenter by exact arithmetic, for tetrahedra too flat for floating point.
Vec3 exactCircumcenter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

}  // namespace voroform::voronoi
