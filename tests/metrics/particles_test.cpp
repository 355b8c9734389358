#include "voroform/metrics/particles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::metrics {
namespace {

using ::testing::HasSubstr;

constexpr double kPi = std::numbers::pi;

RunContext threads(int count) {
  RunContext context;
  context.threads = count;
  return context;
}

double distanceToNearest(const SurfaceSamples& samples, const Vec3& place) {
  double squared = std::numeric_limits<double>::infinity();
  for (const Vec3& point : samples.points) squared = std::min(squared, (point - place).squaredNorm());
  return std::sqrt(squared);
}

struct Spread {
  double mean = 0;
  double variation = 0;
};

// Of the distances to the nearest other sample, by comparing all pairs.
Spread spreadByBruteForce(const std::vector<Vec3>& points) {
  std::vector<double> distances;
  for (const Vec3& a : points) {
    double squared = std::numeric_limits<double>::infinity();
    for (const Vec3& b : points) {
      if (&a != &b) squared = std::min(squared, (a - b).squaredNorm());
    }
    distances.push_back(std::sqrt(squared));
  }
  Spread result;
  const auto count = static_cast<double>(distances.size());
  for (const double distance : distances) result.mean += distance / count;
  double squares = 0;
  for (const double distance : distances) squares += std::pow(distance - result.mean, 2) / count;
  result.variation = std::sqrt(squares) / result.mean;
  return result;
}

void expectOnSurface(const implicit::ImplicitFunction& f, const SurfaceSamples& samples, double spacing) {
  ASSERT_EQ(samples.normals.size(), samples.points.size());
  const double step = 1e-8 * spacing;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    EXPECT_NEAR(samples.normals[i].norm(), 1, 1e-12);
    EXPECT_LT(f.value(samples.points[i] - step * samples.normals[i]), 0);
    EXPECT_GE(f.value(samples.points[i] + step * samples.normals[i]), 0);
  }
}

Vec3 onTorus(std::uint64_t index, double major, double minor) {
  const double u = 2 * kPi * randomUnit(11, RandomStream::test, 2 * index);
  const double v = 2 * kPi * randomUnit(11, RandomStream::test, 2 * index + 1);
  const double ring = major + minor * std::cos(v);
  return {ring * std::cos(u), ring * std::sin(u), minor * std::sin(v)};
}

TEST(Particles, AreRegularOnATorus) {
  const double spacing = 0.06;
  const auto f = implicit::torus(1, 0.4);
  const SurfaceSamples samples = particleSamples(*f, {.spacing = spacing, .seed = 3}, threads(2));
  expectOnSurface(*f, samples, spacing);
  EXPECT_LE(samples.variation, 0.08);
  EXPECT_NEAR(samples.meanSpacing, spacing, 0.05 * spacing);
  EXPECT_GT(samples.iterations, 0);
  const Spread spread = spreadByBruteForce(samples.points);
  EXPECT_NEAR(samples.meanSpacing, spread.mean, 1e-12);
  EXPECT_NEAR(samples.variation, spread.variation, 1e-9);
  for (std::uint64_t i = 0; i < 4000; ++i) EXPECT_LT(distanceToNearest(samples, onTorus(i, 1, 0.4)), spacing);
}

// The outer half of a torus, r(2πR + 4r)·π of its area 4π²Rr, has its share of the samples: they do not gather where
// the surface is curved one way or the other.
TEST(Particles, AreAsDenseEverywhere) {
  const auto f = implicit::torus(1, 0.4);
  const SurfaceSamples samples = particleSamples(*f, {.spacing = 0.05, .seed = 1}, threads(2));
  const auto outer = std::count_if(samples.points.begin(), samples.points.end(),
                                   [](const Vec3& p) { return std::hypot(p.x(), p.y()) > 1; });
  const double share = 0.5 + 0.4 / kPi;
  EXPECT_NEAR(static_cast<double>(outer) / static_cast<double>(samples.points.size()), share, 0.01);
  // And there are as many as the area asks for: a hexagonal lattice has 2/√3 per squared spacing, and where it is not
  // perfect the nearest of six neighbors is nearer than they are in the mean.
  const double area = 4 * kPi * kPi * 0.4;
  const double lattice = 2 / std::sqrt(3.0) * area / (samples.meanSpacing * samples.meanSpacing);
  EXPECT_LT(static_cast<double>(samples.points.size()), lattice);
  EXPECT_GT(static_cast<double>(samples.points.size()), 0.78 * lattice);
}

