// The CVT energy of sites in an implicit form.
#pragma once

#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::cvt {

// E = Σᵢ ∫_Ωᵢ ‖x − xᵢ‖² dx over the clipped cells Ωᵢ, and what its gradient 2 mᵢ (xᵢ − cᵢ) needs. The gradient is exact
// for a fixed domain (Liu et al. 2009); here the caps move with the sites, and a small cap term is left out.
struct Evaluation {
  double energy = 0;
  double volume = 0;                          // Σ mᵢ
  Index emptyCells = 0;                       // sites whose cell is empty, or nearly so: mass below 1e-6·V/n
  double rmsMove = 0;                         // rms‖cᵢ − xᵢ‖/h over the other sites, h = (V/n)^(1/3)
  std::vector<voronoi::SiteMoments> moments;  // of each site; zero for an empty cell
  voronoi::ClipSummary clip;
  double secondsDelaunay = 0;
  double secondsAfterDelaunay = 0;  // flattening, clipping, integrals
};

// The box that sites may roam in: the form's bounds with room around them.
Box3 siteDomain(const implicit::ImplicitFunction& f);

// Sites must be distinct and inside siteDomain(f): MethodError otherwise. Loops are closed by flat caps, roots found to
// `rootTolerance` of their edge.
Evaluation evaluateEnergy(std::span<const Vec3> sites, const implicit::ImplicitFunction& f,
                          const voronoi::ClipOptions& options, const RunContext& context);

// The tolerance that is exact enough while sites still move.
inline constexpr double kOptimizationRootTolerance = 1e-4;

// E_m = m·n·(V/n)^((m+2)/m)·G_m for m = 3: the energy if all n cells were truncated octahedra (thesis, section 3.4).
double optimalEnergy(Index sites, double volume);

}  // namespace voroform::cvt
