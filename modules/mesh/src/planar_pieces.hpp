// Simple polygons that cells are made of, for formats whose polygons have neither holes nor several outlines.
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/mesh/planar_tessellation.hpp"

namespace voroform::mesh {

struct PlanarPieces {
  std::vector<Vec2> points;  // the tessellation's vertices, then points where rounded loops of one cell cross
  // Polygons in compressed rows, counter-clockwise, as VTK has them: the end of each in `connectivity`.
  std::vector<std::int64_t> connectivity;
  std::vector<std::int64_t> ends;
  std::vector<Index> cells;  // of each polygon
};

// In the cells' order. Each outline of a cell without holes is a polygon; a cell with holes is triangulated.
PlanarPieces planarPieces(const PlanarTessellation& tessellation);

}  // namespace voroform::mesh
