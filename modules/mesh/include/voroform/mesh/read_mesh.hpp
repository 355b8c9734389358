// Triangle meshes as inputs: reading, welding, and the examination that a solid's boundary must pass.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "voroform/core/run_context.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {

struct MeshReadSummary {
  std::string format;           // e.g. "STL binary"
  std::uint64_t vertices = 0;   // as the file declares them; of STL three a triangle
  std::uint64_t faces = 0;
  std::uint64_t welded = 0;     // vertices joined with an equal one (STL)
  std::uint64_t degenerate = 0; // faces without area by index (a vertex twice), left out and warned of
  bool turned = false;          // the whole mesh was inside out and was turned
};

struct MeshReadResult {
  TriangleMesh mesh;  // frame.origin at the center of its bounding box, coordinates local to it
  MeshReadSummary summary;
};

// .off, .obj, .ply (ascii, binary both ways), .stl (ascii, binary; equal vertices are welded). Polygons are cut into
// fans. The mesh is examined: closed, 2-manifold, consistently oriented (after turning whole components outward),
// finite. Throws InputError naming the file, the line or record, and the first edge, vertex or face that is at fault;
// allocates nothing for a declared size before the bytes are there.
MeshReadResult readSolidMesh(const std::filesystem::path& path, const RunContext& context);

// Binary little-endian PLY with Float64 coordinates, world frame.
void writeMeshPly(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace voroform::mesh
