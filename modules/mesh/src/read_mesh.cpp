#include "voroform/mesh/read_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "read_mesh.hpp"
#include "self_intersections.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/mesh/off_header.hpp"
#include "voroform/mesh/ply_header.hpp"

namespace voroform::mesh {

namespace {

bool isKnown(const std::string& format) {
  return format == ".off" || format == ".obj" || format == ".ply" || format == ".stl";
}

void requireKnown(const std::string& format, const std::string& name) {
  if (isKnown(format)) return;
  throw InputError(name + ": expected the extension .off, .obj, .ply or .stl of a mesh, found " + quotedToken(format));
}

RawMesh readRaw(std::istream& stream, const std::string& format, const std::string& name, const RunContext& context) {
  const bool binary = format == ".stl" && isBinaryStl(stream);
  ByteSource source(stream, name, context);
  if (format == ".off") return readOffMesh(source);
  if (format == ".obj") return readObjMesh(source);
  if (format == ".ply") return readPlyMesh(source);
  return readStlMesh(source, binary);
}

Box3 boxOf(const TriangleMesh& mesh) {
  Box3 box;
  for (const Vec3& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

// As points::prepare shifts clouds: the origin is a multiple of the power of two below the diagonal, on axes whose
// center is farther out than two diagonals. Coordinate and origin then differ by less than a factor of two, so that
// their difference is exact (Sterbenz's lemma).
void shiftFrame(TriangleMesh& mesh) {
  constexpr double kFarDiagonals = 16.0;
  const Box3 box = boxOf(mesh);
  const double diagonal = box.diagonal().norm();
  const Vec3 center = 0.5 * box.min() + 0.5 * box.max();
  if (!(center.norm() > kFarDiagonals * diagonal)) return;
  const double unit = std::exp2(std::floor(std::log2(diagonal)));
  Vec3 shift = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(center[axis]) > 2 * diagonal) shift[axis] = std::nearbyint(center[axis] / unit) * unit;
  }
  for (Vec3& vertex : mesh.vertices) vertex -= shift;
  mesh.frame.origin += shift;
}

}  // namespace

MeshReadResult readSolidMesh(std::istream& stream, const std::string& format, const std::string& name,
                             const RunContext& context) {
  requireKnown(format, name);
  RawMesh raw = readRaw(stream, format, name, context);
  makeSolid(raw, name, context);
  shiftFrame(raw.mesh);
  return {std::move(raw.mesh), std::move(raw.summary)};
}

MeshReadResult readSolidMesh(const std::filesystem::path& path, const RunContext& context) {
  requireRegularFile(path);
  const std::string format = lowerCaseExtension(path);
  requireKnown(format, path.string());  // a wrong extension is told before a file that cannot be opened
  std::ifstream stream = openInputFile(path);
  return readSolidMesh(stream, format, path.string(), context);
}

bool holdsFaces(const std::filesystem::path& path, const RunContext& context) {
  const std::string format = lowerCaseExtension(path);
  if (!isKnown(format)) return false;
  std::ifstream stream = openInputFile(path);
  if (format == ".obj" || format == ".stl") return true;
  ByteSource source(stream, path.string(), context);
  if (format == ".off") return readOffHeader(source).faces > 0;
  const PlyHeader header = readPlyHeader(source);
  return std::any_of(header.elements.begin(), header.elements.end(), [](const PlyElement& element) {
    return (element.name == "face" || element.name == "tristrips") && element.count > 0;
  });
}

TriangleMesh rotated(const TriangleMesh& mesh, const Mat3& rotation) {
  TriangleMesh result = mesh;
  const Box3 box = boxOf(mesh);
  const Vec3 center = 0.5 * box.min() + 0.5 * box.max();
  for (Vec3& vertex : result.vertices) vertex = mesh.frame.origin + (center + rotation * (vertex - center));
  result.frame = Frame();
  shiftFrame(result);
  return result;
}

MeshIntersections meshIntersections(const TriangleMesh& mesh, const RunContext& context) {
  const SelfIntersections found = selfIntersections(mesh, context);
  return {found.pairs, found.first};
}

std::int64_t eulerCharacteristic(const TriangleMesh& mesh) {
  // A closed mesh has three edges for two triangles.
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  return static_cast<std::int64_t>(mesh.vertices.size()) - triangles * 3 / 2 + triangles;
}

}  // namespace voroform::mesh
