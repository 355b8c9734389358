#include "voroform/mesh/polyhedral_complex.hpp"

#include "voroform/core/parallel.hpp"

namespace voroform::mesh {

void PolyhedralComplex::addFace(std::span<const Index> loop, Index behind, Index ahead, FaceTag tag) {
  faceVertices.insert(faceVertices.end(), loop.begin(), loop.end());
  faceOffsets.push_back(static_cast<std::int64_t>(faceVertices.size()));
  faceCells.push_back({behind, ahead});
  faceTags.push_back(tag);
}

CellFaces cellFaces(const PolyhedralComplex& complex) {
  CellFaces result;
  result.offsets.assign(static_cast<std::size_t>(complex.cellCount), 0);
  for (const auto& cells : complex.faceCells) {
    for (const Index cell : cells) {
      if (cell != kNone) ++result.offsets[static_cast<std::size_t>(cell)];
    }
  }
  exclusiveScan(result.offsets);
  const auto total = static_cast<std::size_t>(result.offsets.back());
  result.faces.resize(total);
  result.sides.resize(total);
  std::vector<std::int64_t> next(result.offsets.begin(), result.offsets.end() - 1);
  for (std::size_t f = 0; f < complex.faceCells.size(); ++f) {
    for (std::size_t side = 0; side < 2; ++side) {
      const Index cell = complex.faceCells[f][side];
      if (cell == kNone) continue;
      const auto slot = static_cast<std::size_t>(next[static_cast<std::size_t>(cell)]++);
      result.faces[slot] = static_cast<Index>(f);
      result.sides[slot] = static_cast<std::int8_t>(side == 0 ? 1 : -1);
    }
  }
  return result;
}

BoundarySurface boundarySurface(const PolyhedralComplex& complex) {
  BoundarySurface surface;
  surface.mesh.frame = complex.frame;
  // First mark the vertices in use, then number them in their own order: neighbors in memory stay neighbors.
  std::vector<Index> renumbered(complex.vertices.size(), kNone);
  std::size_t triangles = 0;
  for (Index f = 0; f < complex.faceCount(); ++f) {
    if (!complex.isBoundary(f)) continue;
    const auto loop = complex.face(f);
    for (const Index v : loop) renumbered[static_cast<std::size_t>(v)] = 0;
    if (loop.size() > 2) triangles += loop.size() - 2;
  }
  for (std::size_t v = 0; v < renumbered.size(); ++v) {
    if (renumbered[v] == kNone) continue;
    renumbered[v] = static_cast<Index>(surface.mesh.vertices.size());
    surface.mesh.vertices.push_back(complex.vertices[v]);
  }
  surface.mesh.triangles.reserve(triangles);
  surface.sourceFaces.reserve(triangles);
  for (Index f = 0; f < complex.faceCount(); ++f) {
    if (!complex.isBoundary(f)) continue;
    const auto loop = complex.face(f);
    for (std::size_t i = 2; i < loop.size(); ++i) {
      surface.mesh.triangles.push_back({renumbered[static_cast<std::size_t>(loop[0])],
                                        renumbered[static_cast<std::size_t>(loop[i - 1])],
                                        renumbered[static_cast<std::size_t>(loop[i])]});
      surface.sourceFaces.push_back(f);
    }
  }
  return surface;
}

}  // namespace voroform::mesh