TEST(Particles, CoverAFormThatIsNoDistanceEvenly) {
  const double spacing = 0.05;
  const Vec3 axes(1, 0.5, 0.25);
  const auto f = implicit::ellipsoid(axes);
  const SurfaceSamples samples = particleSamples(*f, {.spacing = spacing, .seed = 2}, threads(2));
  expectOnSurface(*f, samples, spacing);
  EXPECT_LE(samples.variation, 0.1);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Vec3 direction = randomInBox(4, RandomStream::test, i, Box3(-Vec3::Ones(), Vec3::Ones()));
    EXPECT_LT(distanceToNearest(samples, axes.cwiseProduct(direction.normalized())), spacing);
  }
}

TEST(Particles, CoverEveryComponent) {
  const double spacing = 0.06;
  const auto speck = implicit::transformed(implicit::sphere(0.6 * spacing), Mat3::Identity(), Vec3(1.3, 0.9, -0.4));
  const auto f = implicit::unionOf(implicit::twoTori(), speck);
  const SurfaceSamples samples = particleSamples(*f, {.spacing = spacing}, threads(2));
  int onSpeck = 0;
  for (const Vec3& point : samples.points) onSpeck += (point - Vec3(1.3, 0.9, -0.4)).norm() < spacing ? 1 : 0;
  EXPECT_GE(onSpeck, 2);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Vec3 local = onTorus(i, 0.7, 0.2);
    EXPECT_LT(distanceToNearest(samples, local + Vec3(-0.35, 0, 0)), spacing);
    EXPECT_LT(distanceToNearest(samples, Vec3(local.x() + 0.35, local.z(), local.y())), spacing);
  }
}

// Both faces of a plate that is thinner than the spacing are covered as if the other were not there.
TEST(Particles, DoNotPushThroughAThinPlate) {
  const double spacing = 0.05;
  const auto f = implicit::box(Vec3(1, 1, 0.2 * spacing));
  const SurfaceSamples samples = particleSamples(*f, {.spacing = spacing}, threads(2));
  const double faces = 2 * 2 / std::sqrt(3.0) / (spacing * spacing);
  EXPECT_NEAR(static_cast<double>(samples.points.size()), faces, 0.25 * faces);
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const double x = 0.9 * (randomUnit(1, RandomStream::test, 2 * i) - 0.5);
    const double y = 0.9 * (randomUnit(1, RandomStream::test, 2 * i + 1) - 0.5);
    for (const double side : {-1.0, 1.0}) {
      double nearest = 1;
      for (const Vec3& point : samples.points) {
        if (side * point.z() > 0.05 * spacing) nearest = std::min(nearest, std::hypot(point.x() - x, point.y() - y));
      }
      EXPECT_LT(nearest, spacing);
    }
  }
}

TEST(Particles, CoverABoxUpToItsEdges) {
  const double spacing = 0.08;
  const Vec3 half(0.5, 0.6, 0.4);
  const Mat3 rotation = randomRotation(6);
  const Vec3 center(3, 2, 1);
  const auto f = implicit::transformed(implicit::box(2 * half), rotation, center);
  const SurfaceSamples samples = particleSamples(*f, {.spacing = spacing}, threads(2));
  std::size_t onEdges = 0;
  for (const Vec3& point : samples.points) {
    EXPECT_NEAR(f->value(point), 0, 1e-9 * spacing);
    const Vec3 inside = half - (rotation.transpose() * (point - center)).cwiseAbs();
    onEdges += (inside.array() < 1e-6).count() > 1 ? 1U : 0U;
  }
  EXPECT_LT(static_cast<double>(onEdges), 0.03 * static_cast<double>(samples.points.size()));
  EXPECT_LE(samples.variation, 0.15);
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Vec3 q = randomInBox(2, RandomStream::test, i, Box3(-half, half));
    const auto axis = static_cast<Eigen::Index>(i % 3);
    q[axis] = std::copysign(half[axis], q[axis]);
    EXPECT_LT(distanceToNearest(samples, rotation * q + center), spacing);
  }
}

