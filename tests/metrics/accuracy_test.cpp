// Accuracy figures of pairs of surfaces with known distances.
#include "voroform/metrics/accuracy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "accuracy_lines.hpp"
#include "accuracy_support.hpp"
#include "support/complexes.hpp"
#include "support/surface_meshes.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::metrics {
namespace {

using test::measure;
using test::random;
using test::sphereSamples;
using testing::icosphere;
using testing::joined;
using testing::solidOf;

// Shapes here have coordinates of order one.
constexpr double kRounding = 1e-12;
// Nearest points of S are bracketed to 1e-10 of the search's reach, which is twice the cell size.
constexpr double kBracket = 1e-9;

// Points on the faces of a box, none on its edges.
SurfaceSamples boxSamples(const Vec3& min, const Vec3& max, int perEdge) {
  SurfaceSamples samples;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      for (int i = 0; i < perEdge * perEdge; ++i) {
        Vec3 unit;
        unit[axis] = side < 0 ? 0 : 1;
        unit[(axis + 1) % 3] = (i % perEdge + 0.5) / perEdge;
        unit[(axis + 2) % 3] = (i / perEdge + 0.5) / perEdge;
        samples.points.push_back(min + unit.cwiseProduct(max - min));
        samples.normals.push_back(side * Vec3::Unit(axis));
      }
    }
  }
  return samples;
}

implicit::ImplicitPtr boxAt(const Vec3& min, const Vec3& max) {
  return implicit::transformed(implicit::box(max - min), Mat3::Identity(), (min + max) / 2);
}

// Integrals over the facets of a mesh inscribed in the unit sphere, about a concentric sphere of the radius given; by
// the centroids of `parts`² equal triangles a facet.
struct FacetMeans {
  double distance = 0;
  double squaredDistance = 0;
  double most = 0;
  double angle = 0;
  double squaredAngle = 0;
};

FacetMeans facetMeans(const mesh::TriangleMesh& mesh, double radius, int parts) {
  FacetMeans sums;
  double total = 0;
  for (const auto& triangle : mesh.triangles) {
    const auto corner = [&](std::size_t k) -> const Vec3& {
      return mesh.vertices[static_cast<std::size_t>(triangle[k])];
    };
    const Vec3 u = (corner(1) - corner(0)) / parts;
    const Vec3 v = (corner(2) - corner(0)) / parts;
    const Vec3 normal = u.cross(v).normalized();
    const double area = u.cross(v).norm() / 2;
    const auto add = [&](double i, double j) {
      const Vec3 p = corner(0) + i * u + j * v;
      const double distance = std::abs(radius - p.norm());
      const double angle = std::acos(std::min(1.0, normal.dot(p) / p.norm()));
      sums.distance += area * distance;
      sums.squaredDistance += area * distance * distance;
      sums.most = std::max(sums.most, distance);
      sums.angle += area * angle;
      sums.squaredAngle += area * angle * angle;
      total += area;
    };
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        add(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j + 1 < parts) add(i + 2.0 / 3, j + 2.0 / 3);
      }
    }
  }
  return {sums.distance / total, sums.squaredDistance / total, sums.most, sums.angle / total,
          sums.squaredAngle / total};
}

// The distance from p to a convex polyhedron's surface near a facet, over all facets: by the definition, minimizing
// over each triangle's plane, edges and corners.
double bruteForceDistance(const mesh::TriangleMesh& mesh, const Vec3& p) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& triangle : mesh.triangles) {
    const auto corner = [&](std::size_t k) -> const Vec3& {
      return mesh.vertices[static_cast<std::size_t>(triangle[k])];
    };
    const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
    const double height = normal.dot(p - corner(0));
    bool above = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 edge = corner((k + 1) % 3) - corner(k);
      above = above && normal.dot(edge.cross(p - corner(k))) >= 0;
      const double t = std::clamp(edge.dot(p - corner(k)) / edge.squaredNorm(), 0.0, 1.0);
      best = std::min(best, (corner(k) + t * edge - p).norm());
    }
    if (above) best = std::min(best, std::abs(height));
  }
  return best;
}

