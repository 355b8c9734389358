// The Voronoi diagram of sites in space, flattened into arrays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"

namespace voroform::voronoi {

// Elements are named after their dual: a diagram vertex is the circumcenter of a Delaunay tetrahedron and has four
// sites; a diagram edge is dual to a Delaunay triangle and has three; a facet is dual to a Delaunay edge and has two.
// An edge has no index of its own: it is (vertex, slot), the edge to vertexNeighbors[vertex][slot], and its three sites
// are the vertex's without vertexSites[vertex][slot].
struct Diagram {
  // Real sites come first; then the ghost sites, so far away that every real cell is finite and none of their cells
  // reaches the domain.
  std::vector<Vec3> sites;
  Index siteCount = 0;

  // Only vertices of real cells. The order depends on the sites alone.
  std::vector<Vec3> vertices;
  std::vector<std::array<Index, 4>> vertexSites;  // a tetrahedron of positive orientation
  std::vector<std::array<Index, 4>>
      vertexNeighbors;  // across the triangle opposite each site; kNone: not a real cell's

  // Facets between a real site a and a site b > a. The loop is counter-clockwise seen from b.
  std::vector<std::array<Index, 2>> facetSites;
  std::vector<std::uint32_t> facetOffsets;
  std::vector<Index> facetVertices;

  // Compressed rows from each real site to its facets.
  std::vector<std::uint32_t> siteFacetOffsets;
  std::vector<Index> siteFacets;

  // Seconds of the Delaunay triangulation, and of all that follows it.
  double secondsDelaunay = 0;
  double secondsFlattening = 0;

  Index vertexCount() const { return static_cast<Index>(vertices.size()); }
  Index facetCount() const { return static_cast<Index>(facetSites.size()); }
  bool isReal(Index site) const { return site < siteCount; }
  std::span<const Index> facet(Index f) const {
    const auto i = static_cast<std::size_t>(f);
    return {facetVertices.data() + facetOffsets[i], facetOffsets[i + 1] - facetOffsets[i]};
  }
  std::span<const Index> facetsOf(Index site) const {
    const auto i = static_cast<std::size_t>(site);
    return {siteFacets.data() + siteFacetOffsets[i], siteFacetOffsets[i + 1] - siteFacetOffsets[i]};
  }
  // The slot of `vertex` whose neighbor is `neighbor`.
  int slotOf(Index vertex, Index neighbor) const {
    const auto& neighbors = vertexNeighbors[static_cast<std::size_t>(vertex)];
    for (int slot = 0; slot < 3; ++slot) {
      if (neighbors[static_cast<std::size_t>(slot)] == neighbor) return slot;
    }
    return 3;
  }
};

// A diagram of the sites, whose cells are correct within `domain`: the ghosts lie more than three of its radii away.
// Sites must be distinct, finite, inside the domain; throws MethodError otherwise. Fastest if neighbors in the list are
// neighbors in space (see spatialOrder). O(n log n) time, less than 1.3 kB a site.
Diagram buildDiagram(std::span<const Vec3> sites, const Box3& domain, const RunContext& context);

// A permutation of the points that puts neighbors in space near each other (Hilbert's curve).
std::vector<Index> spatialOrder(std::span<const Vec3> points);

}  // namespace voroform::voronoi
