// Restricted Voronoi cells against lattices and brute force; what a regular sample of a mesh must be.
#include "voroform/metrics/surface_cvt.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "support/complexes.hpp"
#include "support/surface_meshes.hpp"
#include "surface_cvt_cells.hpp"
#include "surface_cvt_grid.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"

namespace voroform::metrics {
namespace {

using testing::icosphere;
using testing::joined;
using testing::mappedMesh;
using testing::squareMesh;

// Sums of at most some thousands of pieces of order one.
constexpr double kRounding = 1e-12;

double random(std::uint64_t index) { return randomUnit(11, RandomStream::test, index); }

double areaOf(const mesh::TriangleMesh& mesh) { return facetsOf(mesh, RunContext{}).area(); }

SurfaceSites randomSites(const mesh::TriangleMesh& mesh, double spacing, std::uint64_t seed = 3) {
  SurfaceCvtOptions options;
  options.spacing = spacing;
  options.iterations = 0;
  options.seed = seed;
  MeshSamples samples = surfaceCvt(mesh, options, RunContext{});
  return {samples.points, samples.triangles};
}

MeshSamples samplesOf(const mesh::TriangleMesh& mesh, double spacing, int iterations = 5, int threads = 0) {
  SurfaceCvtOptions options;
  options.spacing = spacing;
  options.iterations = iterations;
  options.seed = 5;
  RunContext context;
  context.threads = threads;
  return surfaceCvt(mesh, options, context);
}

struct CellSums {
  double area = 0;
  Vec3 moment = Vec3::Zero();
  double energy = 0;
};

std::vector<CellSums> sumsOf(const SurfaceCells& cells) {
  std::vector<CellSums> sums(cells.offsets.size() - 1);
  for (const SurfacePiece& piece : cells.pieces) {
    CellSums& sum = sums[static_cast<std::size_t>(piece.site)];
    sum.area += piece.area;
    sum.moment += piece.moment;
    sum.energy += piece.energy;
  }
  return sums;
}

double totalArea(const SurfaceCells& cells) {
  double area = 0;
  for (const CellSums& sum : sumsOf(cells)) area += sum.area;
  return area;
}

double totalEnergy(const SurfaceCells& cells) {
  double energy = 0;
  for (const CellSums& sum : sumsOf(cells)) energy += sum.energy;
  return energy;
}

SurfaceCells cellsOf(const mesh::TriangleMesh& mesh, const SurfaceSites& sites, double spacing, int threads = 0) {
  RunContext context;
  context.threads = threads;
  return surfaceCells(mesh, facetsOf(mesh, context), sites, spacing, context);
}

// A triangle clipped by the bisectors with all other sites, in any order: the definition.
CellSums bruteForcePiece(std::array<Vec3, 3> corners, const std::vector<Vec3>& sites, std::size_t site) {
  std::vector<Vec3> polygon(corners.begin(), corners.end());
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  for (std::size_t j = 0; j < sites.size() && !polygon.empty(); ++j) {
    if (j == site) continue;
    const auto excess = [&](const Vec3& x) { return (x - sites[site]).squaredNorm() - (x - sites[j]).squaredNorm(); };
    std::vector<Vec3> kept;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      const Vec3& a = polygon[k];
      const Vec3& b = polygon[(k + 1) % polygon.size()];
      if (excess(a) <= 0) kept.push_back(a);
      if ((excess(a) <= 0) != (excess(b) <= 0)) kept.push_back(a + excess(a) / (excess(a) - excess(b)) * (b - a));
    }
    polygon = kept;
  }
  // Midpoints of edges integrate quadratic functions over a triangle exactly.
  CellSums sums;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const std::array<Vec3, 3> part = {polygon[0], polygon[k - 1], polygon[k]};
    const double area = 0.5 * (part[1] - part[0]).cross(part[2] - part[0]).dot(normal);
    sums.area += area;
    for (std::size_t e = 0; e < 3; ++e) {
      const Vec3 middle = (part[e] + part[(e + 1) % 3]) / 2 - sites[site];
      sums.moment += area / 3 * middle;
      sums.energy += area / 3 * middle.squaredNorm();
    }
  }
  return sums;
}