Vec3 randomDirection(std::uint64_t index) { return randomRotation(index) * Vec3::UnitX(); }

TEST(AccuracyLines, CrossingsOfAMeshByExhaustion) {
  const mesh::TriangleMesh polyhedron = icosphere(2, 1);
  const LineCrossings crossings(polyhedron);
  int hits = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Vec3 origin(3 * random(3 * i) - 1.5, 3 * random(3 * i + 1) - 1.5, 3 * random(3 * i + 2) - 1.5);
    const Vec3 direction = randomDirection(i);
    double expected = std::numeric_limits<double>::infinity();
    for (const auto& triangle : polyhedron.triangles) {
      const auto corner = [&](std::size_t k) { return polyhedron.vertices[static_cast<std::size_t>(triangle[k])]; };
      Mat3 system;
      system << corner(1) - corner(0), corner(2) - corner(0), -direction;
      const Vec3 solution = system.inverse() * (origin - corner(0));
      if (solution[0] < 0 || solution[1] < 0 || solution[0] + solution[1] > 1) continue;
      expected = std::min(expected, std::abs(solution[2]));
    }
    for (const double guess : {0.0, 0.2, 5.0}) {
      const std::optional<double> found = crossings.nearest({origin, direction, guess, 1});
      ASSERT_EQ(found.has_value(), expected <= 1) << i;
      if (found) {
        EXPECT_NEAR(*found, expected, kRounding);
      }
    }
    if (expected <= 1) ++hits;
  }
  EXPECT_GT(hits, 100);
  EXPECT_LT(hits, 299);
}

TEST(AccuracyLines, LinesThroughEdgesAndCornersCross) {
  const mesh::TriangleMesh polyhedron = icosphere(1, 1);
  const LineCrossings crossings(polyhedron);
  for (const auto& [a, b, c] : polyhedron.triangles) {
    const Vec3& corner = polyhedron.vertices[static_cast<std::size_t>(a)];
    const Vec3 middle = (corner + polyhedron.vertices[static_cast<std::size_t>(b)]) / 2;
    for (const Vec3& place : {corner, middle}) {
      const std::optional<double> found = crossings.nearest({0.5 * place, place.normalized(), 0, 2});
      ASSERT_TRUE(found.has_value());
      EXPECT_NEAR(*found, 0.5 * place.norm(), kRounding);
    }
  }
}

TEST(AccuracyLines, CrossingsOfASphere) {
  const implicit::ImplicitPtr sphere = implicit::sphere(1);
  int hits = 0;
  for (std::uint64_t i = 0; i < 300; ++i) {
    const Vec3 origin = (0.3 + random(2 * i)) * randomDirection(i);
    const Vec3 direction = randomDirection(1000 + i);
    // ‖origin + t·direction‖ = 1
    const double half = origin.dot(direction);
    const double square = half * half - origin.squaredNorm() + 1;
    // Where the line all but touches, both crossings may lie within a step.
    if (square < 0.01) continue;
    const double expected = std::min(std::abs(-half + std::sqrt(square)), std::abs(-half - std::sqrt(square)));
    for (const double guess : {0.0, expected, 10.0}) {
      const std::optional<double> found = crossingOfForm(*sphere, {origin, direction, guess, 0.7}, 0.4);
      ASSERT_EQ(found.has_value(), expected <= 0.7) << i;
      if (found) {
        EXPECT_NEAR(*found, expected, 10 * kRounding);
      }
    }
    if (expected <= 0.7) ++hits;
  }
  EXPECT_GT(hits, 150);
  EXPECT_LT(hits, 280);
}

