// What the writer and the reader of cells.vtu share: names of the arrays and the order of the polyhedra's streams.
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh::vtu {

inline constexpr std::int32_t kFormatVersion = 1;
inline constexpr std::uint8_t kPolyhedronType = 42;

// Field data.
inline constexpr char kFormat[] = "voroform_format";
inline constexpr char kOrigin[] = "origin";
inline constexpr char kFaceOffsets[] = "face_offsets";
inline constexpr char kFaceVertices[] = "face_vertices";
inline constexpr char kFaceCells[] = "face_cells";
inline constexpr char kFaceTags[] = "face_tags";
// Point and cell data; the local ones are present if the origin is not zero, because origin + local rounds.
inline constexpr char kLocal[] = "local";
inline constexpr char kSite[] = "site";
inline constexpr char kSiteLocal[] = "site_local";

inline bool hasOrigin(const Frame& frame) { return (frame.origin.array() != 0).any(); }

// Calls put(vertex) for the distinct vertices of each cell in the order in which its faces name them, and endCell()
// after each cell.
template <class Put, class EndCell>
void emitConnectivity(const PolyhedralComplex& complex, const CellFaces& rows, const Put& put, const EndCell& endCell) {
  std::vector<Index> lastCell(complex.vertices.size(), kNone);
  for (Index cell = 0; cell < complex.cellCount; ++cell) {
    const auto row = static_cast<std::size_t>(cell);
    for (auto k = static_cast<std::size_t>(rows.offsets[row]); k < static_cast<std::size_t>(rows.offsets[row + 1]);
         ++k) {
      for (const Index v : complex.face(rows.faces[k])) {
        Index& last = lastCell[static_cast<std::size_t>(v)];
        if (last == cell) continue;
        last = cell;
        put(v);
      }
    }
    endCell();
  }
}

// Calls put for VTK's face stream of each cell (number of faces, then for each face its size and its vertices,
// counter-clockwise seen from outside the cell), and endCell() after each cell.
template <class Put, class EndCell>
void emitFaces(const PolyhedralComplex& complex, const CellFaces& rows, const Put& put, const EndCell& endCell) {
  for (std::size_t row = 0; row < static_cast<std::size_t>(complex.cellCount); ++row) {
    const auto begin = static_cast<std::size_t>(rows.offsets[row]);
    const auto end = static_cast<std::size_t>(rows.offsets[row + 1]);
    put(static_cast<std::int64_t>(end - begin));
    for (std::size_t k = begin; k < end; ++k) {
      const auto loop = complex.face(rows.faces[k]);
      put(static_cast<std::int64_t>(loop.size()));
      if (rows.sides[k] > 0) {
        for (const Index v : loop) put(v);
      } else {
        for (std::size_t i = loop.size(); i-- > 0;) put(loop[i]);
      }
    }
    endCell();
  }
}

// Ends of the cells' stretches in the two streams: VTK's offsets and faceoffsets.
struct StreamEnds {
  std::vector<std::int64_t> connectivity;
  std::vector<std::int64_t> faces;
};

inline StreamEnds streamEnds(const PolyhedralComplex& complex, const CellFaces& rows) {
  StreamEnds ends;
  ends.connectivity.reserve(static_cast<std::size_t>(complex.cellCount));
  ends.faces.reserve(static_cast<std::size_t>(complex.cellCount));
  std::int64_t count = 0;
  emitConnectivity(
      complex, rows, [&](Index) { ++count; }, [&] { ends.connectivity.push_back(count); });
  count = 0;
  for (std::size_t row = 0; row < static_cast<std::size_t>(complex.cellCount); ++row) {
    ++count;
    for (auto k = static_cast<std::size_t>(rows.offsets[row]); k < static_cast<std::size_t>(rows.offsets[row + 1]);
         ++k) {
      count += 1 + static_cast<std::int64_t>(complex.face(rows.faces[k]).size());
    }
    ends.faces.push_back(count);
  }
  return ends;
}

}  // namespace voroform::mesh::vtu
