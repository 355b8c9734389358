// How the zero set of a trilinear function cuts a cube: decisions on the faces and in the interior, and the loops in
// which the cut meets the cube's border. Everything is derived from the values at the corners; there is no case table.
//
// Corner c of the unit cube has the coordinates (c & 1, c >> 1 & 1, c >> 2). Edge 4·axis + u + 2v runs along `axis` and
// lies at u along the next axis and at v along the one after it (cyclically). Face 2·axis + side is perpendicular to
// `axis`.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "voroform/core/types.hpp"

namespace voroform::baselines {

// The corners of each face, counter-clockwise seen from outside the cube.
inline constexpr std::array<std::array<std::uint8_t, 4>, 6> kFaceCorners = {
    {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

// The lower corner of an edge; the upper one has the bit of the edge's axis set as well.
constexpr int lowerCorner(int edge) {
  const int axis = edge / 4;
  const int u = edge & 1;
  const int v = edge >> 1 & 1;
  return u << (axis + 1) % 3 | v << (axis + 2) % 3;
}
constexpr int upperCorner(int edge) { return lowerCorner(edge) | 1 << edge / 4; }

// The edge between two corners that differ in one bit.
constexpr int edgeBetween(int a, int b) {
  const int difference = a ^ b;
  const int axis = difference == 1 ? 0 : (difference == 2 ? 1 : 2);
  return 4 * axis + (a >> (axis + 1) % 3 & 1) + 2 * (a >> (axis + 2) % 3 & 1);
}

// The two faces at an edge, as bits.
constexpr unsigned facesOfEdge(int edge) {
  const int axis = edge / 4;
  return 1U << (2 * ((axis + 1) % 3) + (edge & 1)) | 1U << (2 * ((axis + 2) % 3) + (edge >> 1 & 1));
}

struct CubeTopology {
  std::uint8_t insideCorners = 0;   // bits
  std::uint8_t ambiguousFaces = 0;  // bits: faces whose signs alternate
  std::uint8_t joinedFaces = 0;     // of them, those on which the inside corners are joined
  // Loops of cut edges, one after the other; the solid lies on the side for which the loop runs counter-clockwise seen
  // from outside the solid.
  std::array<std::uint8_t, 12> loopEdges = {};
  std::array<std::uint8_t, 6> loopOffsets = {};
  std::uint8_t loopCount = 0;
  // The two loops that one piece of the surface, an annulus, joins, or −1: then each loop bounds a disk.
  std::array<std::int8_t, 2> tunnelLoops = {-1, -1};
  bool tunnelInside = false;     // the solid passes through the tunnel, not the exterior
  std::uint8_t insideParts = 0;  // of the solid in the cube

  bool hasTunnel() const { return tunnelLoops[0] >= 0; }
  std::span<const std::uint8_t> loop(int l) const {
    return {loopEdges.data() + loopOffsets[static_cast<std::size_t>(l)],
            static_cast<std::size_t>(loopOffsets[static_cast<std::size_t>(l) + 1] -
                                     loopOffsets[static_cast<std::size_t>(l)])};
  }
};

// On a face whose signs alternate around it: whether its two inside corners (values insideA, insideB) are joined, by
// the sign at the saddle of the bilinear interpolant (the asymptotic decider, Nielson & Hamann 1991). A saddle at zero
// counts as outside. The order of the corners does not matter to the last bit, so both cubes of a face agree.
inline bool insideJoined(double insideA, double insideB, double outsideA, double outsideB) {
  return insideA * insideB > outsideA * outsideB;
}

CubeTopology analyzeCube(std::span<const double, 8> values);

// The base case, 0 … 14, of Lorensen & Cline (1987) and Chernyaev (1995), of a set of inside corners.
int baseCase(unsigned insideCorners);

}  // namespace voroform::baselines