TEST(Accuracy, ConcentricSpheres) {
  // Facets of the inner polyhedron lie between radius 1 − sagitta and 1, so no distance of either direction, nor any
  // along the radius, leaves [gap, gap + sagitta]; a facet's normal deviates from the radius by acos(1 − sagitta).
  const mesh::TriangleMesh inner = icosphere(5, 1);
  double least = 1;
  for (const auto& [a, b, c] : inner.triangles) {
    const auto at = [&](Index i) -> const Vec3& { return inner.vertices[static_cast<std::size_t>(i)]; };
    least = std::min(least, (at(b) - at(a)).cross(at(c) - at(a)).normalized().dot(at(a)));
  }
  const double sagitta = 1 - least;
  ASSERT_LT(sagitta, 1e-3);
  for (const double gap : {0.1, 0.01, -0.05}) {
    const double outer = 1 + gap;
    const Accuracy result = measure(solidOf(inner), *implicit::sphere(outer), sphereSamples(outer, 5000), 0.12);
    const double low = gap > 0 ? gap : -gap - sagitta;
    for (const DirectedAccuracy& direction : {result.fromForm, result.fromBoundary}) {
      EXPECT_GE(direction.mean, low - kBracket);
      EXPECT_LE(direction.mean, low + sagitta + kBracket);
      EXPECT_GE(direction.rms, direction.mean);
      EXPECT_LE(direction.max, low + sagitta + kBracket);
      EXPECT_GT(direction.normalMean, 0);
      EXPECT_LE(direction.normalMean, std::acos(1 - sagitta));
      EXPECT_GT(direction.samples, 4000);
      EXPECT_EQ(direction.unfound + direction.envelope, 0);
    }
    EXPECT_NEAR(result.dmean, (result.fromForm.mean + result.fromBoundary.mean) / 2, kRounding);
    EXPECT_EQ(result.dmax, std::max(result.fromForm.max, result.fromBoundary.max));
    EXPECT_GE(result.normalLine.mean, low);
    EXPECT_LE(result.normalLine.mean, (low + sagitta) / std::pow(1 - sagitta, 2));
    EXPECT_EQ(result.normalLine.misses, 0);
    EXPECT_NEAR(result.diagonal, 2 * std::numbers::sqrt3 * outer, 0.01);
  }
}

TEST(Accuracy, InscribedPolyhedraAgainstTheirIntegrals) {
  // Of the samples' figures to the integrals': regular samples are far better than the 1/√n of random ones.
  const double tolerance = 0.02;
  for (const int level : {1, 2, 3}) {
    const mesh::TriangleMesh polyhedron = icosphere(level, 1);
    const FacetMeans expected = facetMeans(polyhedron, 1, 40);
    AccuracyPairs pairs;
    const SurfaceSamples samples = sphereSamples(1, 4000);
    const Accuracy result = measure(solidOf(polyhedron), *implicit::sphere(1), samples, 0.1, &pairs);
    const DirectedAccuracy& there = result.fromBoundary;
    EXPECT_NEAR(there.mean, expected.distance, tolerance * expected.distance);
    EXPECT_NEAR(there.rms, std::sqrt(expected.squaredDistance), tolerance * std::sqrt(expected.squaredDistance));
    EXPECT_NEAR(there.normalMean, expected.angle, tolerance * expected.angle);
    EXPECT_NEAR(there.normalRms, std::sqrt(expected.squaredAngle), tolerance * std::sqrt(expected.squaredAngle));
    EXPECT_LE(there.max, 1.001 * expected.most);
    EXPECT_GE(there.max, 0.95 * expected.most);

    ASSERT_EQ(pairs.fromForm.size(), samples.points.size());
    double sum = 0;
    for (std::size_t i = 0; i < samples.points.size(); i += 7) {
      const double distance = bruteForceDistance(polyhedron, samples.points[i]);
      EXPECT_NEAR(pairs.fromForm[i].distance, distance, kRounding);
      sum += distance;
    }
    const double mean = sum / std::ceil(static_cast<double>(samples.points.size()) / 7);
    EXPECT_NEAR(result.fromForm.mean, mean, 0.05 * mean);
  }
}

