// Triangle meshes as inputs: reading, welding, and the examination that a solid's boundary must pass.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <istream>
#include <string>
#include <utility>

#include "voroform/core/error.hpp"
#include "voroform/core/run_context.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {

struct MeshReadSummary {
  std::string format;          // e.g. "STL binary"
  std::uint64_t vertices = 0;  // as the file declares them; of STL three a triangle
  std::uint64_t faces = 0;
  std::uint64_t welded = 0;          // vertices joined with an equal one (STL)
  std::uint64_t degenerate = 0;      // triangles without area by index (a vertex twice), left out and warned of
  std::uint64_t unusedVertices = 0;  // of no face, left out
  std::uint64_t turnedFaces = 0;     // triangles turned to agree with their neighbors or to make a component outward
  Index components = 0;              // by shared edges
  bool turned = false;               // the whole mesh was inside out and was turned
};

// The mesh was read but cannot bound a solid: not closed, not 2-manifold, not orientable, without volume.
struct NotSolid : InputError {
  NotSolid(const std::string& message, MeshReadSummary what) : InputError(message), summary(std::move(what)) {}
  MeshReadSummary summary;
};

struct MeshReadResult {
  TriangleMesh mesh;
  MeshReadSummary summary;
};

// .off, .obj, .ply (ascii, binary both ways), .stl (ascii, binary; equal vertices are welded). Polygons are cut into
// fans. The mesh is examined: closed, 2-manifold, orientable, finite. Faces are turned to agree within each component;
// then components are turned: outward, but inward (as the wall of a void) if they lie within an odd number of others.
// Throws InputError naming the file, the line or record, and the first edge, vertex or face that is at fault (NotSolid
// if what is at fault is not the file but the mesh); allocates nothing for a declared size before the bytes are there.
//
// If the mesh lies far from the origin its frame is shifted to near the center, such that frame and local coordinates
// add up to the file's coordinates bit for bit (as points::prepare does for clouds); else the frame is at the origin.
// A mesh that was read, written by writeMeshPly() and read again is the same bit for bit.
MeshReadResult readSolidMesh(const std::filesystem::path& path, const RunContext& context);

// The same from a stream, which must be able to seek; `format` is the lower-case extension with its dot, `name` stands
// in messages.
MeshReadResult readSolidMesh(std::istream& stream, const std::string& format, const std::string& name,
                             const RunContext& context);

// Whether a file declares faces, by extension and header; false for extensions that are no mesh's. Throws InputError.
bool holdsFaces(const std::filesystem::path& path, const RunContext& context);

// The mesh turned about the center of its bounding box, in a frame as readSolidMesh() chooses it.
TriangleMesh rotated(const TriangleMesh& mesh, const Mat3& rotation);

// Binary little-endian PLY with Float64 coordinates, world frame.
void writeMeshPly(const std::filesystem::path& path, const TriangleMesh& mesh);

struct MeshIntersections {
  std::int64_t pairs = 0;                       // of triangles that meet where they share no vertex or edge
  std::array<Index, 2> first = {kNone, kNone};  // the first pair
};
// Decided exactly; the same for any number of threads.
MeshIntersections meshIntersections(const TriangleMesh& mesh, const RunContext& context);

// V − E + F of a closed mesh whose vertices are all used.
std::int64_t eulerCharacteristic(const TriangleMesh& mesh);

}  // namespace voroform::mesh
