// The Delaunay tetrahedra that belong to a solid, with a manifold boundary.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::metrics {

struct Selection {
  std::vector<std::uint8_t> selected;  // of each diagram vertex: 1 where its tetrahedron belongs to the mesh
  Index repairRemoved = 0;             // taken off so that the boundary is manifold
  Index repairAdded = 0;               // added for the same reason
  Index flatRemoved = 0;               // then taken off because they were flat against the boundary
};

// The tetrahedra whose circumcenter lies inside, that is the dual of the diagram's vertices inside (Yan et al. 2013,
// section 5), repaired so that the boundary is manifold; then flat ones with all four sites on S are taken off the
// boundary, which flips one of its edges each.
Selection selectTetrahedra(const voronoi::Diagram& diagram, std::span<const std::uint8_t> onSurface,
                           const implicit::ImplicitFunction& f, const RunContext& context);

// Of each site: 1 if it is a vertex of the selection's boundary.
std::vector<std::uint8_t> boundarySites(const voronoi::Diagram& diagram, const Selection& selection);

// The selected tetrahedra, vertices in the sites' order.
mesh::PolyhedralComplex tetrahedralComplex(const voronoi::Diagram& diagram, const Selection& selection,
                                           const implicit::ImplicitFunction& f, const Frame& frame);

}  // namespace voroform::metrics
