#include "voroform/mesh/read_mesh.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/read_outcome.hpp"
#include "voroform/core/random.hpp"
#include "voroform/mesh/formats.hpp"
#include "voroform/mesh/moments.hpp"

namespace voroform::mesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using Outcome = test::ReadOutcome<MeshReadResult>;

Outcome read(const std::string& bytes, const std::string& format) {
  return test::readOutcome<MeshReadResult>(bytes, [&](std::istream& stream, const RunContext& context) {
    return readSolidMesh(stream, format, "file", context);
  });
}

using Faces = std::vector<std::vector<int>>;

// Corners of the cube of edge 2 about the center, bit i of the number is the sign of axis i; faces outward.
const Faces kCubeFaces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};

std::vector<Vec3> cubeCorners(const Vec3& center = Vec3::Zero(), double half = 1) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back(center + half * Vec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1));
  }
  return corners;
}

void append(std::vector<Vec3>& vertices, Faces& faces, const std::vector<Vec3>& more, Faces moreFaces, bool turned) {
  const auto first = static_cast<int>(vertices.size());
  vertices.insert(vertices.end(), more.begin(), more.end());
  for (std::vector<int>& face : moreFaces) {
    for (int& v : face) v += first;
    if (turned) std::reverse(face.begin(), face.end());
    faces.push_back(face);
  }
}

std::string off(const std::vector<Vec3>& vertices, const Faces& faces) {
  std::ostringstream text;
  text.precision(17);
  text << "OFF\n" << vertices.size() << ' ' << faces.size() << " 0\n";
  for (const Vec3& v : vertices) text << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const std::vector<int>& face : faces) {
    text << face.size();
    for (const int v : face) text << ' ' << v;
    text << '\n';
  }
  return text.str();
}

std::string cubeOff() { return off(cubeCorners(), kCubeFaces); }

template <class T>
void put(std::string& bytes, T value, bool swapped = false) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  if (swapped) std::reverse(raw, raw + sizeof(T));
  bytes.append(raw, sizeof(T));
}

std::string cubePly(const std::string& encoding) {
  std::string bytes = "ply\nformat " + encoding +
                      " 1.0\ncomment a cube\nelement vertex 8\nproperty float x\nproperty uchar red\nproperty double "
                      "y\nproperty float z\nelement face 6\nproperty list uchar short vertex_index\nproperty list int "
                      "float texcoord\nend_header\n";
  const bool swapped = encoding == "binary_big_endian";
  for (const Vec3& v : cubeCorners()) {
    if (encoding == "ascii") {
      bytes += std::to_string(v.x()) + " 7 " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
      continue;
    }
    put(bytes, static_cast<float>(v.x()), swapped);
    put(bytes, std::uint8_t{7});
    put(bytes, v.y(), swapped);
    put(bytes, static_cast<float>(v.z()), swapped);
  }
  for (const std::vector<int>& face : kCubeFaces) {
    if (encoding == "ascii") {
      bytes += "4";
      for (const int v : face) bytes += " " + std::to_string(v);
      bytes += " 2 0.5 0.25\n";
      continue;
    }
    put(bytes, std::uint8_t{4});
    for (const int v : face) put(bytes, static_cast<std::int16_t>(v), swapped);
    put(bytes, std::int32_t{2}, swapped);
    put(bytes, 0.5F, swapped);
    put(bytes, 0.25F, swapped);
  }
  return bytes;
}

std::string cubeObj(bool relative) {
  std::string text = "# a cube\nmtllib some.mtl\no cube\n";
  for (const Vec3& v : cubeCorners()) {
    text += "v " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
  }
  text += "vt 0 0\nvn 0 0 1\nusemtl red\ns off\n";
  for (const std::vector<int>& face : kCubeFaces) {
    text += "f";
    for (const int v : face)
      text += relative ? " " + std::to_string(v - 8) + "/-1/-1" : " " + std::to_string(v + 1) + "//1";
    text += "\n";
  }
  return text;
}

std::vector<std::array<Vec3, 3>> cubeTriangles() {
  std::vector<std::array<Vec3, 3>> triangles;
  const std::vector<Vec3> corners = cubeCorners();
  const auto at = [&](int v) { return corners[static_cast<std::size_t>(v)]; };
  for (const std::vector<int>& face : kCubeFaces) {
    triangles.push_back({at(face[0]), at(face[1]), at(face[2])});
    triangles.push_back({at(face[0]), at(face[2]), at(face[3])});
  }
  return triangles;
}

