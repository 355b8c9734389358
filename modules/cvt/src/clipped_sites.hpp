// What the domains of the plane and of space do with sites alike: cells clipped, integrated and gathered to the energy.
#pragma once

#include <span>
#include <type_traits>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/density.hpp"
#include "voroform/cvt/domain.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/planar_region.hpp"
#include "voroform/voronoi/clip.hpp"
#include "voroform/voronoi/diagram.hpp"
#include "voroform/voronoi/planar.hpp"
#include "voroform/voronoi/weighted_moments.hpp"

namespace voroform::cvt {

// The box that sites may roam in: the domain's bounds with room around them.
template <int M>
Box<M> siteBoxAround(const Box<M>& bounds);

template <int M>
struct ClippedSites {
  std::conditional_t<M == 2, voronoi::PlanarDiagram, voronoi::Diagram> diagram;
  std::conditional_t<M == 2, voronoi::PlanarClip, voronoi::ClippedDiagram> clip;
  Stopwatch sinceDiagram;
};

// Throw MethodError if a site lies outside of siteBoxAround() the bounds, or two are equal. Loops are closed by flat
// caps, whatever the options say.
ClippedSites<3> clipSites(std::span<const Vec3> sites, const implicit::ImplicitFunction& f,
                          const voronoi::ClipOptions& options, const RunContext& context);
ClippedSites<2> clipSites(std::span<const Vec2> sites, const mesh::PlanarRegion& region, const RunContext& context);

// Of the clipped cells; weighted, and with their volumes, if there is a density.
template <int M>
voronoi::WeightedMoments<M> momentsOf(const ClippedSites<M>& cells, const Density<M>* density,
                                      const RunContext& context);

template <int M>
Evaluation<M> evaluationOf(std::span<const Vec<M>> sites, const ClippedSites<M>& cells,
                           voronoi::WeightedMoments<M> moments, const RunContext& context);

}  // namespace voroform::cvt
