// Tetrahedra with their neighbors: what Delaunay refinement yields, and the way it travels between processes.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::baselines {

struct Tetrahedra {
  std::vector<Vec3> vertices;                   // each a corner of some tetrahedron
  std::vector<std::array<Index, 4>> corners;    // positively oriented: (b − a)·((c − a) × (d − a)) > 0
  std::vector<std::array<Index, 4>> neighbors;  // opposite to each corner; kNone on the boundary
  double secondsRefinement = 0;
  double secondsOptimization = 0;
};

std::vector<std::byte> pack(const Tetrahedra& tetrahedra);
// Throws Error on bytes that pack() cannot have made.
Tetrahedra unpack(std::span<const std::byte> bytes);

// Boundary faces are tagged by f at their centroids.
mesh::PolyhedralComplex toComplex(const Tetrahedra& tetrahedra, const implicit::ImplicitFunction& f, const Frame& frame,
                                  const RunContext& context);

}  // namespace voroform::baselines
