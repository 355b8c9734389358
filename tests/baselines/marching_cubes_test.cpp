// Marching Cubes as a tessellation: validity, convergence, and another implementation.
#include "voroform/baselines/marching_cubes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "support/marching_cubes.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/validate.hpp"

namespace voroform::baselines {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

MarchingCubesResult tessellate(const implicit::ImplicitFunction& f, Index resolution, const RunContext& context = {}) {
  return marchingCubes(f, {}, gridOf(solidBox(f, context), resolution), {}, context);
}

implicit::ImplicitPtr rotated(const std::string& name, std::uint64_t seed) {
  return implicit::transformed(implicit::namedShape(name), randomRotation(seed), Vec3::Zero());
}

mesh::Certificate expectValid(const mesh::PolyhedralComplex& complex) {
  mesh::ValidateOptions options;
  options.pointSamples = 5000;
  const mesh::Certificate certificate = mesh::validate(complex, options, {});
  EXPECT_THAT(certificate.problems, IsEmpty());
  EXPECT_TRUE(certificate.valid);
  return certificate;
}

TEST(MarchingCubes, IsValidOnEveryShape) {
  for (const std::string& name : implicit::shapeNames()) {
    for (const Index resolution : {9, 24}) {
      SCOPED_TRACE(name + " at " + std::to_string(resolution));
      const MarchingCubesResult result = tessellate(*rotated(name, 11), resolution);
      expectValid(result.complex);
      EXPECT_GT(result.summary.cutCells, 0);
      EXPECT_GE(result.complex.cellCount, result.summary.cutCells);
    }
  }
}

TEST(MarchingCubes, HasTheTopologyOfTheShape) {
  const auto topology = [](const std::string& name) {
    const mesh::Certificate certificate = expectValid(tessellate(*rotated(name, 3), 30).complex);
    return std::pair(certificate.components, certificate.eulerCharacteristic);
  };
  EXPECT_EQ(topology("sphere"), std::pair(1, std::int64_t{2}));
  EXPECT_EQ(topology("torus"), std::pair(1, std::int64_t{0}));
  EXPECT_EQ(topology("two-tori"), std::pair(2, std::int64_t{0}));
}

TEST(MarchingCubes, VolumeConvergesWithOrderTwo) {
  const struct {
    std::string name;
    double volume;
  } shapes[] = {{"sphere", 4 * std::numbers::pi / 3}, {"torus", 0.32 * std::numbers::pi * std::numbers::pi}};
  for (const auto& [name, volume] : shapes) {
    SCOPED_TRACE(name);
    std::vector<double> errors;
    for (const Index resolution : {12, 24, 48}) {
      const MarchingCubesResult result = tessellate(*rotated(name, 5), resolution);
      errors.push_back(volume - mesh::enclosedVolume(mesh::boundarySurface(result.complex).mesh));
    }
    EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.35);
    EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.2);
  }
}

// The faces of a rotated box, away from its edges.
TEST(MarchingCubes, IsExactOnPlanes) {
  const Mat3 rotation = randomRotation(9);
  const auto f = implicit::transformed(implicit::box(Vec3(2, 2, 2)), rotation, Vec3::Zero());
  const MarchingCubesResult result = tessellate(*f, 20);
  const mesh::TriangleMesh surface = mesh::boundarySurface(result.complex).mesh;
  const double edge = gridOf(solidBox(*f, {}), 20).edge;
  int flat = 0;
  for (const auto& triangle : surface.triangles) {
    Vec3 centroid = Vec3::Zero();
    for (const Index v : triangle) centroid += surface.vertices[static_cast<std::size_t>(v)] / 3;
    // Away from the box's edges, where two of its faces are nearer than a cube's diagonal.
    Vec3 local = (rotation.transpose() * centroid).cwiseAbs();
    std::sort(local.data(), local.data() + 3);
    if (local[1] > 1 - 2 * edge) continue;
    ++flat;
    EXPECT_NEAR(local[2], 1, 1e-11);
  }
  EXPECT_GT(flat, 1000);
}

TEST(MarchingCubes, VerticesLieOnTheSurfaceAndOnEdges) {
  const auto f = rotated("bumpy-sphere", 2);
  const CubeGrid grid = gridOf(solidBox(*f, {}), 30);
  const MarchingCubesResult result = marchingCubes(*f, {}, grid, {}, {});
  int onSurface = 0;
  for (const Vec3& vertex : result.complex.vertices) {
    const Vec3 local = (vertex - grid.origin) / grid.edge;
    const Vec3 rest = local - local.array().round().matrix();
    const int off = static_cast<int>((rest.array().abs() > 1e-10).count());
    if (off == 0 && f->value(vertex) < -1e-6) continue;  // an inside corner
    // A vertex is moved off its edge's ends by a millionth of the edge.
    EXPECT_NEAR(f->value(vertex), 0, 2e-6 * grid.edge);
    EXPECT_LE(off, 1) << "no ambiguous loop needs a vertex off the edges here";
    ++onSurface;
  }
  EXPECT_GT(onSurface, 3000);
  EXPECT_EQ(result.summary.tunnelledCells, 0);
}

