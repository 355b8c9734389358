// Where the surface crosses the edges of a diagram.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {

// Signs of f at the diagram's vertices and its roots along the edges.
struct EdgeRoots {
  std::vector<std::uint8_t> inside;   // of each vertex
  std::vector<std::uint8_t> touched;  // of each vertex: 1 if one of its edges has roots
  // crossedEdge[4·vertex + slot] is the crossed edge's number, seen from both ends, or kNone. Empty rows are common, so
  // ask `touched` first.
  std::vector<Index> crossedEdge;
  std::vector<std::uint32_t> rootOffsets;  // of each crossed edge, in the order from its lower to its higher vertex
  std::vector<Vec3> positions;
  std::vector<std::array<Index, 3>> sites;  // of each root's edge, ascending
  std::vector<std::array<Index, 2>> ends;   // of each root's edge: its diagram vertices, in the order of its roots

  std::int64_t evaluations = 0;
  Index doubleRootEdges = 0;
  double oracleShare = 0;
};

EdgeRoots findEdgeRoots(const Diagram& diagram, const implicit::ImplicitFunction& f, const ClipOptions& options,
                        const RunContext& context);

}  // namespace voroform::voronoi
