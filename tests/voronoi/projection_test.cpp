// Where the points of caps are searched: along rays, and over loops that give no direction.
#include "projection.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>

#include "caps.hpp"
#include "support/voronoi_sites.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::voronoi {
namespace {

constexpr double kTolerance = 1e-12;

std::optional<double> distanceOnUnitSphere(const Vec3& origin, const Vec3& direction, double outward, double inward,
                                           double step = 0.1) {
  const auto sphere = implicit::sphere(1);
  std::int64_t evaluations = 0;
  return projectOnSurface(*sphere, {origin, direction, outward, inward}, step, kTolerance, implicit::RootFinder::itp,
                          evaluations);
}

TEST(Projection, GoesOutwardFromInsideAndInwardFromOutside) {
  EXPECT_NEAR(distanceOnUnitSphere({0.3, 0, 0}, Vec3::UnitX(), 2, 0).value(), 0.7, 1e-9);
  EXPECT_NEAR(distanceOnUnitSphere({1.4, 0, 0}, Vec3::UnitX(), 0, 2).value(), -0.4, 1e-9);
}

TEST(Projection, FindsNothingBeyondItsReach) {
  EXPECT_FALSE(distanceOnUnitSphere({0.3, 0, 0}, Vec3::UnitX(), 0.69, 2));
  EXPECT_FALSE(distanceOnUnitSphere({1.4, 0, 0}, Vec3::UnitX(), 2, 0.39));
}

TEST(Projection, FindsNothingWithoutAStep) {
  // The steps of a loop or stretch without extent: doubling leads nowhere.
  EXPECT_FALSE(distanceOnUnitSphere({0.3, 0, 0}, Vec3::UnitX(), 2, 0, 0));
}

TEST(Caps, OverLoopsWithoutAreaAreFansAboutTheirMiddle) {
  // Rounding may leave a loop's points on one line: then there is no normal to search S along, nor an axis for a tip.
  const auto form = implicit::sphere(1);
  const Diagram diagram = buildDiagram(testing::sitesInside(*form, 60, 1), testing::domainOf(*form), {});
  for (const CapKind kind : {CapKind::cvt2, CapKind::cvt3}) {
    const ClipOptions options{.cap = kind};
    ClippedDiagram clipped = clip(diagram, *form, options, {});
    for (Vec3& point : clipped.points) point = Vec3(point.x(), 0, 0);
    const ClipSummary before = clipped.summary;
    const Caps caps = buildCaps(diagram, clipped, *form, options, {});
    const Index firstPoint = diagram.vertexCount() + static_cast<Index>(clipped.points.size());
    Index fans = 0;
    for (Index l = 0; l < clipped.loopCount(); ++l) {
      const Index apex = caps.apexes[static_cast<std::size_t>(l)];
      if (apex == kNone) continue;
      ++fans;
      Vec3 middle = Vec3::Zero();
      for (const Index point : clipped.loop(l)) middle += clipped.position(diagram, point);
      middle /= static_cast<double>(clipped.loop(l).size());
      EXPECT_LT((caps.points[static_cast<std::size_t>(apex - firstPoint)] - middle).norm(), 1e-15);
    }
    EXPECT_GT(fans, 20);
    EXPECT_EQ(clipped.summary.unprojectedPoints - before.unprojectedPoints, fans);
    EXPECT_EQ(clipped.summary.tips, before.tips);
  }
}

}  // namespace
}  // namespace voroform::voronoi
