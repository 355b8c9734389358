#include "voroform/cvt/planar_domain.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "gather.hpp"
#include "voroform/core/error.hpp"
#include "voroform/voronoi/planar.hpp"
#include "voroform/voronoi/weighted_moments.hpp"

namespace voroform::cvt {

namespace {

// Room around the region's bounds, in units of their diagonal.
constexpr double kDomainMargin = 0.1;

}  // namespace

Box2 PlanarDomain::siteBox() const {
  const Box2 box = bounds();
  const Vec2 margin = Vec2::Constant(kDomainMargin * box.diagonal().norm());
  return {box.min() - margin, box.max() + margin};
}

Evaluation<2> PlanarDomain::evaluate(std::span<const Vec2> sites, const RunContext& context) const {
  const Box2 box = siteBox();
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!box.contains(sites[i])) {
      throw MethodError("site " + std::to_string(i) + " lies outside the domain or is not finite");
    }
  }
  Evaluation<2> result;
  const voronoi::PlanarDiagram diagram = voronoi::buildPlanarDiagram(sites, box, context);
  const Stopwatch watch;
  const voronoi::PlanarClip clip = voronoi::clipPlanar(diagram, region_, context);
  voronoi::WeightedMoments<2> weighted;
  if (density_ != nullptr) {
    const auto values = [&](std::span<const Vec2> points, std::span<double> out) { density_->values(points, out); };
    weighted = voronoi::weightedMoments(diagram, clip, values, context);
  } else {
    weighted.moments = voronoi::planarMoments(diagram, clip, context);
  }
  result.moments = std::move(weighted.moments);
  gather(sites, weighted.volumes, result, context);
  result.secondsDelaunay = diagram.secondsDelaunay;
  result.secondsAfterDelaunay = diagram.secondsFlattening + watch.seconds();
  return result;
}

SiteGraph PlanarDomain::graph(std::span<const Vec2> sites, const RunContext& context) const {
  const voronoi::PlanarDiagram diagram = voronoi::buildPlanarDiagram(sites, siteBox(), context);
  const voronoi::PlanarClip clip = voronoi::clipPlanar(diagram, region_, context);
  SiteGraph graph;
  graph.edges = voronoi::neighborPairs(diagram, clip);
  graph.onBoundary.resize(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    graph.onBoundary[i] = clip.touchesBoundary(static_cast<Index>(i)) ? 1 : 0;
  }
  return graph;
}

}  // namespace voroform::cvt
