// Marching Cubes with topological guarantees as a volumetric tessellation (Chernyaev 1995; Lewiner et al. 2003;
// Custodio et al. 2013; thesis 5.3.1.1).
#pragma once

#include <array>
#include <cstdint>

#include "voroform/baselines/cube_grid.hpp"
#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/implicit/roots.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::baselines {

struct MarchingCubesOptions {
  implicit::RootFinder rootFinder = implicit::RootFinder::itp;
  // Relative to the cube's edge: width of the bracket at which root finding stops.
  double rootTolerance = 1e-12;
};

struct MarchingCubesSummary {
  Index cutCells = 0;           // cells that S cuts
  Index disconnectedCells = 0;  // of them, those whose part of the solid has several pieces
  Index tunnelledCells = 0;     // of them, those whose part of the surface has a tunnel
  Index ambiguousFaces = 0;     // cube faces whose signs alternate
  // How many cut cubes fell into each of Chernyaev's 15 base cases, 0 … 14, by the signs at their corners. Cubes all
  // inside or all outside are not counted, so entry 0 stays 0.
  std::array<Index, 15> cases = {};
  std::int64_t evaluations = 0;  // of f
  double seconds = 0;
};

struct MarchingCubesResult {
  mesh::PolyhedralComplex complex;
  MarchingCubesSummary summary;
};

// Each cube with an inside corner becomes one cell: the cube clipped to the solid. Topology is that of the trilinear
// interpolant of the corner values; vertices lie on the cubes' edges, at f's roots, but at least a millionth of the
// edge off its ends. Only loops that run over an ambiguous face, and tunnels, have further vertices, in the cube's
// interior. A cube's part may be disconnected or tunnelled: it stays one cell. Boundary faces on f's envelope are
// tagged. The complex has no sites. Throws UsageError unless the grid's outermost corners are outside, and MethodError
// where f is not finite at a cut cube. The same bits for any number of threads. f is evaluated at corners nearer to S
// than a cube's diagonal, as far as its inside oracle can tell, and for roots.
MarchingCubesResult marchingCubes(const implicit::ImplicitFunction& f, const Frame& frame, const CubeGrid& grid,
                                  const MarchingCubesOptions& options, const RunContext& context);

}  // namespace voroform::baselines
