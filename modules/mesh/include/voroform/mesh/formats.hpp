// File formats of tessellations and surfaces. All writers go through OutputFile: a file appears whole or not at all.
// Coordinates are written in the world frame. The formats are described in docs/formats.md.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {

// A named array with one value a cell, for cells.vtu.
struct CellData {
  std::string name;
  std::vector<double> values;
};

// cells.vtu: VTK's XML unstructured grid, appended raw data, Float64 points, VTK_POLYHEDRON cells with face streams.
// Holds the cell arrays given, the site of each cell as "site" (3 components) if the complex has sites, and in the
// field data what readCellsVtu needs to return the same complex bit for bit: the origin, the faces, their two cells and
// tags. Points are written in world coordinates; where the origin is not zero, the local ones stand beside them as
// "local" and "site_local". The same bytes every time. Throws UsageError if an array has not one value a cell.
void writeCellsVtu(const std::filesystem::path& path, const PolyhedralComplex& complex, std::span<const CellData> data);

// Reads what writeCellsVtu wrote: the field data, against which the polyhedra and world coordinates are checked. Throws
// InputError, with the file and what was found, on anything else; allocates nothing for a declared size before the
// bytes are known to be there.
PolyhedralComplex readCellsVtu(const std::filesystem::path& path);

// Surfaces. PLY is binary, little-endian, with Float64 coordinates and, for each triangle, the cell behind it as "cell"
// (int) and its FaceTag as "tag" (uchar). OBJ and OFF have as many digits as it takes to read the same doubles back
// (at most 17). Warning: STL holds float32, so coordinates are rounded to about 7 digits; far from the origin that
// flattens a surface.
void writeSurfacePly(const std::filesystem::path& path, const BoundarySurface& surface,
                     const PolyhedralComplex& complex);
void writeSurfaceObj(const std::filesystem::path& path, const TriangleMesh& mesh);
void writeSurfaceOff(const std::filesystem::path& path, const TriangleMesh& mesh);
void writeSurfaceStl(const std::filesystem::path& path, const TriangleMesh& mesh);

// sites.ply: one vertex a cell, in the cells' order.
void writeSitesPly(const std::filesystem::path& path, std::span<const Vec3> sites, const Frame& frame);

// adjacency.csv: header line, then one row for each interior face i,j,area,nx,ny,nz (unit normal from i to j, i < j)
// and each cell's boundary i,-1,area,nx,ny,nz with the boundary's area vector summed by cell.
void writeAdjacency(const std::filesystem::path& path, const PolyhedralComplex& complex);

}  // namespace voroform::mesh
