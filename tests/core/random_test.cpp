#include "voroform/core/random.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

namespace voroform {
namespace {

constexpr std::uint64_t kCount = 100'000;
// Figures of random samples may be off by this many standard deviations; the seeds are fixed, so nothing is flaky.
constexpr double kSigmas = 4;

Box3 cube(double half) { return Box3(Vec3::Constant(-half), Vec3::Constant(half)); }

TEST(Random, DependsOnSeedStreamAndIndex) {
  const auto bits = randomBits(1, RandomStream::sites, 2);
  EXPECT_EQ(randomBits(1, RandomStream::sites, 2), bits);
  EXPECT_NE(randomBits(2, RandomStream::sites, 2), bits);
  EXPECT_NE(randomBits(1, RandomStream::ghosts, 2), bits);
  EXPECT_NE(randomBits(1, RandomStream::sites, 3), bits);
}

TEST(Random, DoesNotDependOnTheOrderOfCalls) {
  std::vector<std::uint64_t> forward(100), backward(100);
  for (std::uint64_t i = 0; i < 100; ++i) forward[i] = randomBits(7, RandomStream::test, i);
  for (std::uint64_t i = 100; i-- > 0;) backward[i] = randomBits(7, RandomStream::test, i);
  EXPECT_EQ(forward, backward);
}

TEST(Random, KeysOfSmallNumbersDoNotCollide) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const auto stream : {RandomStream::sites, RandomStream::ghosts, RandomStream::test}) {
      for (std::uint64_t i = 0; i < 500; ++i) seen.insert(randomBits(seed, stream, i));
    }
  }
  EXPECT_EQ(seen.size(), 20U * 3U * 500U);
}

TEST(Random, EveryBitIsFair) {
  std::array<int, 64> ones{};
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const std::uint64_t bits = randomBits(3, RandomStream::test, i);
    for (std::size_t b = 0; b < 64; ++b) ones[b] += static_cast<int>(bits >> b & 1U);
  }
  const double sigma = std::sqrt(static_cast<double>(kCount) / 4);
  for (const int count : ones) EXPECT_NEAR(count, static_cast<double>(kCount) / 2, kSigmas * sigma);
}

TEST(Random, NeighboringIndicesDifferInHalfOfTheBits) {
  double flips = 0;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    flips += std::popcount(randomBits(5, RandomStream::test, i) ^ randomBits(5, RandomStream::test, i + 1));
  }
  const double sigma = std::sqrt(64 / 4.0 / static_cast<double>(kCount));
  EXPECT_NEAR(flips / static_cast<double>(kCount), 32, kSigmas * sigma);
}

TEST(Random, UnitHasTheMomentsOfTheUniformDistribution) {
  double sum = 0, squares = 0, lagged = 0, previous = 0.5;
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const double u = randomUnit(11, RandomStream::test, i);
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
    lagged += (u - 0.5) * (previous - 0.5);
    previous = u;
  }
  const double n = static_cast<double>(kCount);
  EXPECT_NEAR(sum / n, 1.0 / 2, kSigmas * std::sqrt(1 / 12.0 / n));
  EXPECT_NEAR(squares / n, 1.0 / 3, kSigmas * std::sqrt(4 / 45.0 / n));
  EXPECT_NEAR(lagged / n, 0, kSigmas / 12 / std::sqrt(n));
}

TEST(Random, UnitFillsItsBinsEvenly) {
  constexpr std::size_t kBins = 100;
  std::array<double, kBins> counts{};
  for (std::uint64_t i = 0; i < kCount; ++i) {
    ++counts[static_cast<std::size_t>(randomUnit(13, RandomStream::test, i) * kBins)];
  }
  const double expected = static_cast<double>(kCount) / kBins;
  double chiSquare = 0;
  for (const double count : counts) chiSquare += (count - expected) * (count - expected) / expected;
  // Chi-square of 99 degrees of freedom: mean 99, variance 198.
  EXPECT_NEAR(chiSquare, kBins - 1.0, kSigmas * std::sqrt(2 * (kBins - 1.0)));
}

TEST(Random, PointsFillTheirBox) {
  const Box3 box(Vec3(-1, 2, 10), Vec3(1, 3, 14));
  Vec3 mean = Vec3::Zero();
  Mat3 covariance = Mat3::Zero();
  for (std::uint64_t i = 0; i < kCount; ++i) {
    const Vec3 p = randomInBox(17, RandomStream::test, i, box);
    ASSERT_TRUE(box.contains(p));
    const Vec3 unit = (p - box.center()).cwiseQuotient(box.sizes());
    mean += unit / static_cast<double>(kCount);
    covariance += unit * unit.transpose() / static_cast<double>(kCount);
  }
  const double n = static_cast<double>(kCount);
  EXPECT_LE(mean.cwiseAbs().maxCoeff(), kSigmas * std::sqrt(1 / 12.0 / n));
  EXPECT_LE((covariance - Mat3::Identity() / 12).cwiseAbs().maxCoeff(), kSigmas / 12 / std::sqrt(n));
}