void expectBruteForce(const mesh::TriangleMesh& mesh, double spacing, double statedSpacing) {
  const SurfaceSites sites = randomSites(mesh, spacing);
  const std::vector<CellSums> sums = sumsOf(cellsOf(mesh, sites, statedSpacing));
  ASSERT_EQ(sums.size(), sites.points.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    CellSums expected;
    for (const auto& triangle : mesh.triangles) {
      const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(triangle[k])]; };
      const CellSums piece = bruteForcePiece({corner(0), corner(1), corner(2)}, sites.points, i);
      expected.area += piece.area;
      expected.moment += piece.moment;
      expected.energy += piece.energy;
    }
    EXPECT_NEAR(sums[i].area, expected.area, kRounding) << i;
    EXPECT_LE((sums[i].moment - expected.moment).norm(), kRounding) << i;
    EXPECT_NEAR(sums[i].energy, expected.energy, kRounding) << i;
  }
}

// A wavy sheet whose normals stay within 120° of each other.
mesh::TriangleMesh wavySheet(int n) {
  mesh::TriangleMesh sheet = squareMesh(n, 1);
  for (Vec3& v : sheet.vertices) v[2] = 0.1 * std::sin(7 * v[0]) * std::cos(5 * v[1]);
  return sheet;
}

TEST(SurfaceCells, LatticeOnASquare) {
  // Unit squares about the sites of a square lattice; the triangles' edges cross them anywhere.
  const mesh::TriangleMesh square = squareMesh(7, 4);
  SurfaceSites sites;
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 4; ++i) {
      sites.points.emplace_back(i + 0.5, j + 0.5, 0);
      sites.triangles.push_back(0);
    }
  }
  for (const CellSums& sum : sumsOf(cellsOf(square, sites, 1))) {
    EXPECT_NEAR(sum.area, 1, kRounding);
    EXPECT_LE(sum.moment.norm(), kRounding);
    EXPECT_NEAR(sum.energy, 1.0 / 6, kRounding);
  }
}

TEST(SurfaceCells, BruteForceFewSitesOnManyTriangles) { expectBruteForce(wavySheet(12), 0.4, 0.4); }
TEST(SurfaceCells, BruteForceManySitesOnFewTriangles) { expectBruteForce(wavySheet(2), 0.12, 0.12); }
TEST(SurfaceCells, BruteForceAsManySitesAsTriangles) { expectBruteForce(wavySheet(9), 0.1, 0.1); }
// The lists of neighbors then hold next to nothing, or everything.
TEST(SurfaceCells, SpacingIsAHintOnly) {
  expectBruteForce(wavySheet(6), 0.15, 0.03);
  expectBruteForce(wavySheet(6), 0.15, 3);
}

TEST(SurfaceCells, AreasFillTheMesh) {
  const mesh::TriangleMesh sphere = icosphere(3, 1);
  const mesh::TriangleMesh cube = mesh::boundarySurface(testing::block(3)).mesh;
  mesh::TriangleMesh triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0.3, 0.8, 0.2}};
  triangle.triangles = {{0, 1, 2}};
  const std::vector<std::pair<mesh::TriangleMesh, double>> cases = {{sphere, 0.03}, {sphere, 0.1},   {sphere, 1.5},
                                                                    {cube, 0.07},   {cube, 2},       {cube, 100},
                                                                    {triangle, 10}, {triangle, 0.01}};
  for (const auto& [mesh, spacing] : cases) {
    const SurfaceSites sites = randomSites(mesh, spacing);
    const double area = areaOf(mesh);
    EXPECT_NEAR(totalArea(cellsOf(mesh, sites, spacing)), area, kRounding * area) << spacing;
  }
}

