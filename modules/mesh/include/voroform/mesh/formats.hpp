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
// field data what readCellsVtu needs to return the same complex bit for bit: local vertices' origin, each face's two
// cells and tag. Points are written in world coordinates.
void writeCellsVtu(const std::filesystem::path& path, const PolyhedralComplex& complex, std::span<const CellData> data);

// Reads what writeCellsVtu wrote. Throws InputError on anything else.
PolyhedralComplex readCellsVtu(const std::filesystem::path& path);

// Surfaces: binary little-endian PLY with Float64 coordinates, OBJ and OFF with 17 digits, binary STL (float32).
void writeSurfacePly(const std::filesystem::path& path, const BoundarySurface& surface, const PolyhedralComplex& complex);
void writeSurfaceObj(const std::filesystem::path& path, const TriangleMesh& mesh);
void writeSurfaceOff(const std::filesystem::path& path, const TriangleMesh& mesh);
void writeSurfaceStl(const std::filesystem::path& path, const TriangleMesh& mesh);

// sites.ply: one vertex a cell, in the cells' order.
void writeSitesPly(const std::filesystem::path& path, std::span<const Vec3> sites, const Frame& frame);

// adjacency.csv: header line, then one row for each interior face i,j,area,nx,ny,nz (unit normal from i to j, i < j) and
// each cell's boundary i,-1,area,nx,ny,nz with the boundary's area vector summed by cell.
void writeAdjacency(const std::filesystem::path& path, const PolyhedralComplex& complex);

}  // namespace voroform::mesh
