#include "voroform/implicit/poisson.hpp"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/clouds.hpp"
#include "support/implicit_laws.hpp"
#include "voroform/core/error.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/implicit/tetrahedral_form.hpp"

namespace voroform::implicit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kMargin = 0.02;

struct Fit {
  PoissonResult result;
  std::vector<std::string> warnings;
};

Fit fit(const points::PointCloud& cloud, int threads = 0) {
  Fit fitted;
  RunContext context;
  context.threads = threads;
  context.log = [&](LogLevel level, std::string_view message) {
    if (level == LogLevel::warning) fitted.warnings.emplace_back(message);
  };
  fitted.result = fitPoisson(cloud, test::grownBox(cloud, kMargin), {}, context);
  return fitted;
}

std::string failureOf(const points::PointCloud& cloud, const Box3& region) {
  try {
    fitPoisson(cloud, region, {}, {});
  } catch (const MethodError& error) {
    return error.what();
  }
  return "no MethodError";
}

double randomSign(std::uint64_t index, double negativeShare) {
  return randomUnit(4, RandomStream::test, index) < negativeShare ? -1 : 1;
}

// Largest distance of the form's zero set from a shape of known distance, at random places.
double largestDistance(const ImplicitFunction& form, const ImplicitFunction& shape) {
  const std::vector<Vec3> points = test::lawPoints(form, {.seed = 2, .points = 4000});
  double largest = 0;
  for (const Vec3& p : points) {
    // Points within a millionth of S are those that lawPoints() placed there.
    if (std::abs(form.clearance(p)) == 0 && std::abs(form.value(p)) < 1e-6 * form.gradient(p).norm()) {
      largest = std::max(largest, std::abs(shape.value(p)));
    }
  }
  return largest;
}

TEST(Poisson, RecoversASphereWithinAFractionOfTheSpacing) {
  const points::PointCloud cloud = test::sphereCloud(3000);
  const Fit fitted = fit(cloud);
  EXPECT_THAT(fitted.warnings, IsEmpty());
  EXPECT_FALSE(fitted.result.summary.signTurned);
  EXPECT_EQ(fitted.result.summary.wrongNormalShare, 0);
  const double distance = largestDistance(*fitted.result.form, *sphere(1));
  EXPECT_GT(distance, 0);
  EXPECT_LT(distance, 0.25 * test::spacingOf(4 * std::numbers::pi, 3000));
}

// The triangulation of such a cloud alone is its convex hull, on which f has random signs.
TEST(Poisson, KnowsTheInsideOfAnEvenConvexCloud) {
  for (const std::size_t count : {60U, 500U, 1000U, 2000U}) {
    const Fit fitted = fit(test::sphereCloud(count));
    EXPECT_FALSE(fitted.result.summary.signTurned) << count;
    EXPECT_THAT(fitted.warnings, IsEmpty()) << count;
    EXPECT_LT(fitted.result.form->value(Vec3(0.5, 0, 0)), 0) << count;
    EXPECT_GT(fitted.result.form->value(Vec3(1.3, 0, 0)), 0) << count;
    EXPECT_GT(fitted.result.form->gradient(Vec3(1, 0, 0)).x(), 0) << count;
  }
}

TEST(Poisson, RecoversATorusWithinTheSpacing) {
  const points::PointCloud cloud = test::torusCloud(6000, 1);
  const Fit fitted = fit(cloud);
  const double area = 4 * std::numbers::pi * std::numbers::pi * 0.4;
  const double distance = largestDistance(*fitted.result.form, *torus(1, 0.4));
  EXPECT_GT(distance, 0);
  EXPECT_LT(distance, test::spacingOf(area, 6000));  // random points leave holes several spacings wide
  const ImplicitFunction& form = *fitted.result.form;
  EXPECT_LT(form.value(Vec3(1, 0, 0)), 0);
  EXPECT_GT(form.value(Vec3::Zero()), 0);
  EXPECT_GT(form.value(Vec3(100, 0, 0)), 0);
}

TEST(Poisson, ObeysTheLaws) {
  const ImplicitPtr form = fit(test::torusCloud(6000, 2)).result.form;
  // f is linear in tetrahedra: a quotient over a small step is exact unless it crosses one of their faces.
  const test::ImplicitLawOptions options = {.kinkShare = 0.02, .differenceStep = 1e-7, .decidedShare = 0.9};
  EXPECT_THAT(test::violatedLaws(form, options), IsEmpty());
  const Box3 cut(Vec3(-2, -2, -0.2), Vec3(0.3, 2, 2));
  EXPECT_THAT(test::violatedLaws(enveloped(form, cut), options), IsEmpty());
}

