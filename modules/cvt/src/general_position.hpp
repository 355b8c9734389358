// Sites of which no five lie on one sphere.
#pragma once

#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::cvt {

// Where more than four cells meet at a point, as in many lattices, edges and facets of the diagram have no extent, and
// S crosses several edges at one point: the boundary would touch itself there. Moves the sites around such points by a
// millionth of their distance from each other, each in a direction of its own, and builds the diagram anew. Returns the
// number of sites moved.
Index moveToGeneralPosition(std::vector<Vec3>& sites, voronoi::Diagram& diagram, const Box3& domain,
                            const RunContext& context);

}  // namespace voroform::cvt
