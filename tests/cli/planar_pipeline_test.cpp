// The stage that tessellates regions of the plane, as a library.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"
#include "voroform/core/error.hpp"
#include "voroform/pipeline/planar.hpp"

namespace voroform::pipeline {
namespace {

using ::testing::HasSubstr;

PlanarOptions few() {
  PlanarOptions options;
  options.sites = 400;
  options.iterations = 60;
  return options;
}

double meanArea(const PlanarResult& result, bool ofBoundary) {
  double sum = 0;
  int count = 0;
  for (std::size_t cell = 0; cell < result.measurement.moments.size(); ++cell) {
    if ((result.measurement.onBoundary[cell] != 0) != ofBoundary) continue;
    sum += result.measurement.moments[cell].area;
    ++count;
  }
  return sum / count;
}

TEST(PlanarInputs, AreKnownByTheirNames) {
  for (const char* name : {"shape2d:disc", "shape2d:", "a.wkt", "b/c.WKT", "points.xy"}) {
    EXPECT_TRUE(isPlanarInput(name)) << name;
  }
  for (const char* name : {"shape:torus", "a.txt", "wkt", "a.xyz", "shape2d", ""}) {
    EXPECT_FALSE(isPlanarInput(name)) << name;
  }
  EXPECT_THROW(planarFromInput("shape:torus", RunContext{}), UsageError);
  EXPECT_THROW(planarFromInput("shape2d:", RunContext{}), UsageError);
  const PlanarInput star = planarFromInput("shape2d:star", RunContext{});
  EXPECT_NEAR(star.region.area(), 117.6, 1e-12);
  EXPECT_EQ(star.record.kind, "region");
  EXPECT_EQ(star.record.name, "star");
}

TEST(PlanarTessellations, SmallCellsAtTheBoundaryByDensity) {
  const PlanarInput disc = planarFromInput("shape2d:disc", RunContext{});
  PlanarOptions options = few();
  const PlanarResult uniform = tessellatePlanar(disc, options, RunContext{});
  options.density.kind = cvt::DensityKind::boundary;
  options.density.ratio = 2;
  const PlanarResult graded = tessellatePlanar(disc, options, RunContext{});
  EXPECT_TRUE(graded.measurement.certificate.valid);
  EXPECT_EQ(graded.tessellation.cellCount(), 400);
  EXPECT_NEAR(meanArea(uniform, true) / meanArea(uniform, false), 1, 0.15);
  EXPECT_LT(meanArea(graded, true), 0.6 * meanArea(graded, false));

  options.density.kind = cvt::DensityKind::curvature;
  EXPECT_THROW(tessellatePlanar(disc, options, RunContext{}), UsageError);
}

TEST(PlanarTessellations, KeepTheSitesGiven) {
  const PlanarInput square = planarFromInput("shape2d:square", RunContext{});
  PlanarOptions options;
  options.initialization = cvt::Initialization::given;
  options.given = {{-5, 0}, {5, 0}, {0, 9}};
  options.iterations = 0;
  const PlanarResult result = tessellatePlanar(square, options, RunContext{});
  EXPECT_EQ(result.tessellation.cellCount(), 3);
  EXPECT_EQ(result.emptySites, 0);
  EXPECT_EQ(result.tessellation.sites, options.given);
  EXPECT_TRUE(result.warnings.empty());
}

TEST(PlanarTessellations, AFailedCertificateIsToldInMetrics) {
  const PlanarInput square = planarFromInput("shape2d:square", RunContext{});
  PlanarResult result = tessellatePlanar(square, few(), RunContext{});
  ASSERT_TRUE(result.measurement.certificate.valid);
  std::swap(result.tessellation.sites[0], result.tessellation.sites[200]);
  result.measurement = measure(result.tessellation, square.region, 0, RunContext{});
  EXPECT_FALSE(result.measurement.certificate.valid);
  const test::TemporaryFolder folder;
  writePlanarResults(square, result, {}, folder / "out", RunContext{});
  const auto metrics = test::readJson(folder / "out" / "metrics.json");
  EXPECT_EQ(metrics["validity"]["valid"], false);
  EXPECT_GT(metrics["validity"]["point_violations"].get<int>(), 0);
  EXPECT_THAT(metrics["validity"]["problems"].dump(), HasSubstr("nearest site"));
}

}  // namespace
}  // namespace voroform::pipeline
