// The parts of reading meshes: formats, and the examination.
#pragma once

#include <cstdint>
#include <istream>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "voroform/core/byte_source.hpp"
#include "voroform/mesh/read_mesh.hpp"

namespace voroform::mesh {

// What a file holds, cut into triangles and not yet examined. World coordinates.
struct RawMesh {
  TriangleMesh mesh;
  std::vector<Index> faces;  // for each triangle the number of the file's face, from 0
  MeshReadSummary summary;
  // What the first vertex is numbered in the file, or kNone if it numbers none (STL).
  Index firstNumber = 0;
};

class MeshBuilder {
 public:
  MeshBuilder(const ByteSource& source, RawMesh& raw) : source_(source), raw_(raw) {}
  void addVertex(const Vec3& position);
  // Cuts the polygon into a fan; leaves out triangles that name a vertex twice. Indices must be in range.
  void addFace(std::span<const Index> corners);
  std::size_t vertices() const { return raw_.mesh.vertices.size(); }

 private:
  const ByteSource& source_;
  RawMesh& raw_;
};

RawMesh readOffMesh(ByteSource& source);
RawMesh readObjMesh(ByteSource& source);
RawMesh readPlyMesh(ByteSource& source);
// The stream that the source reads from tells by its length whether an STL file is text.
bool isBinaryStl(std::istream& stream);
RawMesh readStlMesh(ByteSource& source, bool binary);

// Makes the mesh a solid's boundary: see readSolidMesh(). `name` stands in messages.
void makeSolid(RawMesh& raw, const std::string& name, const RunContext& context);

}  // namespace voroform::mesh
