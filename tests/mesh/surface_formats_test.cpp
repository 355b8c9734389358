// Surfaces, sites and adjacency, parsed back by the simplest means.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <sstream>

#include "file_support.hpp"
#include "support/complexes.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/mesh/formats.hpp"

namespace voroform::mesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::readAll;
using ::testing::StartsWith;
using testing::TemporaryFolder;

template <class T>
T take(const std::string& bytes, std::size_t& place) {
  T value;
  std::memcpy(&value, bytes.data() + place, sizeof(T));
  place += sizeof(T);
  return value;
}

PolyhedralComplex sample() {
  PolyhedralComplex complex = testing::mapped(testing::block(2), randomRotation(4), Vec3(1.0 / 3, 0, 0));
  complex.frame.origin = Vec3(4'500'000.1, -1, 0);
  for (Index f = 0; f < complex.faceCount(); f += 5) complex.faceTags[static_cast<std::size_t>(f)] = FaceTag::envelope;
  return complex;
}

TEST(SurfacePly, HoldsWorldCoordinatesCellsAndTags) {
  const TemporaryFolder folder;
  const PolyhedralComplex complex = sample();
  const BoundarySurface surface = boundarySurface(complex);
  writeSurfacePly(folder / "s.ply", surface, complex);
  const std::string bytes = readAll(folder / "s.ply");
  EXPECT_THAT(bytes, StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(bytes, HasSubstr("element vertex 26\nproperty double x\nproperty double y\nproperty double z\n"
                               "element face 48\nproperty list uchar int vertex_indices\nproperty int cell\n"
                               "property uchar tag\nend_header\n"));
  std::size_t place = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size() - place, 26U * 24U + 48U * 18U);
  for (const Vec3& vertex : surface.mesh.vertices) {
    for (Index i = 0; i < 3; ++i) EXPECT_EQ(take<double>(bytes, place), complex.frame.origin[i] + vertex[i]);
  }
  for (std::size_t t = 0; t < 48; ++t) {
    const auto face = static_cast<std::size_t>(surface.sourceFaces[t]);
    EXPECT_EQ(take<std::uint8_t>(bytes, place), 3);
    for (const Index v : surface.mesh.triangles[t]) EXPECT_EQ(take<Index>(bytes, place), v);
    EXPECT_EQ(take<Index>(bytes, place), complex.faceCells[face][0]);
    EXPECT_EQ(take<std::uint8_t>(bytes, place), static_cast<std::uint8_t>(complex.faceTags[face]));
  }
}

TEST(SurfaceObj, ReadsBackTheSameDoubles) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = boundarySurface(sample()).mesh;
  writeSurfaceObj(folder / "s.obj", mesh);
  std::istringstream text(readAll(folder / "s.obj"));
  std::string line;
  std::getline(text, line);
  EXPECT_THAT(line, StartsWith("#"));
  std::string kind;
  for (const Vec3& vertex : mesh.vertices) {
    std::string x, y, z;
    text >> kind >> x >> y >> z;
    EXPECT_EQ(kind, "v");
    EXPECT_EQ(Vec3(std::stod(x), std::stod(y), std::stod(z)), Vec3(mesh.frame.origin + vertex));
  }
  for (const auto& triangle : mesh.triangles) {
    Index a = 0, b = 0, c = 0;
    text >> kind >> a >> b >> c;
    EXPECT_EQ(kind, "f");
    EXPECT_THAT(triangle, ElementsAre(a - 1, b - 1, c - 1));
  }
  EXPECT_FALSE(text >> kind);
}

TEST(SurfaceOff, ReadsBackTheSameDoubles) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = boundarySurface(sample()).mesh;
  writeSurfaceOff(folder / "s.off", mesh);
  std::istringstream text(readAll(folder / "s.off"));
  std::string magic;
  std::size_t vertices = 0, triangles = 0, edges = 1;
  text >> magic >> vertices >> triangles >> edges;
  EXPECT_EQ(magic, "OFF");
  ASSERT_EQ(vertices, mesh.vertices.size());
  ASSERT_EQ(triangles, mesh.triangles.size());
  EXPECT_EQ(edges, 0U);
  for (const Vec3& vertex : mesh.vertices) {
    std::string x, y, z;
    text >> x >> y >> z;
    EXPECT_EQ(Vec3(std::stod(x), std::stod(y), std::stod(z)), Vec3(mesh.frame.origin + vertex));
  }
  for (const auto& triangle : mesh.triangles) {
    Index n = 0, a = 0, b = 0, c = 0;
    text >> n >> a >> b >> c;
    EXPECT_EQ(n, 3);
    EXPECT_THAT(triangle, ElementsAre(a, b, c));
  }
}

