#include "voroform/baselines/cube_grid.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::baselines {
namespace {

using ::testing::HasSubstr;

// The documented accuracy, relative to the longest edge.
constexpr double kBoxAccuracy = 1e-3;

void expectBox(const Box3& found, const Box3& exact) {
  const double tolerance = kBoxAccuracy * exact.sizes().maxCoeff();
  // Every point found is inside, so the box found is never larger.
  EXPECT_TRUE((found.min().array() >= exact.min().array() - 1e-12).all()) << found.min().transpose();
  EXPECT_TRUE((found.max().array() <= exact.max().array() + 1e-12).all()) << found.max().transpose();
  EXPECT_TRUE((found.min().array() <= exact.min().array() + tolerance).all()) << found.min().transpose();
  EXPECT_TRUE((found.max().array() >= exact.max().array() - tolerance).all()) << found.max().transpose();
}

TEST(SolidBox, OfATorusAwayFromTheOrigin) {
  const Vec3 center(3, -2, 1);
  const auto f = implicit::transformed(implicit::torus(1, 0.4), Mat3::Identity(), center);
  expectBox(solidBox(*f, {}), Box3(center - Vec3(1.4, 1.4, 0.4), center + Vec3(1.4, 1.4, 0.4)));
}

TEST(SolidBox, OfBoxesAtAnyAttitude) {
  const Vec3 half(1, 0.6, 0.2);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Mat3 rotation = randomRotation(seed);
    const auto f = implicit::transformed(implicit::box(2 * half), rotation, Vec3::Zero());
    const Vec3 extent = rotation.cwiseAbs() * half;
    expectBox(solidBox(*f, {}), Box3(-extent, extent));
  }
}

// An axis-parallel box inside bounds that say nothing, and no oracle.
class Slab final : public implicit::ImplicitFunction {
 public:
  explicit Slab(double thickness) : thickness_(thickness) {}
  double value(const Vec3& p) const override { return (p.cwiseAbs() - Vec3(0.8, 0.5, 0.5 * thickness_)).maxCoeff(); }
  Vec3 gradient(const Vec3&) const override { return Vec3::UnitZ(); }
  Box3 bounds() const override { return {Vec3::Constant(-1), Vec3::Constant(1)}; }

 private:
  double thickness_;
};

TEST(SolidBox, OfASheetThinnerThanTheFirstSearchSees) {
  expectBox(solidBox(Slab(0.01), {}), Box3(Vec3(-0.8, -0.5, -0.005), Vec3(0.8, 0.5, 0.005)));
}

TEST(SolidBox, IsTheSameForAnyNumberOfThreads) {
  const auto f = implicit::transformed(implicit::bumpySphere(), randomRotation(4), Vec3::Zero());
  RunContext one;
  one.threads = 1;
  const Box3 a = solidBox(*f, one);
  const Box3 b = solidBox(*f, {});
  EXPECT_EQ(a.min(), b.min());
  EXPECT_EQ(a.max(), b.max());
}

TEST(SolidBox, OfNothingIsAnError) {
  try {
    solidBox(Slab(-1), {});
    FAIL() << "expected MethodError";
  } catch (const MethodError& error) {
    EXPECT_THAT(error.what(), HasSubstr("no inside point"));
  }
}

TEST(GridOf, HasTheResolutionAlongTheLongestEdgeAndALayerAround) {
  const Box3 box(Vec3(1, 2, 3), Vec3(3, 12, 6.5));
  const CubeGrid grid = gridOf(box, 20);
  EXPECT_DOUBLE_EQ(grid.edge, 0.5);
  EXPECT_EQ(grid.cubes, (std::array<Index, 3>{6, 22, 9}));
  const Vec3 last = grid.corner(6, 22, 9);
  EXPECT_NEAR((0.5 * (grid.origin + last) - box.center()).norm(), 0, 1e-12);
  EXPECT_TRUE((grid.origin.array() <= box.min().array() - grid.edge + 1e-12).all());
  EXPECT_TRUE((last.array() >= box.max().array() + grid.edge - 1e-12).all());
}

TEST(GridOf, RejectsWhatMakesNoGrid) {
  const Box3 box(Vec3::Zero(), Vec3::Ones());
  EXPECT_THROW(gridOf(box, 1), UsageError);
  EXPECT_THROW(gridOf(Box3(), 10), UsageError);
}

TEST(InsideCubes, CountsTheVolume) {
  // The count of centers is the volume up to the noise of a surface layer: relative error well below edge/radius.
  const auto f = implicit::transformed(implicit::torus(1, 0.4), randomRotation(7), Vec3(0.1, 0.2, 0.3));
  const double volume = 2 * std::numbers::pi * std::numbers::pi * 0.16;
  for (const Index resolution : {25, 50, 100}) {
    const CubeGrid grid = gridOf(solidBox(*f, {}), resolution);
    const double expected = volume / std::pow(grid.edge, 3);
    EXPECT_NEAR(insideCubes(*f, grid, {}) / expected, 1, 0.3 / resolution) << resolution;
  }
}

TEST(InsideCubes, IsExactForABoxOfCubes) {
  const auto f = implicit::box(Vec3(2, 1, 0.5));
  EXPECT_EQ(insideCubes(*f, gridOf(Box3(Vec3(-1, -0.5, -0.25), Vec3(1, 0.5, 0.25)), 16), {}), 16 * 8 * 4);
}

}  // namespace
}  // namespace voroform::baselines