std::string cubeStlText() {
  std::string text = "solid cube of edge 2\n";
  for (const auto& triangle : cubeTriangles()) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (const Vec3& v : triangle) {
      text +=
          "      vertex " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid cube of edge 2\n";
}

std::string cubeStlBytes(const std::string& title = "solid in name only") {
  std::string bytes = title;
  bytes.resize(80, ' ');
  put(bytes, std::uint32_t{12});
  for (const auto& triangle : cubeTriangles()) {
    for (int i = 0; i < 3; ++i) put(bytes, 0.0F);
    for (const Vec3& v : triangle) {
      for (const double x : v) put(bytes, static_cast<float>(x));
    }
    put(bytes, std::uint16_t{0});
  }
  return bytes;
}

TEST(ReadMesh, ACubeIsTheSameInAllFormats) {
  const std::vector<std::array<std::string, 3>> files = {
      {cubeOff(), ".off", "OFF"},
      {cubeObj(false), ".obj", "OBJ"},
      {cubeObj(true), ".obj", "OBJ"},
      {cubePly("ascii"), ".ply", "PLY ascii"},
      {cubePly("binary_little_endian"), ".ply", "PLY binary_little_endian"},
      {cubePly("binary_big_endian"), ".ply", "PLY binary_big_endian"},
      {cubeStlText(), ".stl", "STL ascii"},
      {cubeStlBytes(), ".stl", "STL binary"}};
  for (const auto& [bytes, extension, format] : files) {
    const Outcome outcome = read(bytes, extension);
    ASSERT_EQ(outcome.error, "") << format;
    EXPECT_THAT(outcome.warnings, IsEmpty()) << format;
    const MeshReadResult& result = outcome.result;
    EXPECT_EQ(result.summary.format, format);
    EXPECT_EQ(result.mesh.vertices.size(), 8U) << format;
    EXPECT_EQ(result.mesh.triangles.size(), 12U) << format;
    EXPECT_DOUBLE_EQ(enclosedVolume(result.mesh), 8) << format;
    EXPECT_EQ(eulerCharacteristic(result.mesh), 2) << format;
    EXPECT_EQ(result.summary.components, 1) << format;
    EXPECT_EQ(result.summary.turnedFaces, 0U) << format;
    EXPECT_EQ(result.summary.welded, extension == ".stl" ? 28U : 0U) << format;
    EXPECT_EQ(result.summary.faces, extension == ".stl" ? 12U : 6U) << format;
  }
}

TEST(ReadMesh, EqualVerticesOfStlAreWeldedWhateverTheSignOfZero) {
  std::string text = "solid\n";
  const std::vector<std::string> p = {"0 0 0", "1 -0 0", "0 1 0", "-0 0 1"};
  for (const auto& t : {std::array{0, 2, 1}, std::array{0, 1, 3}, std::array{0, 3, 2}, std::array{1, 2, 3}}) {
    text += "facet normal 0 0 0\nouter loop\n";
    for (const int v : t) text += "vertex " + p[static_cast<std::size_t>(v)] + "\n";
    text += "endloop\nendfacet\n";
  }
  const Outcome outcome = read(text + "endsolid\n", ".stl");
  ASSERT_EQ(outcome.error, "");
  EXPECT_EQ(outcome.result.mesh.vertices.size(), 4U);
  EXPECT_DOUBLE_EQ(enclosedVolume(outcome.result.mesh), 1.0 / 6);
}

TEST(ReadMesh, AnyFaceMayBeTurned) {
  for (unsigned turned = 0; turned < 64; ++turned) {
    Faces faces = kCubeFaces;
    for (std::size_t f = 0; f < 6; ++f) {
      if ((turned >> f & 1U) != 0) std::reverse(faces[f].begin(), faces[f].end());
    }
    const Outcome outcome = read(off(cubeCorners(), faces), ".off");
    ASSERT_EQ(outcome.error, "");
    EXPECT_DOUBLE_EQ(enclosedVolume(outcome.result.mesh), 8);
    EXPECT_EQ(outcome.result.summary.turnedFaces, 2U * static_cast<unsigned>(std::popcount(turned)));
    EXPECT_EQ(outcome.result.summary.turned, turned == 63);
    EXPECT_EQ(outcome.warnings.size(), turned == 0 ? 0U : 1U);
  }
}

TEST(ReadMesh, NestedPartsAreVoidsAndSolidsByTurns) {
  for (unsigned turned = 0; turned < 16; ++turned) {
    std::vector<Vec3> vertices;
    Faces faces;
    const auto isTurned = [turned](unsigned i) { return (turned >> i & 1U) != 0; };
    append(vertices, faces, cubeCorners(Vec3::Zero(), 4), kCubeFaces, isTurned(0));
    append(vertices, faces, cubeCorners(Vec3(1, 0, 0), 2), kCubeFaces, isTurned(1));
    append(vertices, faces, cubeCorners(Vec3(1, 0.5, 0), 1), kCubeFaces, isTurned(2));
    append(vertices, faces, cubeCorners(Vec3(9, 0, 0), 1), kCubeFaces, isTurned(3));
    const Outcome outcome = read(off(vertices, faces), ".off");
    ASSERT_EQ(outcome.error, "");
    EXPECT_DOUBLE_EQ(enclosedVolume(outcome.result.mesh), 512 - 64 + 8 + 8);
    EXPECT_EQ(outcome.result.summary.components, 4);
  }
}

TEST(ReadMesh, FaultsOfTheMeshAreNamed) {
  const auto cubeWith = [](const Faces& more, std::size_t left) {
    Faces faces(kCubeFaces.begin(), kCubeFaces.begin() + static_cast<std::ptrdiff_t>(left));
    faces.insert(faces.end(), more.begin(), more.end());
    return off(cubeCorners(), faces);
  };
  EXPECT_EQ(read(cubeWith({}, 5), ".off").error,
            "file: the mesh is not closed: the edge from vertex 3 (1, 1, -1) to vertex 1 (1, -1, -1) belongs to face 1 "
            "only (the first of 4 such edges)");
  EXPECT_EQ(
      read(cubeWith({{0, 2, 7}}, 6), ".off").error,
      "file: the mesh is not 2-manifold: the edge from vertex 0 (-1, -1, -1) to vertex 2 (-1, 1, -1) belongs to 3 "
      "faces, face 1 among them (the first of 2 such edges)");
  // Two tetrahedra that share a vertex.
  const Faces tetrahedra = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 5, 4}, {0, 4, 6}, {0, 6, 5}, {4, 5, 6}};
  const std::vector<Vec3> corners = {Vec3(0, 0, 0),  Vec3(1, 0, 0),  Vec3(0, 1, 0), Vec3(0, 0, 1),
                                     Vec3(-1, 0, 0), Vec3(0, -1, 0), Vec3(0, 0, -1)};
  EXPECT_EQ(read(off(corners, tetrahedra), ".off").error,
            "file: the mesh is not 2-manifold: 2 fans of faces meet in vertex 0 (0, 0, 0)");
  EXPECT_EQ(read("OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n", ".off").error,
            "file: the part of the mesh with face 1 encloses no volume; it begins at vertex 0 (0, 0, 0)");
  EXPECT_EQ(read("OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n", ".off").error,
            "file: vertex 1 (1, 0, nan): expected finite coordinates");
  EXPECT_EQ(read("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", ".off").error, "file: the file holds no faces");
  // In OBJ vertices count from 1.
  EXPECT_THAT(read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ".obj").error,
              HasSubstr("the edge from vertex 1 (0, 0, 0) to vertex 2 (1, 0, 0) belongs to face 1 only"));
}