TEST(SurfaceStl, HoldsFloatsAndOutwardNormals) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = boundarySurface(testing::block(1)).mesh;
  writeSurfaceStl(folder / "s.stl", mesh);
  const std::string bytes = readAll(folder / "s.stl");
  ASSERT_EQ(bytes.size(), 84U + 12U * 50U);
  EXPECT_NE(bytes.substr(0, 5), "solid");
  std::size_t place = 80;
  EXPECT_EQ(take<std::uint32_t>(bytes, place), 12U);
  for (const auto& triangle : mesh.triangles) {
    Vec3 normal;
    for (double& x : normal) x = static_cast<double>(take<float>(bytes, place));
    EXPECT_EQ(normal.norm(), 1);
    const Vec3 corner = mesh.vertices[static_cast<std::size_t>(triangle[0])];
    EXPECT_GT(normal.dot(corner - Vec3::Constant(0.5)), 0);
    for (const Index v : triangle) {
      for (const double x : mesh.vertices[static_cast<std::size_t>(v)]) {
        EXPECT_EQ(take<float>(bytes, place), static_cast<float>(x));
      }
    }
    EXPECT_EQ(take<std::uint16_t>(bytes, place), 0);
  }
}

TEST(SitesPly, OneVertexASite) {
  const TemporaryFolder folder;
  const std::vector<Vec3> sites = {{0.25, 0.5, 1}, {2, 3, 4}};
  writeSitesPly(folder / "sites.ply", sites, Frame{Vec3(10, 20, 30)});
  const std::string bytes = readAll(folder / "sites.ply");
  EXPECT_THAT(bytes, HasSubstr("element vertex 2\n"));
  std::size_t place = bytes.find("end_header\n") + 11;
  ASSERT_EQ(bytes.size() - place, 48U);
  for (const double expected : {10.25, 20.5, 31.0, 12.0, 23.0, 34.0}) EXPECT_EQ(take<double>(bytes, place), expected);
}

TEST(Adjacency, TwoBoxes) {
  const TemporaryFolder folder;
  const Mat3 stretch = Vec3(1, 2, 3).asDiagonal();
  writeAdjacency(folder / "a.csv", testing::mapped(testing::cubes({{1, 0, 0}, {0, 0, 0}}), stretch, Vec3::Zero()));
  // Cell 0 lies at x > 1: its normal towards cell 1 is −x, the sum over its boundary the reverse.
  EXPECT_EQ(readAll(folder / "a.csv"),
            "i,j,area,nx,ny,nz\n"
            "0,1,6,-1,0,0\n"
            "0,-1,6,1,0,0\n"
            "1,-1,6,-1,0,0\n");
}

TEST(Adjacency, EachCellsAreaVectorsAddUpToZero) {
  const TemporaryFolder folder;
  writeAdjacency(folder / "a.csv", sample());
  std::istringstream text(readAll(folder / "a.csv"));
  std::string line;
  std::getline(text, line);
  std::vector<Vec3> sums(8, Vec3::Zero());
  int rows = 0;
  while (std::getline(text, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    int i = 0, j = 0;
    double area = 0;
    Vec3 n;
    fields >> i >> j >> area >> n[0] >> n[1] >> n[2];
    ASSERT_TRUE(j == kNone || i < j) << line;
    EXPECT_NEAR(n.norm(), 1, 1e-12);
    sums[static_cast<std::size_t>(i)] += area * n;
    if (j != kNone) sums[static_cast<std::size_t>(j)] -= area * n;
    ++rows;
  }
  EXPECT_EQ(rows, 12 + 8);
  for (const Vec3& sum : sums) EXPECT_LE(sum.norm(), 1e-12);
}

TEST(Formats, FailureToWriteIsAnEnvironmentError) {
  const TemporaryFolder folder;
  const PolyhedralComplex complex = testing::block(1);
  EXPECT_THROW(writeCellsVtu(folder / "missing/c.vtu", complex, {}), EnvironmentError);
  EXPECT_THROW(writeSurfacePly(folder / "missing/s.ply", boundarySurface(complex), complex), EnvironmentError);
  EXPECT_THROW(writeAdjacency(folder / "missing/a.csv", complex), EnvironmentError);
}

}  // namespace
}  // namespace voroform::mesh