TEST(Accuracy, PairsAreTheSamplesAndTheirNearestPoints) {
  const mesh::TriangleMesh polyhedron = icosphere(2, 1);
  const SurfaceSamples samples = sphereSamples(1, 500);
  AccuracyPairs pairs;
  const Accuracy result = measure(solidOf(polyhedron), *implicit::sphere(1), samples, 0.3, &pairs);
  ASSERT_EQ(static_cast<std::int64_t>(pairs.fromBoundary.size()), result.fromBoundary.samples);
  for (std::size_t i = 0; i < samples.points.size(); ++i) EXPECT_EQ(pairs.fromForm[i].sample, samples.points[i]);
  double sum = 0;
  for (const AccuracyPair& pair : pairs.fromBoundary) {
    EXPECT_NEAR(pair.nearest.norm(), 1, kBracket);
    EXPECT_NEAR((pair.nearest - pair.sample).norm(), pair.distance, kBracket);
    EXPECT_LE(bruteForceDistance(polyhedron, pair.sample), kRounding);
    sum += pair.angle;
  }
  EXPECT_NEAR(result.fromBoundary.normalMean, sum / static_cast<double>(pairs.fromBoundary.size()), kRounding);
}

TEST(Accuracy, SurfaceAgainstItself) {
  const Vec3 size = Vec3::Constant(3);
  const Accuracy result =
      measure(testing::block(3), *boxAt(Vec3::Zero(), size), boxSamples(Vec3::Zero(), size, 30), 0.5);
  EXPECT_LE(result.dmax, kRounding);
  EXPECT_LE(result.nmean, kRounding);
  EXPECT_LE(result.nrmse, kRounding);
  EXPECT_LE(result.normalLine.rms, kRounding);
  EXPECT_EQ(result.normalLine.misses, 0);
  EXPECT_EQ(result.fromForm.samples, 5400);
  EXPECT_EQ(result.fromBoundary.unfound, 0);
  EXPECT_GT(result.fromBoundary.samples, 2000);
}

TEST(Accuracy, ShiftedBox) {
  // B = [0, 3]³, S = B moved by 0.1 along x. From S, by faces of 9 units of area: 0.1 from x = 3.1; from x = 0.1 to the
  // nearest of five faces; 0 from the others, but for the strip beyond x = 3.
  const double shift = 0.1;
  const Vec3 offset(shift, 0, 0);
  const SurfaceSamples samples = boxSamples(offset, Vec3::Constant(3) + offset, 60);
  const Accuracy result = measure(testing::block(3), *boxAt(offset, Vec3::Constant(3) + offset), samples, 0.3);
  double sum = 0;
  for (const Vec3& p : samples.points) {
    const Vec3 toOutside = (p - Vec3::Constant(1.5)).cwiseAbs() - Vec3::Constant(1.5);
    sum += toOutside.maxCoeff() > 0 ? toOutside.cwiseMax(0).norm() : -toOutside.maxCoeff();
  }
  EXPECT_NEAR(result.fromForm.mean, sum / static_cast<double>(samples.points.size()), kRounding);
  EXPECT_NEAR(result.fromForm.max, shift, kRounding);
  // The mirror image x → 3.1 − x exchanges both surfaces; the sums over a grid and over a CVT differ by little.
  EXPECT_NEAR(result.fromBoundary.mean, result.fromForm.mean, 0.02 * shift);
  EXPECT_NEAR(result.fromBoundary.max, shift, kBracket);
}

// The solid below the plane z = height within an envelope [0, 3]² × [0, 9], and its measured surface.
struct Slab {
  implicit::ImplicitPtr form;
  SurfaceSamples samples;
};