// Error of the unit ball's volume from n points of the cube around it.
template <class Point>
double ballVolumeError(std::uint64_t n, const Point& point) {
  std::uint64_t inside = 0;
  for (std::uint64_t i = 0; i < n; ++i) inside += point(i).squaredNorm() < 1 ? 1 : 0;
  const double volume = 8.0 * static_cast<double>(inside) / static_cast<double>(n);
  return std::abs(volume - 4 * std::numbers::pi / 3);
}

TEST(QuasiRandom, IntegratesABallFarBetterThanRandomPoints) {
  for (const std::uint64_t n : {1000U, 10'000U, 100'000U}) {
    double quasi = 0, random = 0;
    constexpr int kSeeds = 16;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      const auto quasiPoint = [&](std::uint64_t i) { return quasiRandomInBox(seed, i, cube(1)); };
      const auto randomPoint = [&](std::uint64_t i) { return randomInBox(seed, RandomStream::test, i, cube(1)); };
      quasi += std::pow(ballVolumeError(n, quasiPoint), 2) / kSeeds;
      random += std::pow(ballVolumeError(n, randomPoint), 2) / kSeeds;
    }
    // A discontinuous integrand in three dimensions: n^(-2/3) is what points of low discrepancy give.
    EXPECT_LE(std::sqrt(quasi), 8 * std::pow(static_cast<double>(n), -2.0 / 3)) << n << " points";
    EXPECT_LE(std::sqrt(quasi), 0.5 * std::sqrt(random)) << n << " points";
  }
}

TEST(QuasiRandom, StaysInItsBoxAndDependsOnTheSeed) {
  const Box3 box(Vec3(5, 6, 7), Vec3(6, 8, 10));
  for (std::uint64_t i = 0; i < 1000; ++i) {
    ASSERT_TRUE(box.contains(quasiRandomInBox(1, i, box)));
    ASSERT_NE(quasiRandomInBox(1, i, box), quasiRandomInBox(2, i, box));
  }
  EXPECT_EQ(quasiRandomInBox(1, 5, box), quasiRandomInBox(1, 5, box));
}

// 64-bit arithmetic keeps far terms of the sequence as well spread as the first.
TEST(QuasiRandom, KeepsItsQualityFarAlongTheSequence) {
  constexpr std::uint64_t kFar = std::uint64_t{1} << 40U;
  const auto point = [](std::uint64_t i) { return quasiRandomInBox(3, kFar + i, cube(1)); };
  EXPECT_LE(ballVolumeError(10'000, point), 8 * std::pow(10'000.0, -2.0 / 3));
}

TEST(RandomRotation, IsOrthonormalAndKeepsOrientation) {
  constexpr double kRounding = 1e-14;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const Mat3 rotation = randomRotation(seed);
    ASSERT_LE((rotation * rotation.transpose() - Mat3::Identity()).cwiseAbs().maxCoeff(), kRounding);
    ASSERT_NEAR(rotation.determinant(), 1, kRounding);
  }
  EXPECT_NE(randomRotation(1), randomRotation(2));
}

TEST(RandomRotation, IsUniform) {
  // Of a uniform rotation every entry has mean 0 and mean square 1/3, and the trace has mean 0 and variance 1.
  constexpr int kRotations = 20'000;
  Mat3 mean = Mat3::Zero(), squares = Mat3::Zero();
  double traces = 0, squaredTraces = 0;
  for (std::uint64_t seed = 0; seed < kRotations; ++seed) {
    const Mat3 rotation = randomRotation(seed);
    mean += rotation / kRotations;
    squares += rotation.cwiseAbs2() / kRotations;
    traces += rotation.trace() / kRotations;
    squaredTraces += rotation.trace() * rotation.trace() / kRotations;
  }
  const double root = std::sqrt(static_cast<double>(kRotations));
  EXPECT_LE(mean.cwiseAbs().maxCoeff(), kSigmas * std::sqrt(1 / 3.0) / root);
  EXPECT_LE((squares.array() - 1 / 3.0).abs().maxCoeff(), kSigmas * std::sqrt(4 / 45.0) / root);
  EXPECT_NEAR(traces, 0, kSigmas / root);
  EXPECT_NEAR(squaredTraces, 1, kSigmas * std::sqrt(2.0) / root);
}

}  // namespace
}  // namespace voroform
