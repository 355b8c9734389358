// Fitted caps: the boundary's vertices moved off S to where its triangles follow S best.
#pragma once

#include "caps.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {

// Moves roots along their diagram edges, chord points within their facets across their chords, and apexes of caps along
// the caps' normals, to the least-squares fit of the caps' triangles to S (implicit::fitShifts). `tags` are those of
// the caps' triangles; vertices at the envelope, and of caps without a volume, stay. A root stays between its neighbors
// on the edge, a chord point in its facet, an apex in its cell; facets whose polygons would cross, and cells whose caps
// would, keep their vertices. Adds to the clipped diagram's summary.
void fitCaps(const Diagram& diagram, ClippedDiagram& clipped, Caps& caps, std::span<const mesh::FaceTag> tags,
             const implicit::ImplicitFunction& f, const ClipOptions& options, const RunContext& context);

}  // namespace voroform::voronoi