Slab slab(double height) {
  const implicit::ImplicitPtr wide = boxAt(Vec3(-50, -50, -50), Vec3(50, 50, height));
  Slab result = {implicit::enveloped(wide, Box3(Vec3::Zero(), Vec3(3, 3, 9))), {}};
  for (int i = 0; i < 900; ++i) {
    result.samples.points.emplace_back((i % 30 + 0.5) / 10, (i / 30 + 0.5) / 10, height);
    result.samples.normals.push_back(Vec3::UnitZ());
  }
  return result;
}

mesh::PolyhedralComplex openBlock() {
  mesh::PolyhedralComplex complex = testing::block(3);
  for (Index f = 0; f < complex.faceCount(); ++f) {
    if (!complex.isBoundary(f)) continue;
    bool top = true;
    for (const Index v : complex.face(f)) top = top && complex.vertices[static_cast<std::size_t>(v)][2] == 3;
    complex.faceTags[static_cast<std::size_t>(f)] = top ? mesh::FaceTag::surface : mesh::FaceTag::envelope;
  }
  return complex;
}

TEST(Accuracy, ShiftedPlaneInAnEnvelope) {
  for (const double shift : {0.1, -0.22}) {
    const Slab other = slab(3 + shift);
    const double depth = std::abs(shift);
    AccuracyPairs pairs;
    const Accuracy result = measure(openBlock(), *other.form, other.samples, 0.2, &pairs);
    EXPECT_NEAR(result.fromForm.mean, depth, kRounding);
    EXPECT_NEAR(result.fromForm.max, depth, kRounding);
    EXPECT_NEAR(result.fromBoundary.mean, depth, kBracket);
    EXPECT_NEAR(result.dmean, depth, kBracket);
    EXPECT_NEAR(result.drmse, depth, kBracket);
    EXPECT_NEAR(result.nmean, 0, kBracket);
    EXPECT_NEAR(result.nrmse, 0, kBracket);
    EXPECT_EQ(result.fromBoundary.unfound, 0);
    // Seen from below the other surface, samples nearer to the envelope's sides are left out; from above none are. Of
    // the 30 columns of samples of S two on either side are then nearer than 0.22.
    const auto all = static_cast<double>(result.fromBoundary.samples + result.fromBoundary.envelope);
    const double inner = shift > 0 ? std::pow(3 - 2 * shift, 2) / 9 : 1;
    EXPECT_NEAR(static_cast<double>(result.fromBoundary.samples) / all, inner, 0.02);
    EXPECT_EQ(result.fromForm.samples, shift > 0 ? 900 : 26 * 26);
    EXPECT_EQ(result.fromForm.samples + result.fromForm.envelope, 900);
    EXPECT_EQ(static_cast<std::int64_t>(pairs.fromForm.size()), result.fromForm.samples);
    EXPECT_EQ(static_cast<std::int64_t>(pairs.fromBoundary.size()), result.fromBoundary.samples);
    EXPECT_NEAR(result.normalLine.mean, depth, kBracket);
    EXPECT_EQ(result.normalLine.misses, 0);
  }
}