TEST(Poisson, GivesTheSameBitsForAnyNumberOfThreads) {
  const points::PointCloud cloud = test::torusCloud(2000, 3);
  const auto one = fit(cloud, 1).result.form;
  const auto four = fit(cloud, 4).result.form;
  ASSERT_EQ(one->mesh().vertices.size(), four->mesh().vertices.size());
  for (std::size_t v = 0; v < one->mesh().vertices.size(); ++v) {
    EXPECT_EQ(one->mesh().vertices[v].position, four->mesh().vertices[v].position);
    EXPECT_EQ(one->mesh().vertices[v].value, four->mesh().vertices[v].value);
  }
  for (const Vec3& p : test::lawPoints(*one, {.points = 2000})) {
    EXPECT_EQ(one->locate(p), four->locate(p));
    EXPECT_EQ(one->value(p), four->value(p));
    EXPECT_EQ(one->clearance(p), four->clearance(p));
  }
}

TEST(Poisson, MarksThePointsOfTheCloud) {
  const points::PointCloud cloud = test::sphereCloud(500);
  const Fit fitted = fit(cloud);
  const TetrahedralMesh& mesh = fitted.result.form->mesh();
  EXPECT_EQ(std::count(mesh.measured.begin(), mesh.measured.end(), 1), 500);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.measured[v] == 0) continue;
    EXPECT_NEAR(mesh.vertices[v].position.norm(), 1, 1e-12);
  }
}

TEST(Poisson, WarnsIfAllNormalsAreFlipped) {
  points::PointCloud cloud = test::torusCloud(3000, 4);
  for (Vec3& n : cloud.normals) n = -n;
  const Fit fitted = fit(cloud);
  EXPECT_TRUE(fitted.result.summary.signTurned);
  EXPECT_EQ(fitted.result.summary.wrongNormalShare, 0);
  EXPECT_THAT(fitted.warnings, ElementsAre(HasSubstr("flipped")));
  EXPECT_LT(fitted.result.form->value(Vec3(1, 0, 0)), 0);
}

TEST(Poisson, WarnsWithTheShareOfWrongNormals) {
  points::PointCloud cloud = test::torusCloud(3000, 5);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    const double sign = randomSign(i, 0.1);
    if (sign < 0) ++wrong;
    cloud.normals[i] *= sign;
  }
  const Fit fitted = fit(cloud);
  const double share = static_cast<double>(wrong) / 3000;
  EXPECT_NEAR(fitted.result.summary.wrongNormalShare, share, 0.005);
  EXPECT_FALSE(fitted.result.summary.signTurned);
  EXPECT_THAT(fitted.warnings, ElementsAre(HasSubstr("contradict")));
}

TEST(Poisson, FailsOnNormalsThatContradictEachOther) {
  points::PointCloud halved = test::torusCloud(3000, 6);
  for (std::size_t i = 0; i < halved.normals.size(); ++i) halved.normals[i] *= randomSign(i, 0.4);
  EXPECT_THAT(failureOf(halved, test::grownBox(halved, kMargin)), HasSubstr("contradict"));

  points::PointCloud random = test::torusCloud(3000, 7);
  for (std::size_t i = 0; i < random.normals.size(); ++i) random.normals[i] = test::detail::randomDirection(3, i);
  EXPECT_THAT(failureOf(random, test::grownBox(random, kMargin)), HasSubstr("leave them out of the file"));
}

TEST(Poisson, FailsIfTheRegionHoldsNoSurface) {
  const points::PointCloud cloud = test::sphereCloud(1000);
  EXPECT_THAT(failureOf(cloud, Box3(Vec3::Constant(2), Vec3::Constant(3))), HasSubstr("no inside"));
  EXPECT_THAT(failureOf(cloud, Box3(Vec3::Constant(-0.1), Vec3::Constant(0.1))), HasSubstr("no outside"));
}

TEST(Poisson, RefusesAnUnfitCloudAndOptions) {
  points::PointCloud cloud = test::sphereCloud(100);
  const Box3 region = test::grownBox(cloud, kMargin);
  EXPECT_THROW(fitPoisson(cloud, region, {.gridResolution = 15}, {}), UsageError);
  EXPECT_THROW(fitPoisson(cloud, region, {.gridResolution = 513}, {}), UsageError);
  EXPECT_THAT(validate(PoissonOptions{}), IsEmpty());
  cloud.normals.clear();
  EXPECT_THROW(fitPoisson(cloud, region, {}, {}), InputError);
}

TEST(Poisson, CanBeCancelled) {
  const std::atomic<bool> cancelled = true;
  RunContext context;
  context.cancelled = &cancelled;
  const points::PointCloud cloud = test::sphereCloud(100);
  EXPECT_THROW(fitPoisson(cloud, test::grownBox(cloud, kMargin), {}, context), Cancelled);
}

// Where a form lies far from the origin its coordinates carry fewer digits; the oracle must still be right.
TEST(Poisson, ObeysTheLawsFarFromTheOrigin) {
  points::PointCloud cloud = test::torusCloud(3000, 8);
  for (Vec3& p : cloud.positions) p += Vec3(4096, -8192, 2048);
  const ImplicitPtr form = fit(cloud).result.form;
  // Coordinates have 12 digits after the point there.
  const test::ImplicitLawOptions options = {
      .kinkShare = 0.05, .differenceStep = 1e-5, .gradientTolerance = 1e-3, .decidedShare = 0.9};
  EXPECT_THAT(test::violatedLaws(form, options), IsEmpty());
}

}  // namespace
}  // namespace voroform::implicit