// The plain Marching Cubes of the tests shares no code with this one. Without ambiguous faces both have the same
// vertices; they may cut a loop into triangles differently, which changes the volume by a part of its error only.
TEST(MarchingCubes, AgreesWithAnIndependentImplementation) {
  const auto f = rotated("torus", 21);
  const double spacing = 0.07;
  // The grid that the other one lays.
  CubeGrid grid;
  grid.edge = spacing;
  grid.origin = f->bounds().min() - Vec3::Constant(1.5 * spacing);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.cubes[axis] = static_cast<Index>(std::ceil(f->bounds().sizes()[static_cast<Index>(axis)] / spacing)) + 3;
  }
  const MarchingCubesResult result = marchingCubes(*f, {}, grid, {}, {});
  ASSERT_EQ(result.summary.ambiguousFaces, 0);
  const mesh::TriangleMesh ours = mesh::boundarySurface(result.complex).mesh;
  const mesh::TriangleMesh other = testing::marchingCubes(*f, spacing, implicit::RootFinder::itp, 1e-12);
  const auto sorted = [](const mesh::TriangleMesh& mesh) {
    std::vector<std::array<double, 3>> points;
    for (const Vec3& v : mesh.vertices) points.push_back({v[0], v[1], v[2]});
    std::sort(points.begin(), points.end());
    return points;
  };
  EXPECT_EQ(ours.triangles.size(), other.triangles.size());
  const auto a = sorted(ours);
  const auto b = sorted(other);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t n = 0; n < a.size(); ++n) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[n][c], b[n][c], 1e-12);
  }
  const double volume = 0.32 * std::numbers::pi * std::numbers::pi;
  const double error = volume - mesh::enclosedVolume(other);
  EXPECT_NEAR(mesh::enclosedVolume(ours), mesh::enclosedVolume(other), 0.1 * error);
}

TEST(MarchingCubes, CellsAreTheCubesWithAnInsideCorner) {
  // Corners at multiples of 1/8 strictly within the box's faces at ±1/2 + 1/32.
  const auto f = implicit::box(Vec3::Constant(1.0625));
  const CubeGrid grid{Vec3::Constant(-1), 0.125, {16, 16, 16}};
  const MarchingCubesResult result = marchingCubes(*f, {}, grid, {}, {});
  expectValid(result.complex);
  EXPECT_EQ(result.complex.cellCount, 10 * 10 * 10);
  EXPECT_EQ(result.summary.cutCells, 1000 - 512);
  EXPECT_EQ(result.summary.cases[1], 8);
  EXPECT_EQ(result.summary.cases[2], 12 * 8);
  EXPECT_EQ(result.summary.cases[8], 6 * 64);
  // Corners of cells in a face of the box are at right angles: but for its edges and corners the box is exact.
  const auto moments = mesh::cellMoments(result.complex, {});
  EXPECT_EQ(std::count_if(moments.begin(), moments.end(),
                          [](const mesh::CellMoments& m) { return std::abs(m.volume - 0.001953125) < 1e-12; }),
            512);
  EXPECT_EQ(std::count_if(moments.begin(), moments.end(),
                          [](const mesh::CellMoments& m) { return std::abs(m.volume - 0.00048828125) < 1e-12; }),
            384);
}

// f vanishes at corners, where several edges' roots meet in one point: their vertices stay apart.
TEST(MarchingCubes, IsValidWhereTheSurfacePassesThroughCorners) {
  class Octahedron final : public implicit::ImplicitFunction {
   public:
    double value(const Vec3& p) const override { return p.cwiseAbs().sum() - 1; }
    Vec3 gradient(const Vec3& p) const override { return p.array().sign().matrix(); }
    Box3 bounds() const override { return {Vec3::Constant(-1), Vec3::Constant(1)}; }
  };
  const CubeGrid grid{Vec3::Constant(-1.125), 0.125, {18, 18, 18}};
  const MarchingCubesResult result = marchingCubes(Octahedron(), {}, grid, {}, {});
  const mesh::Certificate certificate = expectValid(result.complex);
  EXPECT_EQ(certificate.components, 1);
  EXPECT_EQ(certificate.eulerCharacteristic, 2);
  EXPECT_NEAR(certificate.volume, 4.0 / 3, 0.02);
  for (const mesh::CellMoments& cell : mesh::cellMoments(result.complex, {})) EXPECT_GT(cell.volume, 0);
  // The vertices around a corner differ by more than rounding.
  std::vector<Vec3> vertices = result.complex.vertices;
  std::sort(vertices.begin(), vertices.end(), [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
  });
  for (std::size_t v = 1; v < vertices.size(); ++v) EXPECT_GT((vertices[v] - vertices[v - 1]).norm(), 1e-8);
}

