// Minimizing the CVT energy.
#pragma once

#include "voroform/cvt/tessellate.hpp"

namespace voroform::cvt {

// Moves the sites; fills the summary's iterations, stop, energies, evaluations and reseededSites.
void minimizeEnergy(std::vector<Vec3>& sites, const implicit::ImplicitFunction& f, const TessellateOptions& options,
                    TessellateSummary& summary, const RunContext& context);

}  // namespace voroform::cvt
