// What the CVT energy and its gradient need of a cell.
#pragma once

#include "voroform/core/types.hpp"

namespace voroform::voronoi {

// Mass, first and second moment of a cell of dimension M about its site.
template <int M>
struct Moments {
  double mass = 0;                // ∫ ρ dx
  Vec<M> first = Vec<M>::Zero();  // ∫ ρ (x − site) dx
  double second = 0;              // ∫ ρ ‖x − site‖² dx
};
using SiteMoments = Moments<3>;

}  // namespace voroform::voronoi
