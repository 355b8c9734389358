// The certificate of validity of a planar tessellation: an independent examination. Shares no code with the clipping.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/mesh/planar_region.hpp"
#include "voroform/mesh/planar_tessellation.hpp"

namespace voroform::mesh {

struct PlanarValidateOptions {
  // Random points of the point-location test; 0 skips it.
  Index pointSamples = 20000;
  std::uint64_t seed = 0;
};

struct PlanarCertificate {
  bool valid = false;

  // Violations counted; all must be 0.
  Index invalidLoops = 0;       // fewer than three vertices, a vertex twice, an index or a neighbor out of range
  Index nonFiniteVertices = 0;  // sites included
  Index unmatchedEdges = 0;     // edges to a neighbor that has not the opposite edge back to the cell, once
  Index openVertices = 0;       // vertices where not as many boundary edges begin as end, or several
  Index strayEdges = 0;         // boundary edges with an end or their middle off the region's boundary
  Index nonPositiveAreas = 0;   // cells whose area is not > 0

  // The boundary edges' loops against the region's rings, matched by length.
  Index boundaryLoops = 0;
  Index rings = 0;
  double boundaryError = 0;  // largest |loop − ring| / ring, of their lengths

  Index pointSamples = 0;     // random points located
  Index pointViolations = 0;  // of them not in exactly one cell inside the region, not in none outside, or nearer to
                              // the site of a neighbor of their cell than to that of the cell

  double area = 0;       // of all cells
  double areaError = 0;  // |area − region's| / region's

  // One line for each kind of violation, naming the first element found.
  std::vector<std::string> problems;

  // Each edge has its opposite, and the boundary's edges close.
  bool closed() const { return unmatchedEdges == 0 && openVertices == 0; }
};

// areaError and boundaryError above this are violations; off the boundary is what is farther than this share of the
// bounding box's diagonal and the rounding of coordinates.
inline constexpr double kPlanarConsistency = 1e-9;

// Never throws on a bad tessellation, whatever is wrong with it: it reports.
PlanarCertificate validate(const PlanarTessellation& tessellation, const PlanarRegion& region,
                           const PlanarValidateOptions& options, const RunContext& context);

}  // namespace voroform::mesh
