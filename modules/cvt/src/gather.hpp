// From the cells' moments to the energy.
#pragma once

#include <span>

#include "voroform/cvt/domain.hpp"

namespace voroform::cvt {

// Sets all of the evaluation but the seconds from its moments; those of nearly empty cells become zero. `volumes`: of
// the cells, if the moments are weighted by a density; empty if not.
template <int M>
void gather(std::span<const Vec<M>> sites, std::span<const double> volumes, Evaluation<M>& evaluation,
            const RunContext& context);

}  // namespace voroform::cvt
