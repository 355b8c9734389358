// The CVT energy of sites in an implicit form.
#pragma once

#include <span>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/density.hpp"
#include "voroform/cvt/domain.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::cvt {

// The box that sites may roam in: the form's bounds with room around them.
Box3 siteDomain(const implicit::ImplicitFunction& f);

// Sites must be distinct and inside siteDomain(f): MethodError otherwise. Loops are closed by flat caps, roots found to
// `rootTolerance` of their edge. The gradient is exact for a fixed domain; here the caps move with the sites, and a
// small cap term is left out. Without a density ρ = 1.
Evaluation<3> evaluateEnergy(std::span<const Vec3> sites, const implicit::ImplicitFunction& f,
                             const voronoi::ClipOptions& options, const RunContext& context,
                             const Density<3>* density = nullptr);

// The tolerance that is exact enough while sites still move.
inline constexpr double kOptimizationRootTolerance = 1e-4;

}  // namespace voroform::cvt