TEST(SurfaceCells, FirstOfCoincidentSitesOwnsAll) {
  const mesh::TriangleMesh square = squareMesh(3, 1);
  const SurfaceSites sites = {{{0.2, 0.5, 0}, {0.7, 0.5, 0}, {0.7, 0.5, 0}}, {0, 1, 1}};
  const std::vector<CellSums> sums = sumsOf(cellsOf(square, sites, 0.5));
  EXPECT_NEAR(sums[0].area, 0.45, kRounding);
  EXPECT_NEAR(sums[1].area, 0.55, kRounding);
  EXPECT_EQ(sums[2].area, 0);
}

TEST(SurfaceCells, SheetsKeepTheirOwnSites) {
  // Two sheets back to back, a tenth of the spacing apart.
  const double spacing = 0.1;
  const mesh::TriangleMesh above = squareMesh(8, 1);
  const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()).toRotationMatrix();
  const mesh::TriangleMesh both = joined(above, mappedMesh(above, turn, Vec3(0, 1, -0.1 * spacing)));
  const SurfaceSites sites = randomSites(both, spacing);
  const auto sheet = [&](Index triangle) { return static_cast<std::size_t>(triangle) < above.triangles.size(); };
  const SurfaceCells cells = cellsOf(both, sites, spacing);
  for (const SurfacePiece& piece : cells.pieces) {
    EXPECT_EQ(sheet(piece.triangle), sheet(sites.triangles[static_cast<std::size_t>(piece.site)]));
  }
  EXPECT_NEAR(totalArea(cells), 2, kRounding);
}

TEST(SurfaceCells, SheetWithoutSitesGoesToTheOther) {
  const mesh::TriangleMesh above = squareMesh(2, 1);
  const Mat3 turn = Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()).toRotationMatrix();
  const mesh::TriangleMesh both = joined(above, mappedMesh(above, turn, Vec3(0, 1, -0.01)));
  const SurfaceSites sites = {{{0.25, 0.5, 0}, {0.75, 0.5, 0}}, {0, 7}};
  for (const CellSums& sum : sumsOf(cellsOf(both, sites, 0.5))) EXPECT_NEAR(sum.area, 1, kRounding);
}

TEST(PointGrid, NearestAsByExhaustion) {
  std::vector<Vec3> points;
  for (std::uint64_t i = 0; i < 400; ++i)
    points.emplace_back(random(3 * i), random(3 * i + 1), 0.1 * random(3 * i + 2));
  for (const double edge : {1e-9, 0.02, 0.3, 50.0}) {
    const PointGrid grid(points, edge);
    for (std::uint64_t q = 0; q < 200; ++q) {
      const Vec3 p(3 * random(9000 + 3 * q) - 1, 3 * random(9001 + 3 * q) - 1, random(9002 + 3 * q));
      const auto even = [](Index i) { return i % 2 == 0; };
      Index expected = 0;
      for (Index i = 0; i < 400; i += 2) {
        if ((points[static_cast<std::size_t>(i)] - p).norm() <
            (points[static_cast<std::size_t>(expected)] - p).norm()) {
          expected = i;
        }
      }
      const double distance = (points[static_cast<std::size_t>(expected)] - p).norm();
      EXPECT_EQ(grid.nearest(p, 0.01, std::numeric_limits<double>::infinity(), even), expected);
      EXPECT_EQ(grid.nearest(p, 0.01, 1.001 * distance, even), expected);
      EXPECT_EQ(grid.nearest(p, 0.01, 0.999 * distance, even), kNone);
    }
  }
}

TEST(SurfaceCvt, EnergyFallsTowardsTheHexagons) {
  // Hexagonal cells of the plane have ∫‖x‖² = 5/(18√3)·A²; a square's border costs a little.
  const mesh::TriangleMesh square = squareMesh(20, 1);
  double last = std::numeric_limits<double>::infinity();
  double first = 0;
  for (const int iterations : {0, 1, 2, 4, 8, 30}) {
    const MeshSamples samples = samplesOf(square, 0.03, iterations);
    const double energy = totalEnergy(cellsOf(square, {samples.points, samples.triangles}, 0.03)) *
                          static_cast<double>(samples.points.size());
    EXPECT_LT(energy, last);
    if (iterations == 0) first = energy;
    EXPECT_NEAR(samples.energyDrop, 1 - energy / first, kRounding);
    last = energy;
  }
  const double hexagons = 5 / (18 * std::numbers::sqrt3);
  EXPECT_GE(last, hexagons);
  EXPECT_LE(last, 1.04 * hexagons);
}

