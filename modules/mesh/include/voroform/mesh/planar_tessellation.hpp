// The planar tessellation: a conforming complex of polygonal cells.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::mesh {

// Cells in compressed rows: cell → loops → vertices. Loops run with their cell on the left: counter-clockwise ones are
// outlines (several if the cell is disconnected), clockwise ones are holes. An edge between two cells stands in both,
// in opposite directions between the same two vertices; an edge of the region's boundary stands in one.
struct PlanarTessellation {
  std::vector<Vec2> vertices;
  std::vector<std::uint32_t> cellOffsets = {0};
  std::vector<std::uint32_t> loopOffsets = {0};
  std::vector<Index> loopVertices;
  // The cell across the edge from loopVertices[k] to the next of its loop; kNone: the edge lies on the region's
  // boundary.
  std::vector<Index> neighbors;
  // One a cell; cells without loops are empty.
  std::vector<Vec2> sites;

  Index cellCount() const { return static_cast<Index>(cellOffsets.size()) - 1; }
  std::size_t loopCount() const { return loopOffsets.size() - 1; }
  // Half-open range of the cell's loops.
  std::size_t firstLoop(Index cell) const { return cellOffsets[static_cast<std::size_t>(cell)]; }
  std::size_t endLoop(Index cell) const { return cellOffsets[static_cast<std::size_t>(cell) + 1]; }
  std::span<const Index> loop(std::size_t l) const {
    return {loopVertices.data() + loopOffsets[l], loopOffsets[l + 1] - loopOffsets[l]};
  }
  std::span<const Index> loopNeighbors(std::size_t l) const {
    return {neighbors.data() + loopOffsets[l], loopOffsets[l + 1] - loopOffsets[l]};
  }
};

}  // namespace voroform::mesh
