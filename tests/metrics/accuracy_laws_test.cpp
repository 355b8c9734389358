// Laws that the accuracy figures keep: scale, motions, order of convergence, threads, seeds; and what they refuse.
#include "voroform/metrics/accuracy.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "accuracy_support.hpp"
#include "support/complexes.hpp"
#include "support/marching_cubes.hpp"
#include "support/surface_meshes.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/implicit/closest_point.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::metrics {
namespace {

using test::measure;
using test::ofSize;
using test::random;
using test::sphereSamples;
using testing::icosphere;
using testing::mapped;
using testing::solidOf;

// Samples of S near a mesh of it.
SurfaceSamples samplesNear(const implicit::ImplicitFunction& f, const mesh::TriangleMesh& mesh, double spacing) {
  SurfaceCvtOptions options;
  options.spacing = spacing;
  const MeshSamples start = surfaceCvt(mesh, options, RunContext{});
  SurfaceSamples samples;
  for (const Vec3& point : start.points) {
    const implicit::ClosestPoint nearest = implicit::closestPoint(f, point, 3 * spacing);
    if (!nearest.found) throw std::runtime_error("no surface near the mesh");
    samples.points.push_back(nearest.position);
    samples.normals.push_back(nearest.normal);
  }
  return samples;
}

struct Case {
  implicit::ImplicitPtr form;
  mesh::PolyhedralComplex complex;
  SurfaceSamples samples;
  double cellSize = 0;
};

Case torusCase() {
  Case result;
  result.form = implicit::torus(1, 0.4);
  result.cellSize = 0.15;
  const mesh::TriangleMesh mesh =
      testing::marchingCubes(*result.form, result.cellSize, implicit::RootFinder::itp, 1e-12);
  result.complex = solidOf(mesh);
  result.samples = samplesNear(*result.form, mesh, result.cellSize / 3);
  return result;
}

Case moved(const Case& original, const Mat3& rotation, const Vec3& shift, double scale) {
  Case result = original;
  result.form = implicit::transformed(original.form, rotation, shift, scale);
  result.complex = mapped(original.complex, scale * rotation, shift);
  for (Vec3& point : result.samples.points) point = scale * rotation * point + shift;
  for (Vec3& normal : result.samples.normals) normal = rotation * normal;
  result.cellSize *= scale;
  return result;
}

Accuracy measure(const Case& c) { return measure(c.complex, *c.form, c.samples, c.cellSize); }

void expectScaled(const Accuracy& a, const Accuracy& b, double scale) {
  const double tolerance = 1e-7;
  EXPECT_NEAR(b.dmean, scale * a.dmean, tolerance * scale * a.dmean);
  EXPECT_NEAR(b.drmse, scale * a.drmse, tolerance * scale * a.drmse);
  EXPECT_NEAR(b.dmax, scale * a.dmax, tolerance * scale * a.dmax);
  EXPECT_NEAR(b.normalLine.mean, scale * a.normalLine.mean, tolerance * scale * a.normalLine.mean);
  EXPECT_NEAR(b.fromBoundary.normalMean, a.fromBoundary.normalMean, tolerance);
  EXPECT_NEAR(b.fromBoundary.normalRms, a.fromBoundary.normalRms, tolerance);
  // Nearest points on edges have two triangles, and rounding chooses.
  EXPECT_NEAR(b.nmean, a.nmean, 0.01 * a.nmean);
  EXPECT_NEAR(b.nrmse, a.nrmse, 0.01 * a.nrmse);
  EXPECT_EQ(b.fromBoundary.samples, a.fromBoundary.samples);
  EXPECT_NEAR(b.cellSize, scale * a.cellSize, tolerance * scale);
}

TEST(Accuracy, ScalesWithTheSurfaces) {
  const Case original = torusCase();
  const Accuracy accuracy = measure(original);
  for (const double scale : {1e-4, 7.0, 3e5}) {
    expectScaled(accuracy, measure(moved(original, Mat3::Identity(), Vec3::Zero(), scale)), scale);
  }
}

TEST(Accuracy, InvariantUnderRigidMotions) {
  const Case original = torusCase();
  const Accuracy accuracy = measure(original);
  for (std::uint64_t motion = 0; motion < 4; ++motion) {
    const Vec3 shift(4 * random(3 * motion) - 2, 4 * random(3 * motion + 1) - 2, 4 * random(3 * motion + 2) - 2);
    expectScaled(accuracy, measure(moved(original, randomRotation(motion), shift, 1)), 1);
  }
}

TEST(Accuracy, ConvergesWithOrderTwo) {
  // Distances of a smooth surface's interpolating triangles fall with h², angles with h.
  std::vector<double> distances;
  std::vector<double> angles;
  for (const int level : {2, 3, 4}) {
    const Accuracy result = measure(solidOf(icosphere(level, 1)), *implicit::sphere(1), sphereSamples(1, 4000), 0.1);
    distances.push_back(result.dmean);
    angles.push_back(result.nmean);
  }
  for (std::size_t i = 1; i < 3; ++i) {
    EXPECT_NEAR(std::log2(distances[i - 1] / distances[i]), 2, 0.1);
    EXPECT_NEAR(std::log2(angles[i - 1] / angles[i]), 1, 0.1);
  }
}

TEST(Accuracy, GrownTessellation) {
  // Tessellations are told from the same ones 1 % larger, and caps of the third kind from those of the first.
  const implicit::ImplicitPtr form = implicit::sphere(1);
  cvt::TessellateOptions options;
  options.sites = 1000;
  const mesh::PolyhedralComplex fine = cvt::tessellate(*form, {}, options, RunContext{}).complex;
  options.cap = voronoi::CapKind::cvt1;
  const mesh::PolyhedralComplex coarse = cvt::tessellate(*form, {}, options, RunContext{}).complex;
  const SurfaceSamples samples = sphereSamples(1, 3000);
  const double cellSize = std::cbrt(4 * std::numbers::pi / 3 / options.sites);
  const Accuracy third = measure(fine, *form, samples, cellSize);
  const Accuracy first = measure(coarse, *form, samples, cellSize);
  EXPECT_LE(third.dmean, 2e-3);
  EXPECT_LE(third.dmean, 0.6 * first.dmean);
  EXPECT_LE(third.nmean, first.nmean);
  const Accuracy grown = measure(mapped(fine, 1.01 * Mat3::Identity(), Vec3::Zero()), *form, samples, cellSize);
  // Interpolating facets lie inside the sphere: a point at 1 − d comes to 1.01·(1 − d).
  EXPECT_NEAR(grown.dmean, 0.01 - 1.01 * third.dmean, 0.05 * third.dmean);
  EXPECT_NEAR(grown.nmean, third.nmean, 0.1 * third.nmean);
}

TEST(Accuracy, SameBitsForAnyNumberOfThreads) {
  const Case torus = torusCase();
  const auto run = [&](int threads, AccuracyPairs& pairs) {
    RunContext context;
    context.threads = threads;
    return accuracy(torus.complex, *torus.form, torus.samples, ofSize(torus.cellSize), context, &pairs);
  };
  AccuracyPairs onePairs;
  AccuracyPairs threePairs;
  const Accuracy one = run(1, onePairs);
  const Accuracy three = run(3, threePairs);
  EXPECT_EQ(one.dmean, three.dmean);
  EXPECT_EQ(one.drmse, three.drmse);
  EXPECT_EQ(one.nmean, three.nmean);
  EXPECT_EQ(one.nrmse, three.nrmse);
  EXPECT_EQ(one.normalLine.mean, three.normalLine.mean);
  ASSERT_EQ(onePairs.fromBoundary.size(), threePairs.fromBoundary.size());
  for (std::size_t i = 0; i < onePairs.fromBoundary.size(); ++i) {
    EXPECT_EQ(onePairs.fromBoundary[i].nearest, threePairs.fromBoundary[i].nearest);
  }
}

TEST(Accuracy, SeedMovesTheSamplesOfTheBoundary) {
  const mesh::PolyhedralComplex solid = solidOf(icosphere(2, 1));
  const SurfaceSamples samples = sphereSamples(1, 500);
  const Accuracy a = accuracy(solid, *implicit::sphere(1), samples, ofSize(0.2, 1), RunContext{});
  const Accuracy b = accuracy(solid, *implicit::sphere(1), samples, ofSize(0.2, 2), RunContext{});
  EXPECT_EQ(a.fromForm.mean, b.fromForm.mean);
  EXPECT_NE(a.fromBoundary.mean, b.fromBoundary.mean);
  EXPECT_NEAR(a.fromBoundary.mean, b.fromBoundary.mean, 0.05 * a.fromBoundary.mean);
}

TEST(Accuracy, BadInput) {
  const implicit::ImplicitPtr form = implicit::sphere(1);
  const mesh::PolyhedralComplex solid = solidOf(icosphere(1, 1));
  const SurfaceSamples samples = sphereSamples(1, 10);
  EXPECT_THROW(measure(solid, *form, samples, 0), UsageError);
  EXPECT_THROW(measure(solid, *form, samples, std::numeric_limits<double>::quiet_NaN()), UsageError);
  EXPECT_THROW(measure(solid, *form, {}, 0.1), UsageError);
  SurfaceSamples bare = samples;
  bare.normals.pop_back();
  EXPECT_THROW(measure(solid, *form, bare, 0.1), UsageError);
  EXPECT_THROW(measure({}, *form, samples, 0.1), MethodError);
  mesh::PolyhedralComplex enveloped = solid;
  for (mesh::FaceTag& tag : enveloped.faceTags) tag = mesh::FaceTag::envelope;
  EXPECT_THROW(measure(enveloped, *form, samples, 0.1), MethodError);
}

}  // namespace
}  // namespace voroform::metrics
