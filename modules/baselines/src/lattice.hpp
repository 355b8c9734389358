// Values of a form on a regular lattice, asked as rarely as its inside oracle allows.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::baselines {

// Point (i, j, k) lies at origin + spacing·(i, j, k), 0 ≤ i < counts[0] and so on.
struct Lattice {
  Vec3 origin = Vec3::Zero();
  double spacing = 0;
  std::array<Index, 3> counts = {0, 0, 0};

  std::size_t size() const {
    return static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1]) *
           static_cast<std::size_t>(counts[2]);
  }
  std::size_t number(Index i, Index j, Index k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(counts[1]) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(counts[0]) +
           static_cast<std::size_t>(i);
  }
  Vec3 point(Index i, Index j, Index k) const {
    return origin + spacing * Vec3(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
  }
};

// f at every point that the oracle does not place farther than `reach` ≥ 0 from S; −∞ or +∞, by its sign, at the
// others. `evaluations` is increased by the number of calls of f.
std::vector<double> latticeValues(const implicit::ImplicitFunction& f, const Lattice& lattice, double reach,
                                  const RunContext& context, std::int64_t& evaluations);

}  // namespace voroform::baselines