TEST(MarchingCubes, TagsTheEnvelope) {
  const auto f = implicit::enveloped(implicit::sphere(1), Box3(Vec3(-2, -2, -2), Vec3(2, 2, 0.3)));
  const MarchingCubesResult result = tessellate(*f, 24);
  expectValid(result.complex);
  int envelope = 0;
  for (Index face = 0; face < result.complex.faceCount(); ++face) {
    if (result.complex.faceTags[static_cast<std::size_t>(face)] != mesh::FaceTag::envelope) continue;
    ++envelope;
    EXPECT_TRUE(result.complex.isBoundary(face));
    for (const Index v : result.complex.face(face)) {
      EXPECT_GT(result.complex.vertices[static_cast<std::size_t>(v)][2], 0.15);
    }
  }
  EXPECT_GT(envelope, 300);
}

TEST(MarchingCubes, IsTheSameForAnyNumberOfThreadsAndRootFinderToTolerance) {
  const auto f = rotated("gyroid-ball", 1);
  RunContext one;
  one.threads = 1;
  const MarchingCubesResult a = tessellate(*f, 40, one);
  const MarchingCubesResult b = tessellate(*f, 40);
  EXPECT_EQ(a.complex.vertices, b.complex.vertices);
  EXPECT_EQ(a.complex.faceVertices, b.complex.faceVertices);
  EXPECT_EQ(a.complex.faceCells, b.complex.faceCells);
  EXPECT_EQ(a.complex.faceTags, b.complex.faceTags);
  EXPECT_EQ(a.summary.evaluations, b.summary.evaluations);

  MarchingCubesOptions options;
  options.rootFinder = implicit::RootFinder::bisection;
  const MarchingCubesResult c = marchingCubes(*f, {}, gridOf(solidBox(*f, {}), 40), options, {});
  ASSERT_EQ(c.complex.faceVertices, b.complex.faceVertices);
  double largest = 0;
  for (std::size_t v = 0; v < b.complex.vertices.size(); ++v) {
    largest = std::max(largest, (b.complex.vertices[v] - c.complex.vertices[v]).norm());
  }
  EXPECT_LT(largest, 1e-11);
}

// f where the oracle is silent or the surface within a cube's diagonal is most of the count: it grows like the surface.
TEST(MarchingCubes, AsksFOnlyNearTheSurface) {
  const auto f = rotated("sphere", 1);
  std::vector<double> evaluations;
  for (const Index resolution : {40, 80}) {
    evaluations.push_back(static_cast<double>(tessellate(*f, resolution).summary.evaluations));
  }
  EXPECT_NEAR(std::log2(evaluations[1] / evaluations[0]), 2, 0.1);
  const double cornersWithinADiagonal = 4 * std::numbers::pi * 2 * std::sqrt(3.0) * 40 * 40;
  // Roots take some ten calls for each of the edges cut, of which there are about 1.5 · 4π · 40².
  EXPECT_LT(evaluations[1], cornersWithinADiagonal + 10 * 1.5 * 4 * std::numbers::pi * 40 * 40);
}

TEST(MarchingCubes, RejectsGridsThatCutTheSolidAndBadOptions) {
  const auto f = implicit::sphere(1);
  try {
    marchingCubes(*f, {}, {Vec3::Constant(-0.5), 0.25, {8, 8, 8}}, {}, {});
    FAIL() << "expected UsageError";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("corner (0, 0, 0) is inside"));
  }
  const CubeGrid grid{Vec3::Constant(-2), 0.25, {16, 16, 16}};
  EXPECT_THROW(marchingCubes(*f, {}, {grid.origin, 0, grid.cubes}, {}, {}), UsageError);
  EXPECT_THROW(marchingCubes(*f, {}, {grid.origin, 1, {0, 3, 3}}, {}, {}), UsageError);
  EXPECT_THROW(marchingCubes(*f, {}, {grid.origin, 1e-6, {100000, 100000, 100000}}, {}, {}), UsageError);
  MarchingCubesOptions options;
  options.rootTolerance = 0;
  EXPECT_THROW(marchingCubes(*f, {}, grid, options, {}), UsageError);
}

}  // namespace
}  // namespace voroform::baselines
