// From raw records to a usable cloud: what is dropped and counted, the frame, what is refused.
#include "voroform/points/prepare.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"

namespace voroform::points {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

PointCloud randomCloud(std::size_t points, const Vec3& low, const Vec3& high) {
  PointCloud cloud;
  const Box3 box(low, high);
  for (std::size_t i = 0; i < points; ++i) {
    cloud.positions.push_back(randomInBox(1, RandomStream::test, i, box));
    cloud.normals.emplace_back(0, 0, 2);
  }
  return cloud;
}

PrepareResult prepareCloud(const PointCloud& cloud) { return prepare(cloud, "cloud", PrepareOptions(), RunContext()); }

std::string errorOf(const PointCloud& cloud) {
  try {
    prepareCloud(cloud);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Prepare, DropsAndCountsWhatCannotBeUsed) {
  PointCloud cloud = randomCloud(60, Vec3(-1, -1, -1), Vec3(1, 1, 1));
  const std::vector<Vec3> positions = cloud.positions;
  cloud.positions[3].y() = kNan;
  cloud.positions[4].x() = -kInfinity;
  cloud.normals[5].z() = kNan;
  cloud.normals[6].setZero();
  cloud.positions[8] = positions[7];
  cloud.positions[59] = positions[7];
  cloud.positions[10] = Vec3(0.0, 0.5, 0.5);
  cloud.positions[11] = Vec3(-0.0, 0.5, 0.5);
  const PrepareResult result = prepareCloud(cloud);
  EXPECT_EQ(result.summary.records, 60U);
  EXPECT_EQ(result.summary.nonFinite, 3U);
  EXPECT_EQ(result.summary.zeroNormals, 1U);
  EXPECT_EQ(result.summary.duplicates, 3U);
  EXPECT_EQ(result.summary.unoriented, 0U);
  EXPECT_EQ(result.summary.points, 53U);
  EXPECT_FALSE(result.summary.normalsEstimated);
  // The others stay, in their order, the first of equals among them.
  std::vector<Vec3> expected;
  const std::set<std::size_t> dropped{3, 4, 5, 6, 8, 11, 59};
  for (std::size_t i = 0; i < 60; ++i) {
    if (!dropped.contains(i)) expected.push_back(cloud.positions[i]);
  }
  EXPECT_EQ(result.cloud.positions, expected);
  EXPECT_THAT(result.cloud.normals, SizeIs(53));
}

TEST(Prepare, NormalizesNormalsOfAnyLength) {
  PointCloud cloud = randomCloud(60, Vec3(-1, -1, -1), Vec3(1, 1, 1));
  cloud.normals[0] = Vec3(3, 0, 4);
  cloud.normals[1] = Vec3(3e300, 0, -4e300);
  cloud.normals[2] = Vec3(3e-320, 0, 4e-320);
  const std::vector<Vec3> normals = prepareCloud(cloud).cloud.normals;
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  constexpr double kDenormalRounding = 1e-3;  // 3e-320 has twelve bits
  EXPECT_NEAR((normals[0] - Vec3(0.6, 0, 0.8)).norm(), 0, kRounding);
  EXPECT_NEAR((normals[1] - Vec3(0.6, 0, -0.8)).norm(), 0, kRounding);
  EXPECT_NEAR((normals[2] - Vec3(0.6, 0, 0.8)).norm(), 0, kDenormalRounding);
  for (const Vec3& normal : normals) EXPECT_NEAR(normal.norm(), 1, kRounding);
}

TEST(Prepare, KeepsTheFrameOfACloudNearTheOrigin) {
  for (const Vec3& low : {Vec3(-1, -1, -1), Vec3(10, 10, 10), Vec3(0, 0, 0)}) {
    const PointCloud cloud = randomCloud(60, low, low + Vec3(2, 2, 2));
    const PrepareResult result = prepareCloud(cloud);
    EXPECT_EQ(result.cloud.frame.origin, Vec3(0, 0, 0));
    EXPECT_EQ(result.cloud.positions, cloud.positions);
  }
}

TEST(Prepare, ShiftsAFarCloudWithoutLosingABit) {
  const std::vector<std::pair<Vec3, double>> cases{{Vec3(300000, 4500000, 120), 50}, {Vec3(0, 4500000, 0), 1e-3},
                                                   {Vec3(-4500000, 33.3, -7e8), 1},  {Vec3(0.3, 0.1, 1e9), 0.01},
                                                   {Vec3(1e-3, 1e-3, 1e-3), 1e-5},   {Vec3(17, 3.1, 1.4), 0.5},
                                                   {Vec3(1e15, -1e12, 1e9), 1000}};
  for (const auto& [corner, size] : cases) {
    PointCloud cloud = randomCloud(200, corner, corner + Vec3(size, size, size));
    for (std::size_t i = 0; i < 100; ++i) cloud.positions[i].y() += 1e-6 * static_cast<double>(i);
    const PrepareResult result = prepareCloud(cloud);
    const Vec3 origin = result.cloud.frame.origin;
    ASSERT_EQ(result.summary.points, cloud.positions.size() - result.summary.duplicates);
    EXPECT_NE(origin, Vec3(0, 0, 0));
    if (result.summary.duplicates > 0) continue;
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      const Vec3& local = result.cloud.positions[i];
      EXPECT_EQ(origin + local, cloud.positions[i]);
      for (int axis = 0; axis < 3; ++axis) {
        // Exact by a wider type: no rounding hid in the difference.
        EXPECT_EQ(static_cast<long double>(cloud.positions[i][axis]) - static_cast<long double>(origin[axis]),
                  static_cast<long double>(local[axis]));
      }
    }
    EXPECT_LE(result.cloud.boundingBox().center().norm(), 16 * result.cloud.boundingBox().diagonal().norm());
  }
}

TEST(Prepare, AcceptsAFloatCloudFarFromTheOrigin) {
  PointCloud cloud = randomCloud(500, Vec3(4.5e6, 4.5e6, 4.5e6), Vec3(4.5e6 + 100, 4.5e6 + 100, 4.5e6 + 100));
  for (Vec3& position : cloud.positions) position = position.cast<float>().cast<double>();
  const PrepareResult result = prepareCloud(cloud);
  EXPECT_EQ(result.summary.points + result.summary.duplicates, 500U);
  EXPECT_GE(result.summary.points, 490U);
}

TEST(Prepare, RefusesTooFewPoints) {
  PointCloud cloud = randomCloud(50, Vec3(-1, -1, -1), Vec3(1, 1, 1));
  EXPECT_EQ(errorOf(cloud), "");
  cloud.positions[7].x() = kNan;
  EXPECT_EQ(errorOf(cloud),
            "cloud: expected at least 50 usable points, found 49 (50 records, dropped: 1 with NaN or infinite values, "
            "0 with zero normals, 0 duplicates)");
  for (Vec3& normal : cloud.normals) normal.setZero();
  EXPECT_THAT(errorOf(cloud), HasSubstr("found 0 (50 records, dropped: 1 with NaN or infinite values, 49 with zero"));
  for (Vec3& position : cloud.positions) position = Vec3(kNan, 0, 0);
  EXPECT_THAT(errorOf(cloud), HasSubstr("found 0 (50 records, dropped: 50 with NaN"));
  EXPECT_THAT(errorOf(PointCloud()), HasSubstr("found 0 (0 records"));
  for (Vec3& position : cloud.positions) position = Vec3(1, 2, 3);
  for (Vec3& normal : cloud.normals) normal = Vec3(0, 0, 1);
  EXPECT_THAT(errorOf(cloud), HasSubstr("found 1 (50 records, dropped: 0 with NaN or infinite values, 0 with zero "
                                        "normals, 49 duplicates)"));
}

TEST(Prepare, RefusesFlatClouds) {
  const Mat3 rotation = randomRotation(3);
  for (const Vec3& center : {Vec3(0, 0, 0), Vec3(300000, 4500000, 100)}) {
    for (const double scale : {1e-30, 1.0, 1e30}) {
      for (const bool storedAsFloat : {false, true}) {
        if (storedAsFloat && center.norm() > 0) continue;  // floats that far out make steps, not a plane
        PointCloud plane = randomCloud(100, Vec3(-1, -1, 0), Vec3(1, 1, 0));
        PointCloud line = randomCloud(100, Vec3(-1, 0, 0), Vec3(1, 0, 0));
        for (PointCloud* cloud : {&plane, &line}) {
          for (Vec3& position : cloud->positions) {
            position = scale * (rotation * position + center);
            if (storedAsFloat) position = position.cast<float>().cast<double>();
          }
        }
        EXPECT_THAT(errorOf(plane), HasSubstr("expected points around a solid, found all of them in a plane (100"));
        EXPECT_THAT(errorOf(line), HasSubstr("expected points around a solid, found all of them on a line (100"));
      }
    }
  }
  // A sheet with a thickness of a thousandth is none.
  EXPECT_EQ(errorOf(randomCloud(100, Vec3(-1, -1, 0), Vec3(1, 1, 2e-3))), "");
}

TEST(Prepare, RefusesExtentsThatCannotBeSquared) {
  EXPECT_THAT(errorOf(randomCloud(60, Vec3(-1, -1, -1) * 1e200, Vec3(1, 1, 1) * 1e200)),
              HasSubstr("expected an extent between 1e-100 and 1e100"));
  EXPECT_THAT(errorOf(randomCloud(60, Vec3(-1, -1, -1) * 1e-200, Vec3(1, 1, 1) * 1e-200)),
              HasSubstr("expected an extent between 1e-100 and 1e100"));
}

TEST(Prepare, StatesTheSpacing) {
  // On a cubic lattice the six nearest neighbors of an interior point are one edge away; the median is of such a point.
  constexpr int kSide = 14;
  constexpr double kEdge = 0.25;
  PointCloud cloud;
  for (int i = 0; i < kSide; ++i) {
    for (int j = 0; j < kSide; ++j) {
      for (int k = 0; k < kSide; ++k) cloud.positions.emplace_back(i * kEdge, j * kEdge, k * kEdge);
    }
  }
  cloud.normals.assign(cloud.positions.size(), Vec3(1, 0, 0));
  EXPECT_EQ(prepareCloud(cloud).summary.spacing, kEdge);
}

TEST(Prepare, ExplainsItsOptions) {
  PrepareOptions options;
  EXPECT_THAT(validate(options), IsEmpty());
  options.normalNeighbors = 5;
  EXPECT_THAT(validate(options), testing::ElementsAre("normalNeighbors is 5; it must be at least 6"));
  const PointCloud cloud = randomCloud(60, Vec3(-1, -1, -1), Vec3(1, 1, 1));
  EXPECT_THROW(prepare(cloud, "cloud", options, RunContext()), UsageError);
}

}  // namespace
}  // namespace voroform::points
