// The baselines' boundaries fitted to S in the mean square, so that a comparison with fitted caps can be made fair.
#pragma once

#include "voroform/baselines/cube_grid.hpp"
#include "voroform/core/run_context.hpp"
#include "voroform/implicit/surface_fit.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::baselines {

struct BoundaryFit {
  Index moved = 0;      // vertices that the fit moved
  Index takenBack = 0;  // vertices left where they were, for a tetrahedron would have turned inside out
  implicit::FitSummary summary;
};

// Moves each vertex that lies on a cube's edge along it, others of the boundary along its normal. `grid` is the one
// that the complex was made with. Vertices at the envelope stay.
BoundaryFit fitMarchingCubes(mesh::PolyhedralComplex& complex, const CubeGrid& grid,
                             const implicit::ImplicitFunction& f, const implicit::FitOptions& options,
                             const RunContext& context);

// Moves the boundary's vertices along their normals; no tetrahedron loses more than 90 % of its volume.
BoundaryFit fitTetrahedra(mesh::PolyhedralComplex& complex, const implicit::ImplicitFunction& f,
                          const implicit::FitOptions& options, const RunContext& context);

}  // namespace voroform::baselines
