// Topology of the faces of a complex, by indices alone.
#pragma once

#include <cstdint>

#include "voroform/core/run_context.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {

// A number of violations and the first element concerned.
struct Violations {
  Index count = 0;
  Index first = kNone;
  void add(Index element) {
    if (count++ == 0) first = element;
  }
};

// Cells with a directed edge that its opposite does not cancel. Indices must be in range.
Violations openCells(const PolyhedralComplex& complex, const CellFaces& rows, const RunContext& context);

struct BoundaryTopology {
  Violations nonManifoldEdges;     // elements: one of the edge's vertices
  Violations nonManifoldVertices;  // elements: the vertex
  Violations inconsistentEdges;    // elements: one of the edge's vertices
  Index components = 0;
  std::int64_t eulerCharacteristic = 0;
};

BoundaryTopology boundaryTopology(const PolyhedralComplex& complex);

}  // namespace voroform::mesh
