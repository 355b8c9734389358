// The volumetric tessellation that every method returns: a conforming complex of polyhedral cells.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::mesh {

// What a face of the boundary follows.
enum class FaceTag : std::uint8_t {
  surface,   // the surface S, or an interior face
  envelope,  // the envelope that closes an open scan: no measured surface
};

// Faces are shared: the two cells of an interior face see the same loop of vertices, one from each side. A cell is the
// set of faces that name it; it need be neither convex nor connected.
struct PolyhedralComplex {
  // Local coordinates; world = frame.origin + local.
  std::vector<Vec3> vertices;
  Frame frame;

  // Face f's loop is faceVertices[faceOffsets[f] … faceOffsets[f + 1]), counter-clockwise seen from the cell ahead.
  std::vector<std::int64_t> faceOffsets = {0};
  std::vector<Index> faceVertices;
  // (behind, ahead): the face's normal points from the first to the second; ahead = kNone on the boundary. Only
  // boundary faces name the exterior, and never as the cell behind.
  std::vector<std::array<Index, 2>> faceCells;
  std::vector<FaceTag> faceTags;

  Index cellCount = 0;
  // The cells' sites (local coordinates), or empty if the method has none.
  std::vector<Vec3> cellSites;

  Index faceCount() const { return static_cast<Index>(faceCells.size()); }
  std::span<const Index> face(Index f) const {
    const auto begin = static_cast<std::size_t>(faceOffsets[static_cast<std::size_t>(f)]);
    const auto end = static_cast<std::size_t>(faceOffsets[static_cast<std::size_t>(f) + 1]);
    return {faceVertices.data() + begin, end - begin};
  }
  bool isBoundary(Index f) const { return faceCells[static_cast<std::size_t>(f)][1] == kNone; }
  void addFace(std::span<const Index> loop, Index behind, Index ahead, FaceTag tag = FaceTag::surface);
};

// Compressed rows from each cell to its faces. sides[k] is +1 where the cell lies behind faces[k] (the loop is then
// counter-clockwise seen from outside the cell), -1 where it lies ahead.
struct CellFaces {
  std::vector<std::int64_t> offsets;
  std::vector<Index> faces;
  std::vector<std::int8_t> sides;
};
CellFaces cellFaces(const PolyhedralComplex& complex);

// Triangles with indexed vertices, counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<Index, 3>> triangles;
  Frame frame;
};

// The boundary of a complex: its faces without a cell ahead; polygons with more than three vertices are cut into fans.
// sourceFaces[t] is the face that triangle t comes from; vertices unused by the boundary are left out.
struct BoundarySurface {
  TriangleMesh mesh;
  std::vector<Index> sourceFaces;
};
BoundarySurface boundarySurface(const PolyhedralComplex& complex);

}  // namespace voroform::mesh
