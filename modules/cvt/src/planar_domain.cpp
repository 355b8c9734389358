#include "voroform/cvt/planar_domain.hpp"

#include "clipped_sites.hpp"

namespace voroform::cvt {

Box2 PlanarDomain::siteBox() const { return siteBoxAround<2>(bounds()); }

Evaluation<2> PlanarDomain::evaluate(std::span<const Vec2> sites, const RunContext& context) const {
  const ClippedSites<2> cells = clipSites(sites, region_, context);
  return evaluationOf<2>(sites, cells, momentsOf(cells, density_.get(), context), context);
}

SiteGraph PlanarDomain::graph(std::span<const Vec2> sites, const RunContext& context) const {
  const ClippedSites<2> cells = clipSites(sites, region_, context);
  SiteGraph graph;
  graph.edges = voronoi::neighborPairs(cells.diagram, cells.clip);
  graph.onBoundary.resize(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    graph.onBoundary[i] = cells.clip.touchesBoundary(static_cast<Index>(i)) ? 1 : 0;
  }
  return graph;
}

}  // namespace voroform::cvt
