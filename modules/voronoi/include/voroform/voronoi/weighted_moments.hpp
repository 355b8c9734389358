// Moments of clipped cells weighted by a density ρ.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/voronoi/clip.hpp"
#include "voroform/voronoi/diagram.hpp"
#include "voroform/voronoi/planar.hpp"
#include "voroform/voronoi/site_moments.hpp"

namespace voroform::voronoi {

// ρ at a batch of points that are neighbors; called from many threads at once.
template <int M>
using DensityValues = std::function<void(std::span<const Vec<M>> points, std::span<double> values)>;

template <int M>
struct WeightedMoments {
  std::vector<Moments<M>> moments;  // of each site: weighted by ρ, about the site
  std::vector<double> volumes;      // of each site: area or volume of its cell, not weighted
};

// Polynomials up to this degree are integrated exactly, and with them the second moment for ρ of a degree lower by two.
// All weights are positive: where ρ > 0 and a cell is seen whole from its site, its mass is positive.
template <int M>
inline constexpr int kQuadratureDegree = M == 2 ? 4 : 5;

// As siteMoments and planarMoments, which these equal up to rounding for ρ = 1: zero for empty cells, loops closed by
// flat caps. Each cell is split into simplices with a corner at its site, 6 or 14 points each. ρ is also asked for
// outside of the domain where a cell is not star-shaped about its site. The same bits for any number of threads.
WeightedMoments<3> weightedMoments(const Diagram& diagram, const ClippedDiagram& clipped,
                                   const DensityValues<3>& density, const RunContext& context);
WeightedMoments<2> weightedMoments(const PlanarDiagram& diagram, const PlanarClip& clip,
                                   const DensityValues<2>& density, const RunContext& context);

}  // namespace voroform::voronoi