TEST(ReadMesh, OneSidedSurfacesAreRefused) {
  // The real projective plane of six vertices: closed, every edge in two faces, one fan a vertex.
  const Faces faces = {{0, 1, 4}, {0, 1, 5}, {0, 2, 3}, {0, 2, 5}, {0, 3, 4},
                       {1, 2, 3}, {1, 2, 4}, {1, 3, 5}, {2, 4, 5}, {3, 4, 5}};
  const std::vector<Vec3> corners = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0),
                                     Vec3(0, 0, 1), Vec3(1, 2, 3), Vec3(3, -1, 2)};
  EXPECT_THAT(read(off(corners, faces), ".off").error,
              HasSubstr("file: the mesh is not orientable: its faces cannot be turned to agree along the edge from"));
}

TEST(ReadMesh, WhatIsOfNoUseIsLeftOutAndSaid) {
  std::vector<Vec3> vertices = cubeCorners();
  vertices.insert(vertices.begin(), Vec3(9, 9, 9));
  Faces faces = kCubeFaces;
  for (auto& face : faces) {
    for (int& v : face) ++v;
  }
  faces.push_back({1, 2, 2});
  const Outcome outcome = read(off(vertices, faces), ".off");
  ASSERT_EQ(outcome.error, "");
  EXPECT_THAT(outcome.warnings, ElementsAre("file: 1 triangles that name a vertex twice were left out",
                                            "file: 1 vertices of no face were left out"));
  EXPECT_EQ(outcome.result.mesh.vertices.size(), 8U);
  EXPECT_DOUBLE_EQ(enclosedVolume(outcome.result.mesh), 8);
}

