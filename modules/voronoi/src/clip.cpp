#include "voroform/voronoi/clip.hpp"

#include "edge_roots.hpp"
#include "facet_clipping.hpp"

namespace voroform::voronoi {

ClippedDiagram clip(const Diagram& diagram, const implicit::ImplicitFunction& f, const ClipOptions& options,
                    const RunContext& context) {
  ClippedDiagram clipped;
  {
    EdgeRoots roots = findEdgeRoots(diagram, f, options, context);
    clipped.points = std::move(roots.positions);
    clipped.rootCount = static_cast<Index>(clipped.points.size());
    clipped.rootSites = std::move(roots.sites);
    clipped.rootEnds = std::move(roots.ends);
    clipped.summary.roots = clipped.rootCount;
    clipped.summary.doubleRootEdges = roots.doubleRootEdges;
    clipped.summary.oracleShare = roots.oracleShare;
    clipped.summary.evaluations = roots.evaluations;
    clipFacets(diagram, roots, f, options, clipped, context);
    clipped.inside = std::move(roots.inside);
  }
  if (options.cap == CapKind::cvt3) addChordPoints(diagram, f, options, clipped, context);
  linkLoops(diagram, clipped, context);
  return clipped;
}

}  // namespace voroform::voronoi