TEST(SurfaceCvt, SamplesAreRegular) {
  const mesh::TriangleMesh sphere = icosphere(4, 1);
  for (const double spacing : {0.02, 0.05, 0.15}) {
    const MeshSamples start = samplesOf(sphere, spacing, 0);
    const MeshSamples samples = samplesOf(sphere, spacing);
    const double count = areaOf(sphere) / (std::numbers::sqrt3 / 2 * spacing * spacing);
    EXPECT_NEAR(static_cast<double>(samples.points.size()), count, 0.5);
    EXPECT_GE(start.variation, 0.35);
    EXPECT_LE(samples.variation, 0.12) << spacing;
    EXPECT_GE(samples.meanSpacing, 0.83 * spacing);
    EXPECT_LE(samples.meanSpacing, spacing);
  }
}

TEST(SurfaceCvt, VariationIsThatOfNearestNeighbors) {
  const MeshSamples samples = samplesOf(icosphere(2, 1), 0.3);
  double sum = 0;
  double squares = 0;
  for (const Vec3& p : samples.points) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec3& q : samples.points) {
      if (&p != &q) least = std::min(least, (p - q).norm());
    }
    sum += least;
    squares += least * least;
  }
  const auto count = static_cast<double>(samples.points.size());
  const double mean = sum / count;
  EXPECT_NEAR(samples.meanSpacing, mean, kRounding);
  EXPECT_NEAR(samples.variation, std::sqrt(squares / count - mean * mean) / mean, 1e-9);
}

TEST(SurfaceCvt, SamplesLieInsideTheirTriangles) {
  for (const mesh::TriangleMesh& mesh : {icosphere(4, 1), wavySheet(60)}) {
    for (const double spacing : {0.02, 0.1}) {
      const MeshSamples samples = samplesOf(mesh, spacing);
      std::size_t inside = 0;
      for (std::size_t i = 0; i < samples.points.size(); ++i) {
        const auto& triangle = mesh.triangles[static_cast<std::size_t>(samples.triangles[i])];
        const auto corner = [&](std::size_t k) -> const Vec3& {
          return mesh.vertices[static_cast<std::size_t>(triangle[k])];
        };
        const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3 edge = corner((k + 1) % 3) - corner(k);
          least = std::min(least, normal.dot(edge.cross(samples.points[i] - corner(k))) / normal.squaredNorm());
        }
        EXPECT_GE(least, -kRounding);
        EXPECT_NEAR(normal.normalized().dot(samples.points[i] - corner(0)), 0, kRounding);
        if (least > 1e-6) ++inside;
      }
      EXPECT_GE(static_cast<double>(inside), 0.99 * static_cast<double>(samples.points.size()));
    }
  }
}

TEST(SurfaceCvt, SameBitsForAnyNumberOfThreads) {
  const mesh::TriangleMesh sphere = icosphere(4, 1);
  const MeshSamples one = samplesOf(sphere, 0.03, 5, 1);
  const MeshSamples three = samplesOf(sphere, 0.03, 5, 3);
  EXPECT_EQ(one.points, three.points);
  EXPECT_EQ(one.triangles, three.triangles);
  EXPECT_EQ(one.variation, three.variation);
  EXPECT_EQ(one.energyDrop, three.energyDrop);
}

TEST(SurfaceCvt, SeedMatters) {
  const mesh::TriangleMesh sphere = icosphere(2, 1);
  SurfaceCvtOptions options;
  options.spacing = 0.2;
  const MeshSamples a = surfaceCvt(sphere, options, RunContext{});
  options.seed = 1;
  EXPECT_NE(a.points, surfaceCvt(sphere, options, RunContext{}).points);
}

