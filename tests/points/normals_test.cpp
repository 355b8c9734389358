// Estimated normals: on which side they lie, how exact they are, and that threads do not change them.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "voroform/core/random.hpp"
#include "voroform/points/prepare.hpp"

namespace voroform::points {
namespace {

using Surface = std::function<Vec3(double u, double v)>;  // from the unit square

PointCloud sample(std::size_t points, const Surface& surface, std::uint64_t seed) {
  PointCloud cloud;
  for (std::size_t i = 0; i < points; ++i) {
    cloud.positions.push_back(
        surface(randomUnit(seed, RandomStream::test, 2 * i), randomUnit(seed, RandomStream::test, 2 * i + 1)));
  }
  return cloud;
}

Vec3 onSphere(double u, double v) {
  const double z = 2 * u - 1;
  const double angle = 2 * std::numbers::pi * v;
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Vec3 onTorus(double u, double v) {
  const double around = 2 * std::numbers::pi * u;
  const double across = 2 * std::numbers::pi * v;
  const double r = 1 + 0.4 * std::cos(across);
  return {r * std::cos(around), r * std::sin(around), 0.4 * std::sin(across)};
}

PrepareResult prepareCloud(const PointCloud& cloud, int threads = 2) {
  RunContext context;
  context.threads = threads;
  return prepare(cloud, "cloud", PrepareOptions(), context);
}

// Share of normals within `angle` of the true outward one.
double shareWithin(const PointCloud& cloud, const std::function<Vec3(const Vec3&)>& outward, double angle) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    if (cloud.normals[i].dot(outward(cloud.positions[i]).normalized()) > std::cos(angle)) ++count;
  }
  return static_cast<double>(count) / static_cast<double>(cloud.positions.size());
}

constexpr double kRightAngle = std::numbers::pi / 2;
constexpr double kSmallAngle = 0.15;  // plane fits to 18 random points about 0.05 apart on curvature 1

TEST(EstimatedNormals, PointOutOfASphere) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const PrepareResult result = prepareCloud(sample(8000, onSphere, seed));
    EXPECT_TRUE(result.summary.normalsEstimated);
    EXPECT_EQ(result.summary.pieces, 1U);
    EXPECT_EQ(result.summary.points + result.summary.unoriented, 8000U);
    EXPECT_LE(result.summary.unoriented, 8U);
    const auto outward = [](const Vec3& p) { return p; };
    EXPECT_GE(shareWithin(result.cloud, outward, kRightAngle), 0.999);
    EXPECT_GE(shareWithin(result.cloud, outward, kSmallAngle), 0.99);
    for (const Vec3& normal : result.cloud.normals) EXPECT_NEAR(normal.norm(), 1, 1e-14);
  }
}

TEST(EstimatedNormals, PointOutOfATorusFarFromTheOrigin) {
  const Vec3 center(300000, 4500000, 250);
  const PrepareResult result = prepareCloud(sample(
      10000, [&](double u, double v) -> Vec3 { return center + onTorus(u, v); }, 4));
  const Vec3 local = center - result.cloud.frame.origin;
  const auto outward = [&](const Vec3& p) -> Vec3 {
    const Vec3 q = p - local;
    return q - Vec3(q.x(), q.y(), 0).normalized();
  };
  EXPECT_GE(shareWithin(result.cloud, outward, kRightAngle), 0.999);
}

TEST(EstimatedNormals, PointOutOfEachOfTwoSpheres) {
  // Two pieces of the neighborhood graph, one below the other: each is oriented for itself.
  PointCloud cloud = sample(3000, onSphere, 5);
  for (const Vec3& p : sample(3000, onSphere, 6).positions) cloud.positions.push_back(p + Vec3(0.5, 0, -5));
  const PrepareResult result = prepareCloud(cloud);
  EXPECT_EQ(result.summary.pieces, 2U);
  EXPECT_LE(result.summary.unoriented, 6U);
  const auto outward = [](const Vec3& p) -> Vec3 { return p.z() > -2.5 ? p : Vec3(p - Vec3(0.5, 0, -5)); };
  EXPECT_GE(shareWithin(result.cloud, outward, kRightAngle), 0.999);
}

TEST(EstimatedNormals, AreTheSameBitsForAnyNumberOfThreads) {
  const PointCloud cloud = sample(5000, onTorus, 7);
  const PrepareResult one = prepareCloud(cloud, 1);
  const PrepareResult two = prepareCloud(cloud, 2);
  EXPECT_EQ(one.cloud.normals, two.cloud.normals);
  EXPECT_EQ(one.cloud.positions, two.cloud.positions);
  EXPECT_EQ(one.summary.spacing, two.summary.spacing);
}

TEST(EstimatedNormals, ScaleWithTheCloud) {
  PointCloud cloud = sample(2000, onSphere, 8);
  const PrepareResult result = prepareCloud(cloud);
  for (Vec3& position : cloud.positions) position *= 0x1p-30;
  const PrepareResult small = prepareCloud(cloud);
  EXPECT_EQ(small.cloud.normals, result.cloud.normals);
  EXPECT_EQ(small.summary.spacing, result.summary.spacing * 0x1p-30);
}

}  // namespace
}  // namespace voroform::points
