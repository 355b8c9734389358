// Clipping a Voronoi diagram by an implicit function (thesis 5.2.2, made conforming).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/implicit/roots.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::voronoi {

// How a loop of chords around a cell's cut is closed.
enum class CapKind {
  flat,  // a fan about the loop's centroid: no evaluation of f; used while optimizing
  cvt1,  // the convex hull's faces over the loop (thesis 5.2.2.2)
  cvt2,  // a fan about the point where the cap's normal through its centroid meets S (thesis 5.2.2, step 2c)
  cvt3,  // as cvt2, and each chord gets the point where S meets its facet's plane
};

struct ClipOptions {
  CapKind cap = CapKind::cvt3;
  implicit::RootFinder rootFinder = implicit::RootFinder::itp;
  // Relative to the diagram edge: width of the bracket at which root finding stops.
  double rootTolerance = 1e-12;
};

// What was done, and every fallback that was taken.
struct ClipSummary {
  Index boundaryCells = 0;       // cells with at least one cap
  Index roots = 0;
  Index doubleRootEdges = 0;     // diagram edges that S crosses more than once
  Index loops = 0;               // caps
  Index multiLoopCells = 0;      // cells with several loops
  Index capPoints = 0;           // extra points tried on caps (cvt2, cvt3)
  Index chordPoints = 0;         // extra points tried on chords (cvt3)
  Index unprojectedPoints = 0;   // of both, those left where they were
  Index fallbackCaps = 0;        // caps made in another way than asked for
  std::int64_t evaluations = 0;  // of f at single points, root finding and probes included
  double oracleShare = 0;        // share of the diagram's vertices whose sign the oracle decided
};

}  // namespace voroform::voronoi