TEST(ReadMesh, FaultsOfTheFileAreNamedWithTheirPlace) {
  const std::string ply = cubePly("binary_little_endian");
  const std::string stl = cubeStlBytes();
  std::string badIndex = ply;
  badIndex[ply.find("end_header\n") + 11 + 8 * 17 + 1] = 8;
  std::string notFinite = stl;
  std::memset(notFinite.data() + 84 + 50 + 12, 0xff, 4);
  const std::vector<std::array<std::string, 3>> cases = {
      {"", ".off", "file: the file is empty"},
      {"OFF\n1 1 0\n0 0 x\n", ".off", "file:3: expected a number for z, found \"x\""},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", ".off", "file:6: expected an index below 3, found 3"},
      {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", ".off", "file:6: expected a face of at least 3 corners, found 2"},
      {"", ".obj", "file: the file is empty"},
      {"v 0 0\n", ".obj", "file:1: expected a number for z, found the end of the line"},
      {"v 0 0 0\nf 1 2 3\n", ".obj", "file:2: expected the index of one of the 1 vertices before, found \"2\""},
      {"v 0 0 0\nf 1 -2 3\n", ".obj", "file:2: expected the index of one of the 1 vertices before, found \"-2\""},
      {"v 0 0 0\nf 1/ a 3\n", ".obj", "file:2: expected the index of a vertex, found \"a\""},
      {"curv2 1 2\n", ".obj", "file:1: expected a statement of polygonal OBJ such as v or f, found \"curv2\""},
      {badIndex, ".ply", "file: record 1 of element face: expected an index below 8, found 8.000000"},
      {ply.substr(0, ply.size() - 1), ".ply", "file: declares 6 faces, file ends after record 5 "},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n", ".ply",
       "file: the header declares no element face"},
      {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", ".stl",
       "file:4: expected a number for z, found the end of the line"},
      {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop\n", ".stl",
       "file:5: expected \"vertex\", found \"endloop\""},
      {"solid\nfacet normal 0 0 1\n", ".stl", "file: file ends within triangle 1 (line 2)"},
      {notFinite, ".stl", "file: triangle 2: expected finite coordinates"},
      {"x", ".stl", "file: expected an STL file, found neither"},
      {"x", ".vox", "file: expected the extension .off, .obj, .ply or .stl of a mesh, found \".vox\""}};
  for (const auto& [bytes, format, message] : cases) {
    const std::string error = read(bytes, format).error;
    EXPECT_EQ(error.substr(0, message.size()), message) << format;
  }
  const std::string huge = "OFF\n2000000000 2000000000 0\n0 0 0\n";
  EXPECT_THAT(read(huge, ".off").error, HasSubstr("declares 2000000000 vertices, file ends after record 1"));
  std::string hugeStl = cubeStlBytes("binary");
  std::memset(hugeStl.data() + 80, 0xff, 4);
  EXPECT_THAT(read(hugeStl, ".stl").error, HasSubstr("declares 4294967295 triangles, file ends after record 12"));
}

// Whatever becomes of a file's bytes, it is a mesh that keeps what is promised, or an InputError.
TEST(ReadMesh, ChangedBytesAreReadOrRefused) {
  const std::vector<std::array<std::string, 2>> files = {
      {cubeOff(), ".off"},         {cubeObj(true), ".obj"},
      {cubePly("ascii"), ".ply"},  {cubeStlText(), ".stl"},
      {cubeStlBytes(), ".stl"},    {cubePly("binary_little_endian"), ".ply"},
      {cubeStlBytes("x"), ".stl"}, {cubePly("binary_big_endian"), ".ply"}};
  int accepted = 0;
  for (std::uint64_t i = 0; i < 8000; ++i) {
    auto [bytes, format] = files[i % files.size()];
    const auto random = [&](std::uint64_t k) { return randomBits(i, RandomStream::test, k); };
    for (std::uint64_t change = 0; change <= random(0) % 3; ++change) {
      const std::size_t at = random(3 * change + 1) % bytes.size();
      switch (random(3 * change + 2) % 4) {
        case 0:
          bytes[at] = static_cast<char>(random(3 * change + 3));
          break;
        case 1:
          bytes.erase(at, 1 + random(3 * change + 3) % 9);
          break;
        case 2:
          bytes.insert(at, bytes.substr(random(3 * change + 3) % bytes.size(), 12));
          break;
        default:
          bytes.resize(at + 1);
      }
    }
    const Outcome outcome = read(bytes, format);
    if (!outcome.error.empty()) continue;
    ++accepted;
    const TriangleMesh& mesh = outcome.result.mesh;
    for (const auto& triangle : mesh.triangles) {
      for (const Index v : triangle) {
        ASSERT_LT(static_cast<std::size_t>(v), mesh.vertices.size());
        ASSERT_TRUE(mesh.vertices[static_cast<std::size_t>(v)].allFinite());
      }
    }
    ASSERT_GT(std::abs(enclosedVolume(mesh)), 0);
  }
  EXPECT_GT(accepted, 100);
  EXPECT_LT(accepted, 7000);
}

