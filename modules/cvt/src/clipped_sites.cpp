#include "clipped_sites.hpp"

#include <string>
#include <utility>

#include "gather.hpp"
#include "voroform/core/error.hpp"

namespace voroform::cvt {

namespace {

// Room around a domain's bounds, in units of their diagonal.
constexpr double kDomainMargin = 0.1;

}  // namespace

template <int M>
Box<M> siteBoxAround(const Box<M>& bounds) {
  const Vec<M> margin = Vec<M>::Constant(kDomainMargin * bounds.diagonal().norm());
  return {bounds.min() - margin, bounds.max() + margin};
}

ClippedSites<3> clipSites(std::span<const Vec3> sites, const implicit::ImplicitFunction& f,
                          const voronoi::ClipOptions& options, const RunContext& context) {
  ClippedSites<3> cells;
  voronoi::ClipOptions flat = options;
  flat.cap = voronoi::CapKind::flat;
  cells.diagram = voronoi::buildDiagram(sites, siteBoxAround<3>(f.bounds()), context);
  cells.sinceDiagram.restart();
  cells.clip = voronoi::clip(cells.diagram, f, flat, context);
  return cells;
}

ClippedSites<2> clipSites(std::span<const Vec2> sites, const mesh::PlanarRegion& region, const RunContext& context) {
  // In space the diagram itself refuses such sites.
  const Box2 box = siteBoxAround<2>(region.bounds());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!box.contains(sites[i])) {
      throw MethodError("site " + std::to_string(i) + " lies outside the domain or is not finite");
    }
  }
  ClippedSites<2> cells;
  cells.diagram = voronoi::buildPlanarDiagram(sites, box, context);
  cells.sinceDiagram.restart();
  cells.clip = voronoi::clipPlanar(cells.diagram, region, context);
  return cells;
}

template <int M>
voronoi::WeightedMoments<M> momentsOf(const ClippedSites<M>& cells, const Density<M>* density,
                                      const RunContext& context) {
  if (density != nullptr) {
    const auto values = [&](std::span<const Vec<M>> points, std::span<double> out) { density->values(points, out); };
    return voronoi::weightedMoments(cells.diagram, cells.clip, values, context);
  }
  voronoi::WeightedMoments<M> moments;
  if constexpr (M == 2) {
    moments.moments = voronoi::planarMoments(cells.diagram, cells.clip, context);
  } else {
    moments.moments = voronoi::siteMoments(cells.diagram, cells.clip, context);
  }
  return moments;
}

template <int M>
Evaluation<M> evaluationOf(std::span<const Vec<M>> sites, const ClippedSites<M>& cells,
                           voronoi::WeightedMoments<M> moments, const RunContext& context) {
  Evaluation<M> result;
  result.moments = std::move(moments.moments);
  gather<M>(sites, moments.volumes, result, context);
  result.secondsDelaunay = cells.diagram.secondsDelaunay;
  result.secondsAfterDelaunay = cells.diagram.secondsFlattening + cells.sinceDiagram.seconds();
  return result;
}

template Box2 siteBoxAround<2>(const Box2&);
template Box3 siteBoxAround<3>(const Box3&);
template voronoi::WeightedMoments<2> momentsOf<2>(const ClippedSites<2>&, const Density<2>*, const RunContext&);
template voronoi::WeightedMoments<3> momentsOf<3>(const ClippedSites<3>&, const Density<3>*, const RunContext&);
template Evaluation<2> evaluationOf<2>(std::span<const Vec2>, const ClippedSites<2>&, voronoi::WeightedMoments<2>,
                                       const RunContext&);
template Evaluation<3> evaluationOf<3>(std::span<const Vec3>, const ClippedSites<3>&, voronoi::WeightedMoments<3>,
                                       const RunContext&);

}  // namespace voroform::cvt
