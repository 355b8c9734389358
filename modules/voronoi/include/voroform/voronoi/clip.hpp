// Clipping a Voronoi diagram by an implicit function (thesis 5.2.2, made conforming).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/implicit/roots.hpp"
#include "voroform/implicit/surface_fit.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"
#include "voroform/voronoi/diagram.hpp"
#include "voroform/voronoi/site_moments.hpp"

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
  // Move the boundary's vertices off S to where its triangles follow S best in the mean square, each along the one
  // direction that keeps the complex conforming: cvt4 is cvt3 fitted. Not for CapKind::flat.
  bool fit = false;
  implicit::FitOptions fitOptions = {};
};

// What was done, and every fallback that was taken.
struct ClipSummary {
  Index boundaryCells = 0;  // cells with at least one cap
  Index roots = 0;
  Index doubleRootEdges = 0;     // diagram edges that S crosses more than once
  Index loops = 0;               // caps
  Index multiLoopCells = 0;      // cells with several loops
  Index capPoints = 0;           // extra points tried on caps (cvt2, cvt3)
  Index chordPoints = 0;         // extra points tried on chords (cvt3)
  Index tonguePoints = 0;        // points where parts thinner than a cell end within facets (any cap)
  Index tips = 0;                // of the points on caps and chords, those at the tip of a thin part (cvt2, cvt3)
  Index unprojectedPoints = 0;   // of points on caps and chords, those left where they were
  Index fallbackCaps = 0;        // caps made in another way than asked for
  Index crossingCells = 0;       // cells whose caps cross in spite of every fallback: the certificate will say so
  Index fittedPoints = 0;        // boundary vertices that the fit moved
  Index unfittedPoints = 0;      // of those it could move, left where they were to keep an embedding rule
  implicit::FitSummary fit;      // of the least-squares fit
  std::int64_t evaluations = 0;  // of f at single points, root finding and probes included
  double oracleShare = 0;        // share of the diagram's vertices whose sign the oracle decided
};

// One piece of the surface within a facet: it links the root where the facet's border leaves the solid to the one where
// it enters again. The facet's polygon runs from `leave` to `enter`, as seen from the facet's second site.
struct Chord {
  Index leave = kNone;
  Index enter = kNone;
  Index facet = kNone;
  Index point = kNone;  // the extra point between the two (cvt3), or kNone
};

// A diagram clipped by f. Points carry one numbering: the diagram's vertices first, then `points` in their order
// (roots, then tongue points, then chord points). Tongue points stand where the solid, met by a single edge of a facet,
// ends within the facet; every kind of cap has them, and they are ends of chords. Facets have two owners, so what is
// decided for a facet is the same for both cells.
struct ClippedDiagram {
  std::vector<std::uint8_t> inside;  // of each diagram vertex: 1 where f < 0
  std::vector<Vec3> points;
  Index rootCount = 0;
  std::vector<std::array<Index, 3>> rootSites;  // the three sites of each root's edge, ascending
  // The two diagram vertices of each root's edge; roots of one edge stand in a row, in their order from the first.
  std::vector<std::array<Index, 2>> rootEnds;
  std::vector<Index> chordPointFacets;  // of each point after the roots: the facet that it lies in

  // What the solid keeps of each facet.
  enum class FacetState : std::uint8_t { outside, whole, cut };
  std::vector<FacetState> facetStates;
  // The polygons that cut facets keep, in compressed rows, by ascending facet; counter-clockwise like the facet's loop.
  std::vector<Index> polygonFacets;
  std::vector<std::uint32_t> polygonOffsets;
  std::vector<Index> polygonPoints;

  std::vector<Chord> chords;

  // Closed loops of chords, by ascending site, each counter-clockwise seen from outside the solid; a loop of two
  // coincident chords is left out. Rows: sites with loops → loops → points.
  std::vector<Index> loopSites;
  std::vector<std::uint32_t> loopOffsets;
  std::vector<Index> loopPoints;

  ClipSummary summary;

  Index loopCount() const { return static_cast<Index>(loopSites.size()); }
  std::span<const Index> loop(Index l) const {
    const auto i = static_cast<std::size_t>(l);
    return {loopPoints.data() + loopOffsets[i], loopOffsets[i + 1] - loopOffsets[i]};
  }
  Index polygonCount() const { return static_cast<Index>(polygonFacets.size()); }
  std::span<const Index> polygon(Index p) const {
    const auto i = static_cast<std::size_t>(p);
    return {polygonPoints.data() + polygonOffsets[i], polygonOffsets[i + 1] - polygonOffsets[i]};
  }
  const Vec3& position(const Diagram& diagram, Index point) const {
    const Index vertices = diagram.vertexCount();
    return point < vertices ? diagram.vertices[static_cast<std::size_t>(point)]
                            : points[static_cast<std::size_t>(point - vertices)];
  }
};

// Clips the diagram: signs, roots, facet polygons, chords (with their points for cvt3) and loops. The caps themselves
// are made by toComplex; siteMoments closes the loops by flat caps.
ClippedDiagram clip(const Diagram& diagram, const implicit::ImplicitFunction& f, const ClipOptions& options,
                    const RunContext& context);

// The complex of the clipped cells, caps of the kind asked for; cell i belongs to cellSites[i], in the sites' order.
// Sites without a cell have none; their number is the difference of sites and cells. Completes `clipped.summary`.
mesh::PolyhedralComplex toComplex(const Diagram& diagram, ClippedDiagram& clipped, const implicit::ImplicitFunction& f,
                                  const Frame& frame, const ClipOptions& options, const RunContext& context);

// Mass, first and second moment of each clipped cell about its site, loops closed by flat caps: all that the energy and
// its gradient need.
std::vector<SiteMoments> siteMoments(const Diagram& diagram, const ClippedDiagram& clipped, const RunContext& context);

}  // namespace voroform::voronoi