TEST(Accuracy, TiltedFacets) {
  // The top replaced by a pyramid of slope 1/5: all angles are atan(1/5), and the distance of z = 3 from it is what
  // the facets' planes say.
  mesh::TriangleMesh roof;
  roof.vertices = {{0, 0, 3}, {3, 0, 3}, {3, 3, 3}, {0, 3, 3}, {1.5, 1.5, 3.3}};
  roof.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const Slab flat = slab(3);
  const Accuracy result = measure(solidOf(roof), *flat.form, flat.samples, 0.2);
  const double slope = std::atan(0.2);
  EXPECT_NEAR(result.fromForm.normalMean, slope, kRounding);
  EXPECT_NEAR(result.fromForm.normalRms, slope, kRounding);
  EXPECT_NEAR(result.fromBoundary.normalMean, slope, kBracket);
  // A pyramid's mean height is a third of its height; along z that is the distance from B to S.
  EXPECT_NEAR(result.fromBoundary.mean, 0.1, 0.002);
  EXPECT_NEAR(result.fromForm.mean, 0.1 * std::cos(slope), 0.002);
  // Along the facets' normals, and from S upward.
  EXPECT_NEAR(result.normalLine.mean, (0.1 + 0.1 / std::cos(slope)) / 2, 0.002);
  // Turned inside out.
  for (auto& triangle : roof.triangles) std::swap(triangle[0], triangle[1]);
  EXPECT_NEAR(measure(solidOf(roof), *flat.form, flat.samples, 0.2).nmean, std::numbers::pi - slope, kBracket);
}

TEST(Accuracy, MissesAlongNormalsCountAsReach) {
  // With h = 0.045 the gap of 0.1 lies beyond 2h = 0.09, yet nearest points are found.
  const mesh::TriangleMesh inner = icosphere(4, 0.5);
  const Accuracy result = measure(solidOf(inner), *implicit::sphere(0.6), sphereSamples(0.6, 1000), 0.045);
  EXPECT_EQ(result.normalLine.misses, result.fromForm.samples + result.fromBoundary.samples);
  EXPECT_NEAR(result.normalLine.mean, 0.09, kRounding);
  EXPECT_NEAR(result.normalLine.rms, 0.09, kRounding);
  EXPECT_EQ(result.fromBoundary.unfound, 0);
  EXPECT_NEAR(result.dmean, 0.1, 1e-3);
}

TEST(Accuracy, PartsOutOfReachAreUnfound) {
  // A second sphere a hundred cells away from S.
  const mesh::TriangleMesh near = icosphere(3, 1);
  const mesh::TriangleMesh far = testing::mappedMesh(near, Mat3::Identity(), Vec3(22, 0, 0));
  const Accuracy alone = measure(solidOf(near), *implicit::sphere(1), sphereSamples(1, 1000), 0.2);
  const Accuracy both = measure(solidOf(joined(near, far)), *implicit::sphere(1), sphereSamples(1, 1000), 0.2);
  EXPECT_EQ(alone.fromBoundary.unfound, 0);
  EXPECT_NEAR(static_cast<double>(both.fromBoundary.unfound), static_cast<double>(both.fromBoundary.samples), 5);
  EXPECT_NEAR(both.fromBoundary.mean, alone.fromBoundary.mean, 0.05 * alone.fromBoundary.mean);
  EXPECT_THROW(measure(solidOf(far), *implicit::sphere(1), sphereSamples(1, 1000), 0.2), MethodError);
}

TEST(Accuracy, MissingPartShowsFromTheFormOnly) {
  // Of two spheres the boundary has one.
  const mesh::TriangleMesh one = icosphere(4, 1);
  const implicit::ImplicitPtr two = implicit::unionOf(
      implicit::sphere(1), implicit::transformed(implicit::sphere(1), Mat3::Identity(), Vec3(3, 0, 0)));
  SurfaceSamples samples = sphereSamples(1, 1000);
  for (std::size_t i = 0; i < 1000; ++i) {
    samples.points.emplace_back(samples.points[i] + Vec3(3, 0, 0));
    samples.normals.emplace_back(samples.normals[i]);
  }
  const Accuracy result = measure(solidOf(one), *two, samples, 0.1);
  EXPECT_LE(result.fromBoundary.max, 0.01);
  EXPECT_NEAR(result.fromForm.max, 3, 0.01);
  // From the far sphere, uniform over it: mean ‖x‖ − 1 = d + 1/(3d) − 1 for its center at d = 3.
  EXPECT_NEAR(result.fromForm.mean, (2 + 1.0 / 9) / 2, 0.01);
}

}  // namespace
}  // namespace voroform::metrics
