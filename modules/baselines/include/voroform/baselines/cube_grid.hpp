// Grids of cubes, and the rule of equal resolution that sets their edge (thesis 5.3.1.1).
#pragma once

#include <array>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::baselines {

// Cubes of one edge, axis-parallel. Corner (i, j, k) lies at origin + edge·(i, j, k), 0 ≤ i ≤ cubes[0] and so on.
struct CubeGrid {
  Vec3 origin = Vec3::Zero();
  double edge = 0;
  std::array<Index, 3> cubes = {0, 0, 0};

  Vec3 corner(Index i, Index j, Index k) const {
    return origin + edge * Vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
  }
};

// The bounding box of {f < 0} to within about a thousandth of its longest edge; it contains every inside point that was
// found. Throws MethodError if no inside point is found. Deterministic.
Box3 solidBox(const implicit::ImplicitFunction& f, const RunContext& context);

// `resolution` cubes (at least 2) along the longest edge of the solid's box, centered on the box, with a layer of cubes
// around it so that the grid's border lies outside.
CubeGrid gridOf(const Box3& solidBox, Index resolution);

// The number n of cubes whose center is inside: the number of sites that the CVT methods get at equal resolution.
Index insideCubes(const implicit::ImplicitFunction& f, const CubeGrid& grid, const RunContext& context);

}  // namespace voroform::baselines
