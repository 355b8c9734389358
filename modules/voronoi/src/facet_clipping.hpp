// Clipping the facets of a diagram between their roots.
#pragma once

#include "edge_roots.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {

// Fills facetStates, the polygons and the chords (without their points) of `clipped`, whose points (the roots),
// rootCount and rootSites are set. Appends tongue points to points, and their facets to chordPointFacets.
void clipFacets(const Diagram& diagram, const EdgeRoots& roots, const implicit::ImplicitFunction& f,
                const ClipOptions& options, ClippedDiagram& clipped, const RunContext& context);

// Gives each chord the point where S meets its facet's plane (cvt3), inserts it into the facet's polygon, and keeps the
// polygons simple.
void addChordPoints(const Diagram& diagram, const implicit::ImplicitFunction& f, const ClipOptions& options,
                    ClippedDiagram& clipped, const RunContext& context);

// Links the chords of each cell to loops.
void linkLoops(const Diagram& diagram, ClippedDiagram& clipped, const RunContext& context);

}  // namespace voroform::voronoi
