// The certificate of validity: an independent examination of a complex. Shares no code with the clipping.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {

struct ValidateOptions {
  // Random points of the point-location test; 0 skips it.
  Index pointSamples = 20000;
  // Examine the boundary for self-intersections.
  bool selfIntersections = true;
  std::uint64_t seed = 0;
};

struct Certificate {
  bool valid = false;

  // Combinatorial: violations counted; all must be 0.
  Index openCells = 0;            // cells with a directed edge that its opposite does not cancel
  Index nonManifoldEdges = 0;     // boundary edges without exactly two boundary faces
  Index nonManifoldVertices = 0;  // boundary vertices whose faces form more than one fan
  Index inconsistentEdges = 0;    // boundary edges that both faces run through in the same direction
  Index invalidFaces = 0;  // fewer than three vertices, a vertex twice, indices or cells out of range, behind = ahead
  Index nonFiniteVertices = 0;
  Index nonPositiveVolumes = 0;  // cells whose volume is not > 0
  bool outward = false;          // the boundary encloses a positive volume

  // Geometric.
  Index selfIntersections = -1;  // pairs of boundary triangles that intersect; -1: not examined
  Index pointSamples = 0;        // random points located
  Index pointViolations = 0;     // of them in several cells, or inside the boundary and in no cell, or the reverse
  double volume = 0;             // enclosed by the boundary
  double volumeError = 0;        // |Σ cell volumes − enclosed volume| / enclosed volume

  // Topology of the boundary.
  Index components = 0;
  std::int64_t eulerCharacteristic = 0;

  // One line for each kind of violation, naming the first element found.
  std::vector<std::string> problems;

  bool closedCells() const { return openCells == 0; }
  bool manifoldBoundary() const { return nonManifoldEdges == 0 && nonManifoldVertices == 0; }
  bool oriented() const { return inconsistentEdges == 0 && outward; }
};

// volumeError above this is a violation.
inline constexpr double kVolumeConsistency = 1e-9;

// Never throws on a bad complex, whatever is wrong with it: it reports.
Certificate validate(const PolyhedralComplex& complex, const ValidateOptions& options, const RunContext& context);

}  // namespace voroform::mesh
