// The Voronoi diagram of sites in the plane, clipped exactly by a region.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/mesh/planar_region.hpp"
#include "voroform/mesh/planar_tessellation.hpp"
#include "voroform/voronoi/site_moments.hpp"

namespace voroform::voronoi {

// Elements are named after their dual: a vertex is the circumcenter of a Delaunay triangle and has three sites; an edge
// is dual to a Delaunay edge and has two.
struct PlanarDiagram {
  // Real sites come first; then the ghosts, so far away that every real cell is finite and none of their cells reaches
  // the domain.
  std::vector<Vec2> sites;
  Index siteCount = 0;

  // Only vertices of real cells. The order depends on the sites alone.
  std::vector<Vec2> vertices;
  std::vector<std::array<Index, 3>> vertexSites;  // a counter-clockwise triangle
  std::vector<std::array<Index, 3>> vertexEdges;  // opposite each site; kNone: not a real cell's

  // Edges between a real site a and a site b > a. Site a lies on the left of the way from the first vertex to the
  // second. Where four or more sites lie on one circle some edges have no length.
  std::vector<std::array<Index, 2>> edgeSites;
  std::vector<std::array<Index, 2>> edgeVertices;

  // Compressed rows from each real site to its edges, counter-clockwise.
  std::vector<std::uint32_t> siteEdgeOffsets;
  std::vector<Index> siteEdges;

  double secondsDelaunay = 0;
  double secondsFlattening = 0;

  Index vertexCount() const { return static_cast<Index>(vertices.size()); }
  Index edgeCount() const { return static_cast<Index>(edgeSites.size()); }
  bool isReal(Index site) const { return site < siteCount; }
  std::span<const Index> edgesOf(Index site) const {
    const auto i = static_cast<std::size_t>(site);
    return {siteEdges.data() + siteEdgeOffsets[i], siteEdgeOffsets[i + 1] - siteEdgeOffsets[i]};
  }
};

// A diagram whose cells are correct within `domain` and wherever sites are. Sites must be distinct and finite, and at
// least one: throws MethodError otherwise. O(n log n).
PlanarDiagram buildPlanarDiagram(std::span<const Vec2> sites, const Box2& domain, const RunContext& context);

// A diagram clipped by a region. Points carry one numbering: the diagram's vertices, then the region's points, then the
// crossings of edges with the region's boundary.
//
// What crosses what is decided exactly, for the sites and the region's points as they are; of ties (a region's point on
// an edge, a region's edge through a vertex or along an edge) the region counts as moved by (ε, ε²) with an infinitely
// small ε > 0. So the cells' shapes are consistent in every case, and only coordinates are rounded.
struct PlanarClip {
  std::vector<std::uint8_t> inside;  // of each diagram vertex
  std::vector<Vec2> points;          // the region's points and the crossings
  std::size_t regionPoints = 0;

  // The edges that the boundary crosses, ascending, and their crossings in order from the edge's first vertex.
  std::vector<Index> cutEdges;
  std::vector<std::uint32_t> cutOffsets;
  std::vector<Index> cutCrossings;  // as points, in the common numbering
  std::vector<Index> cutRows;       // of each edge: its row among the cut ones, or kNone

  // A piece of the region's boundary within one cell, the cell on its left.
  struct Piece {
    Index from = kNone;
    Index to = kNone;
    Index regionEdge = kNone;
  };
  // Compressed rows from each real site to the pieces in its cell.
  std::vector<std::uint32_t> sitePieceOffsets;
  std::vector<Piece> pieces;

  std::span<const Piece> piecesOf(Index site) const {
    const auto i = static_cast<std::size_t>(site);
    return {pieces.data() + sitePieceOffsets[i], sitePieceOffsets[i + 1] - sitePieceOffsets[i]};
  }
  bool touchesBoundary(Index site) const { return !piecesOf(site).empty(); }
  const Vec2& position(const PlanarDiagram& diagram, Index point) const {
    const Index vertices = diagram.vertexCount();
    return point < vertices ? diagram.vertices[static_cast<std::size_t>(point)]
                            : points[static_cast<std::size_t>(point - vertices)];
  }
};

// Clips the diagram by a region within its domain. Time grows with the number of crossings and of the region's points.
PlanarClip clipPlanar(const PlanarDiagram& diagram, const mesh::PlanarRegion& region, const RunContext& context);

// A straight piece of a clipped cell's border, the cell on its left.
struct CellWall {
  Index from = kNone;
  Index to = kNone;
  Index neighbor = kNone;  // the site across it; kNone: the region's boundary
};
// Appends the border of a site's clipped cell to `walls`, in no order: closed loops that reach each of their points
// once and leave it once. Nothing for an empty cell.
void appendCellWalls(const PlanarDiagram& diagram, const PlanarClip& clip, Index site, std::vector<CellWall>& walls);

// Mass, first and second moment of each clipped cell about its site, for the density 1; exact up to rounding. Zero for
// empty cells.
std::vector<Moments<2>> planarMoments(const PlanarDiagram& diagram, const PlanarClip& clip, const RunContext& context);

// The clipped cells, one a site, in the sites' order.
mesh::PlanarTessellation toTessellation(const PlanarDiagram& diagram, const PlanarClip& clip,
                                        const RunContext& context);

// The pairs a < b of real sites, ascending, whose common edge keeps a piece inside the region. Of sites on one circle
// around a point inside, pairs with an edge without length are among them: they are Delaunay edges too.
std::vector<std::array<Index, 2>> neighborPairs(const PlanarDiagram& diagram, const PlanarClip& clip);

}  // namespace voroform::voronoi