TEST(ReadMesh, FarFromTheOriginNoBitIsLost) {
  const Vec3 far(1e6 + 0.1, -3e5, 0.3);
  const Outcome outcome = read(off(cubeCorners(far, 0.7), kCubeFaces), ".off");
  ASSERT_EQ(outcome.error, "");
  const TriangleMesh& mesh = outcome.result.mesh;
  EXPECT_GT(mesh.frame.origin.norm(), 1e6);
  const std::vector<Vec3> expected = cubeCorners(far, 0.7);
  for (std::size_t v = 0; v < 8; ++v) {
    EXPECT_EQ(mesh.frame.origin + mesh.vertices[v], expected[v]);
    EXPECT_LT(mesh.vertices[v].norm(), 10);
  }
}

TEST(ReadMesh, WrittenAndReadAgainAMeshIsTheSameBits) {
  const std::filesystem::path path = std::filesystem::path(::testing::TempDir()) / "read_mesh_test.ply";
  for (const Vec3& center : {Vec3(0.1, 0.2, 0.3), Vec3(1e5, 7, -3e6)}) {
    const Outcome outcome = read(off(cubeCorners(center, 0.3), kCubeFaces), ".off");
    ASSERT_EQ(outcome.error, "");
    const TriangleMesh turned = rotated(outcome.result.mesh, randomRotation(4));
    writeMeshPly(path, turned);
    const TriangleMesh again = readSolidMesh(path, RunContext()).mesh;
    EXPECT_EQ(again.frame.origin, turned.frame.origin);
    EXPECT_EQ(again.vertices, turned.vertices);
    EXPECT_EQ(again.triangles, turned.triangles);
    EXPECT_NEAR(enclosedVolume(turned), 0.216, 1e-6);
  }
  std::filesystem::remove(path);
}

TEST(ReadMesh, ARotationKeepsTheCenterAndTurnsTheRest) {
  const TriangleMesh mesh = read(off(cubeCorners(Vec3(1, 2, 3)), kCubeFaces), ".off").result.mesh;
  const TriangleMesh turned = rotated(mesh, Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitZ()).toRotationMatrix());
  for (std::size_t v = 0; v < 8; ++v) {
    const Vec3 p = mesh.vertices[v] - Vec3(1, 2, 3);
    EXPECT_NEAR((turned.vertices[v] - Vec3(1 - p.y(), 2 + p.x(), 3 + p.z())).norm(), 0, 1e-14);
  }
}

TEST(ReadMesh, SelfIntersectionsAreCountedAndNoFault) {
  std::vector<Vec3> vertices;
  Faces faces;
  append(vertices, faces, cubeCorners(), kCubeFaces, false);
  append(vertices, faces, cubeCorners(Vec3(0.7, 0.6, 0.5)), kCubeFaces, false);
  const Outcome outcome = read(off(vertices, faces), ".off");
  ASSERT_EQ(outcome.error, "");
  EXPECT_GT(meshIntersections(outcome.result.mesh, RunContext()).pairs, 0);
  EXPECT_EQ(meshIntersections(read(cubeOff(), ".off").result.mesh, RunContext()).pairs, 0);
}

TEST(HoldsFaces, TellsMeshesFromClouds) {
  const std::filesystem::path folder = ::testing::TempDir();
  const auto holds = [&](const std::string& name, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << bytes;
    const bool result = holdsFaces(folder / name, RunContext());
    std::filesystem::remove(folder / name);
    return result;
  };
  EXPECT_TRUE(holds("a.off", cubeOff()));
  EXPECT_TRUE(holds("a.PLY", cubePly("binary_big_endian")));
  EXPECT_TRUE(holds("a.obj", cubeObj(false)));
  EXPECT_TRUE(holds("a.stl", cubeStlText()));
  EXPECT_FALSE(holds("a.xyz", "0 0 0\n"));
  EXPECT_FALSE(holds("a.off", "OFF\n1 0 0\n0 0 0\n"));
  EXPECT_FALSE(holds("a.ply", "ply\nformat ascii 1.0\nelement vertex 0\nelement face 0\nend_header\n"));
}

}  // namespace
}  // namespace voroform::mesh
