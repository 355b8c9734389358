// Surfaces and points: PLY, OBJ, OFF, STL.
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>

#include "voroform/core/output_file.hpp"
#include "voroform/mesh/formats.hpp"
#include "voroform/mesh/read_mesh.hpp"

namespace voroform::mesh {

namespace {

static_assert(std::endian::native == std::endian::little, "PLY and STL are written as the machine's own bytes");

template <class T>
void put(std::string& bytes, const T& value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

void putPoint(std::string& bytes, const Vec3& point) {
  for (const double x : point) put(bytes, x);
}

void putNumber(std::string& text, double value) {
  char digits[32];
  const auto result = std::to_chars(digits, digits + sizeof(digits), value);
  text.append(digits, result.ptr);
}

void putNumber(std::string& text, Index value) {
  char digits[16];
  const auto result = std::to_chars(digits, digits + sizeof(digits), value);
  text.append(digits, result.ptr);
}

void putPointLine(std::string& text, const Vec3& point) {
  putNumber(text, point[0]);
  text += ' ';
  putNumber(text, point[1]);
  text += ' ';
  putNumber(text, point[2]);
  text += '\n';
}

void save(const std::filesystem::path& path, const std::string& bytes) {
  OutputFile file(path);
  file.stream().write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  file.commit();
}

std::string plyStart(std::size_t vertices) {
  return "ply\nformat binary_little_endian 1.0\ncomment written by voroform\nelement vertex " +
         std::to_string(vertices) + "\nproperty double x\nproperty double y\nproperty double z\n";
}

}  // namespace

void writeSurfacePly(const std::filesystem::path& path, const BoundarySurface& surface,
                     const PolyhedralComplex& complex) {
  const TriangleMesh& mesh = surface.mesh;
  std::string bytes = plyStart(mesh.vertices.size()) + "element face " + std::to_string(mesh.triangles.size()) +
                      "\nproperty list uchar int vertex_indices\nproperty int cell\nproperty uchar tag\nend_header\n";
  bytes.reserve(bytes.size() + mesh.vertices.size() * 24 + mesh.triangles.size() * 18);
  for (const Vec3& vertex : mesh.vertices) putPoint(bytes, mesh.frame.origin + vertex);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto face = static_cast<std::size_t>(surface.sourceFaces[t]);
    put(bytes, std::uint8_t{3});
    for (const Index v : mesh.triangles[t]) put(bytes, v);
    put(bytes, complex.faceCells[face][0]);
    put(bytes, static_cast<std::uint8_t>(complex.faceTags[face]));
  }
  save(path, bytes);
}

void writeMeshPly(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string bytes = plyStart(mesh.vertices.size()) + "element face " + std::to_string(mesh.triangles.size()) +
                      "\nproperty list uchar int vertex_indices\nend_header\n";
  bytes.reserve(bytes.size() + mesh.vertices.size() * 24 + mesh.triangles.size() * 13);
  for (const Vec3& vertex : mesh.vertices) putPoint(bytes, mesh.frame.origin + vertex);
  for (const auto& triangle : mesh.triangles) {
    put(bytes, std::uint8_t{3});
    for (const Index v : triangle) put(bytes, v);
  }
  save(path, bytes);
}

void writeSurfaceObj(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string text = "# written by voroform\n";
  for (const Vec3& vertex : mesh.vertices) {
    text += "v ";
    putPointLine(text, mesh.frame.origin + vertex);
  }
  for (const auto& triangle : mesh.triangles) {
    text += 'f';
    for (const Index v : triangle) {
      text += ' ';
      putNumber(text, v + 1);
    }
    text += '\n';
  }
  save(path, text);
}

void writeSurfaceOff(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::string text =
      "OFF\n" + std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n";
  for (const Vec3& vertex : mesh.vertices) putPointLine(text, mesh.frame.origin + vertex);
  for (const auto& triangle : mesh.triangles) {
    text += '3';
    for (const Index v : triangle) {
      text += ' ';
      putNumber(text, v);
    }
    text += '\n';
  }
  save(path, text);
}

void writeSurfaceStl(const std::filesystem::path& path, const TriangleMesh& mesh) {
  // Readers take a file that starts with "solid" for the text variant.
  std::string bytes = "binary STL written by voroform; float32 coordinates";
  bytes.resize(80, ' ');
  put(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  bytes.reserve(bytes.size() + mesh.triangles.size() * 50);
  const auto putFloats = [&](const Vec3& vector) {
    for (const double x : vector) put(bytes, static_cast<float>(x));
  };
  for (const auto& triangle : mesh.triangles) {
    const auto corner = [&](std::size_t i) -> const Vec3& {
      return mesh.vertices[static_cast<std::size_t>(triangle[i])];
    };
    putFloats((corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized());
    for (std::size_t i = 0; i < 3; ++i) putFloats(mesh.frame.origin + corner(i));
    put(bytes, std::uint16_t{0});
  }
  save(path, bytes);
}

void writeSitesPly(const std::filesystem::path& path, std::span<const Vec3> sites, const Frame& frame) {
  std::string bytes = plyStart(sites.size()) + "end_header\n";
  bytes.reserve(bytes.size() + sites.size() * 24);
  for (const Vec3& site : sites) putPoint(bytes, frame.origin + site);
  save(path, bytes);
}

void writeAdjacency(const std::filesystem::path& path, const PolyhedralComplex& complex) {
  const auto areaVector = [&](Index f) {
    const auto loop = complex.face(f);
    const auto vertex = [&](std::size_t i) -> const Vec3& {
      return complex.vertices[static_cast<std::size_t>(loop[i])];
    };
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 2; i < loop.size(); ++i) sum += (vertex(i - 1) - vertex(0)).cross(vertex(i) - vertex(0));
    return Vec3(0.5 * sum);
  };
  std::string text = "i,j,area,nx,ny,nz\n";
  const auto putRow = [&](Index i, Index j, const Vec3& vector) {
    const double area = vector.norm();
    const Vec3 normal = area > 0 ? Vec3(vector / area) : Vec3::Zero();
    putNumber(text, i);
    text += ',';
    putNumber(text, j);
    for (const double value : {area, normal[0], normal[1], normal[2]}) {
      text += ',';
      putNumber(text, value);
    }
    text += '\n';
  };
  const CellFaces rows = cellFaces(complex);
  for (Index cell = 0; cell < complex.cellCount; ++cell) {
    Vec3 boundary = Vec3::Zero();
    bool onBoundary = false;
    const auto row = static_cast<std::size_t>(cell);
    for (auto k = static_cast<std::size_t>(rows.offsets[row]); k < static_cast<std::size_t>(rows.offsets[row + 1]);
         ++k) {
      const Index f = rows.faces[k];
      const auto [behind, ahead] = complex.faceCells[static_cast<std::size_t>(f)];
      if (ahead == kNone) {
        boundary += areaVector(f);
        onBoundary = true;
      } else if (const Index other = behind == cell ? ahead : behind; other > cell) {
        putRow(cell, other, rows.sides[k] * areaVector(f));
      }
    }
    if (onBoundary) putRow(cell, kNone, boundary);
  }
  save(path, text);
}

}  // namespace voroform::mesh
