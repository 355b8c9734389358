// A million points, through every step. Times are printed, not asserted.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <numbers>

#include "support.hpp"
#include "voroform/core/random.hpp"
#include "voroform/points/prepare.hpp"

namespace voroform::points::test {
namespace {

TEST(LargeCloud, OfAMillionPointsIsReadAndPrepared) {
  constexpr std::size_t kPoints = 1'000'000;
  std::string text;
  Bytes ply("ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(kPoints) +
            "\nproperty double x\nproperty double y\nproperty double z\nproperty float nx\nproperty float ny\n"
            "property float nz\nend_header\n");
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double z = 2 * randomUnit(1, RandomStream::test, 2 * i) - 1;
    const double angle = 2 * std::numbers::pi * randomUnit(1, RandomStream::test, 2 * i + 1);
    const double r = std::sqrt(1 - z * z);
    const Vec3 p(r * std::cos(angle), r * std::sin(angle), z);
    char line[100];
    const int length = std::snprintf(line, sizeof line, "%.9g %.9g %.9g\n", p.x(), p.y(), p.z());
    text.append(line, static_cast<std::size_t>(length));
    ply.putAll({p.x(), p.y(), p.z()});
    for (const double component : p) ply.put(static_cast<float>(component));
  }
  Stopwatch watch;
  Outcome ascii = readBytes(text, ".xyz");
  std::cout << "read text: " << watch.seconds() << " s\n";
  watch.restart();
  Outcome binary = readBytes(ply.text(), ".ply");
  std::cout << "read PLY: " << watch.seconds() << " s\n";
  ASSERT_EQ(ascii.error + binary.error, "");
  EXPECT_EQ(ascii.result.summary.records, kPoints);
  EXPECT_EQ(binary.result.summary.records, kPoints);

  watch.restart();
  const PrepareResult oriented = prepare(std::move(binary.result.cloud), "cloud", PrepareOptions(), RunContext());
  std::cout << "prepare with normals: " << watch.seconds() << " s\n";
  EXPECT_EQ(oriented.summary.points, kPoints);
  // Six neighbors in the plane around a random point of density n/4π: the k-th is at Γ(k + ½)/Γ(k)/√(πρ) on average.
  double expected = 0;
  for (int k = 1; k <= 6; ++k) expected += std::exp(std::lgamma(k + 0.5) - std::lgamma(k)) / 6;
  expected *= std::sqrt(4.0 / static_cast<double>(kPoints));
  constexpr double kMedianIsBelowMean = 0.02;
  EXPECT_NEAR(oriented.summary.spacing / expected, 1, kMedianIsBelowMean);

  watch.restart();
  const PrepareResult estimated = prepare(std::move(ascii.result.cloud), "cloud", PrepareOptions(), RunContext());
  std::cout << "prepare without normals: " << watch.seconds() << " s\n";
  EXPECT_TRUE(estimated.summary.normalsEstimated);
  std::size_t outward = 0;
  for (std::size_t i = 0; i < estimated.cloud.positions.size(); ++i) {
    if (estimated.cloud.normals[i].dot(estimated.cloud.positions[i]) > 0) ++outward;
  }
  EXPECT_GE(static_cast<double>(outward), 0.999 * static_cast<double>(kPoints));
}

}  // namespace
}  // namespace voroform::points::test