TEST(SurfaceCvt, MovesAndScalesWithTheMesh) {
  const mesh::TriangleMesh sphere = mappedMesh(icosphere(3, 1), Vec3(1, 0.7, 0.5).asDiagonal(), Vec3::Zero());
  const MeshSamples samples = samplesOf(sphere, 0.06);
  for (std::uint64_t motion = 0; motion < 5; ++motion) {
    const Mat3 rotation = randomRotation(motion);
    const Vec3 shift(random(motion), 5 * random(motion + 50), -3 * random(motion + 100));
    const double scale = std::exp(6 * random(motion + 150) - 3);
    const MeshSamples moved = samplesOf(mappedMesh(sphere, scale * rotation, shift), scale * 0.06);
    ASSERT_EQ(moved.points.size(), samples.points.size());
    double worst = 0;
    for (std::size_t i = 0; i < samples.points.size(); ++i) {
      worst = std::max(worst, (scale * rotation * samples.points[i] + shift - moved.points[i]).norm());
    }
    EXPECT_LE(worst, 1e-9 * scale);
    EXPECT_NEAR(moved.variation, samples.variation, 1e-9);
  }
}

TEST(SurfaceCvt, SamplesOfABigTriangleAndOfTinyOnes) {
  mesh::TriangleMesh triangle;
  triangle.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  triangle.triangles = {{0, 1, 2}};
  const MeshSamples many = samplesOf(triangle, 0.01);
  EXPECT_EQ(many.points.size(), 5774U);
  EXPECT_LE(many.variation, 0.12);
  const MeshSamples few = samplesOf(icosphere(5, 1), 1.2);
  EXPECT_EQ(few.points.size(), 10U);
  EXPECT_GE(few.meanSpacing, 0.7);
}

TEST(SurfaceCvt, OneSampleAtLeast) {
  const MeshSamples samples = samplesOf(icosphere(1, 1), 100);
  ASSERT_EQ(samples.points.size(), 1U);
  EXPECT_EQ(samples.variation, 0);
  // Of one site on a square the centroid is the middle.
  EXPECT_LE((samplesOf(squareMesh(5, 2), 100).points.at(0) - Vec3(1, 1, 0)).norm(), kRounding);
}

TEST(SurfaceCvt, NothingToSample) {
  EXPECT_TRUE(samplesOf({}, 1).points.empty());
  mesh::TriangleMesh flat;
  flat.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  flat.triangles = {{0, 1, 2}};
  EXPECT_TRUE(samplesOf(flat, 1).points.empty());
}

TEST(SurfaceCvt, TrianglesWithoutAreaGetNoSamples) {
  mesh::TriangleMesh mesh = squareMesh(2, 1);
  const auto whole = static_cast<Index>(mesh.triangles.size());
  mesh.triangles.insert(mesh.triangles.begin(), {0, 1, 1});
  mesh.triangles.push_back({0, 0, 0});
  const MeshSamples samples = samplesOf(mesh, 0.05);
  EXPECT_NEAR(static_cast<double>(samples.points.size()), 1 / (std::numbers::sqrt3 / 2 * 0.05 * 0.05), 0.5);
  for (const Index triangle : samples.triangles) {
    EXPECT_GE(triangle, 1);
    EXPECT_LE(triangle, whole);
  }
}

TEST(SurfaceCvt, BadInput) {
  const mesh::TriangleMesh square = squareMesh(1, 1);
  EXPECT_THROW(samplesOf(square, 0), UsageError);
  EXPECT_THROW(samplesOf(square, -1), UsageError);
  EXPECT_THROW(samplesOf(square, std::numeric_limits<double>::quiet_NaN()), UsageError);
  EXPECT_THROW(samplesOf(square, 1e-9), UsageError);
  EXPECT_THROW(samplesOf(square, 0.1, -1), UsageError);
  mesh::TriangleMesh broken = square;
  broken.vertices[0][1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(samplesOf(broken, 0.1), UsageError);
}

}  // namespace
}  // namespace voroform::metrics