TEST(Particles, LeaveTheEnvelopeOut) {
  const double spacing = 0.05;
  const auto f = implicit::enveloped(implicit::sphere(1), Box3(Vec3(-2, -2, -2), Vec3(2, 2, 0.3)));
  const SurfaceSamples samples = particleSamples(*f, {.spacing = spacing}, threads(2));
  for (const Vec3& point : samples.points) {
    EXPECT_NEAR(point.norm(), 1, 1e-8);
    EXPECT_LE(point.z(), 0.3);
  }
  EXPECT_LE(samples.variation, 0.15);
  for (std::uint64_t i = 0; i < 4000; ++i) {
    const Vec3 place = randomInBox(9, RandomStream::test, i, Box3(-Vec3::Ones(), Vec3::Ones())).normalized();
    if (place.z() >= 0.3) continue;
    EXPECT_LT(distanceToNearest(samples, place), spacing);
  }
}

TEST(Particles, AreTheSameForAnyNumberOfThreads) {
  const auto f = implicit::bumpySphere();
  const SurfaceSamples one = particleSamples(*f, {.spacing = 0.06, .seed = 5}, threads(1));
  const SurfaceSamples two = particleSamples(*f, {.spacing = 0.06, .seed = 5}, threads(2));
  EXPECT_EQ(one.points, two.points);
  EXPECT_EQ(one.normals, two.normals);
  EXPECT_EQ(one.meanSpacing, two.meanSpacing);
  EXPECT_EQ(one.variation, two.variation);
  const SurfaceSamples other = particleSamples(*f, {.spacing = 0.06, .seed = 6}, threads(2));
  EXPECT_NE(one.points, other.points);
}

TEST(Particles, AreAsRegularOnAMovedAndScaledShape) {
  const auto f = implicit::namedShape("ellipsoid");
  const SurfaceSamples still = particleSamples(*f, {.spacing = 0.06}, threads(2));
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const double scale = std::pow(100.0, static_cast<double>(seed) - 2);
    const auto moved = implicit::transformed(f, randomRotation(seed), scale * Vec3(4, -7, 11), scale);
    const SurfaceSamples samples = particleSamples(*moved, {.spacing = 0.06 * scale}, threads(2));
    EXPECT_NEAR(samples.meanSpacing, scale * still.meanSpacing, 0.02 * scale * still.meanSpacing);
    EXPECT_NEAR(samples.variation, still.variation, 0.02);
    EXPECT_NEAR(static_cast<double>(samples.points.size()), static_cast<double>(still.points.size()),
                0.03 * static_cast<double>(still.points.size()));
  }
}

TEST(Particles, NeedASurfaceAndASpacing) {
  const auto nothing = implicit::intersectionOf(
      implicit::sphere(1), implicit::transformed(implicit::sphere(1), Mat3::Identity(), Vec3(1.5, 1.5, 0)));
  try {
    particleSamples(*nothing, {.spacing = 0.05}, threads(2));
    FAIL() << "no exception";
  } catch (const MethodError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no point of the surface"));
  }
  EXPECT_THROW(particleSamples(*implicit::sphere(1), {.spacing = 0}, threads(2)), UsageError);
  EXPECT_THROW(particleSamples(*implicit::sphere(1), {.spacing = std::nan("")}, threads(2)), UsageError);
  EXPECT_THROW(particleSamples(*implicit::sphere(1), {.spacing = 1e-7}, threads(2)), UsageError);
}

}  // namespace
}  // namespace voroform::metrics
