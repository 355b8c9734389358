// The inside oracle against f itself on millions of points, most of them near the surface.
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/clouds.hpp"
#include "support/implicit_laws.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/implicit/poisson.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/implicit/tetrahedral_form.hpp"
#include "voroform/points/read.hpp"

namespace voroform::implicit {
namespace {

struct Verdict {
  std::uint64_t near = 0;
  std::uint64_t nearDecided = 0;
  std::uint64_t spread = 0;
  std::uint64_t spreadDecided = 0;
  std::uint64_t contradictions = 0;
};

Verdict sum(const Verdict& a, const Verdict& b) {
  return {a.near + b.near, a.nearDecided + b.nearDecided, a.spread + b.spread, a.spreadDecided + b.spreadDecided,
          a.contradictions + b.contradictions};
}

// A quarter of the points spread over the bounds, three quarters at 10⁻⁹ to 10⁻¹·⁵ of the bounds from S.
Verdict judge(const ImplicitFunction& f, std::uint64_t count) {
  const Box3 box = f.bounds();
  const double size = box.sizes().maxCoeff();
  const std::vector<Vec3> anchors = test::lawPoints(f, {.seed = 11, .points = 20000});
  const std::size_t firstNear = anchors.size() * 2 / 5;
  return parallelReduce(
      RunContext{}, count, 4096, Verdict{},
      [&](std::size_t begin, std::size_t end, Verdict verdict) {
        for (std::size_t i = begin; i < end; ++i) {
          const bool near = i % 4 != 0;
          Vec3 p = randomInBox(12, RandomStream::test, i, box);
          if (near) {
            const double distance = size * std::pow(10.0, -1.5 - 7.5 * randomUnit(13, RandomStream::test, i));
            p = anchors[firstNear + i % (anchors.size() - firstNear)] + distance * test::detail::randomDirection(14, i);
          }
          const double clearance = f.clearance(p);
          const std::uint64_t decided = clearance != 0 ? 1 : 0;
          (near ? verdict.near : verdict.spread) += 1;
          (near ? verdict.nearDecided : verdict.spreadDecided) += decided;
          if (decided == 1 && (clearance < 0) != (f.value(p) < 0)) ++verdict.contradictions;
        }
        return verdict;
      },
      sum);
}

constexpr std::uint64_t kPoints = 2000000;
constexpr double kDecidedShare = 0.9;

double share(std::uint64_t part, std::uint64_t whole) { return static_cast<double>(part) / static_cast<double>(whole); }

TEST(Oracle, NeverContradictsAPoissonForm) {
  const points::PointCloud cloud = test::torusCloud(20000, 9);
  const Box3 region = test::grownBox(cloud, 0.02);
  const ImplicitPtr form = fitPoisson(cloud, region, {}, {}).form;
  const Verdict verdict = judge(*form, kPoints);
  EXPECT_EQ(verdict.contradictions, 0U);
  EXPECT_GT(verdict.near, kPoints * 7 / 10);
  EXPECT_GE(share(verdict.spreadDecided, verdict.spread), kDecidedShare);
  EXPECT_GT(share(verdict.nearDecided, verdict.near), 0.05);
}

// Seen from one side only the form balloons and leaves through the triangulation's hull, where f jumps.
TEST(Oracle, NeverContradictsTheFormOfAnOpenScan) {
  points::PointCloud cloud = test::torusCloud(12000, 10);
  points::PointCloud open;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    if (cloud.normals[i].dot(Vec3(0.3, 0.2, 1)) < 0) continue;
    open.positions.push_back(cloud.positions[i]);
    open.normals.push_back(cloud.normals[i]);
  }
  const Box3 region = test::grownBox(open, 0.02);
  const auto form = fitPoisson(open, region, {}, {}).form;
  EXPECT_EQ(judge(*form, kPoints).contradictions, 0U);
  const Verdict verdict = judge(*enveloped(form, region), kPoints);
  EXPECT_EQ(verdict.contradictions, 0U);
  EXPECT_GE(share(verdict.spreadDecided, verdict.spread), kDecidedShare);
}

TEST(Oracle, NeverContradictsTheFormOfARoughCloud) {
  points::PointCloud cloud = test::torusCloud(4000, 11);
  const Box3 jitter(Vec3::Constant(-0.03), Vec3::Constant(0.03));
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    cloud.positions[i] += randomInBox(15, RandomStream::test, i, jitter);
    cloud.normals[i] = (cloud.normals[i] + 20 * randomInBox(16, RandomStream::test, i, jitter)).normalized();
  }
  const ImplicitPtr form = fitPoisson(cloud, test::grownBox(cloud, 0.02), {.gridResolution = 64}, {}).form;
  EXPECT_EQ(judge(*form, kPoints).contradictions, 0U);
}

// The kitten from the folder that VOROFORM_SCANS names, or a cloud of as many points.
TEST(Oracle, NeverContradictsTheFormOfAScan) {
  const char* scans = std::getenv("VOROFORM_SCANS");
  const points::PointCloud cloud = scans != nullptr
                                       ? points::readPoints(std::filesystem::path(scans) / "kitten.xyz", {}).cloud
                                       : test::torusCloud(5210, 12, 1, 0.2);
  const Box3 region = test::grownBox(cloud, 0.02);
  const Verdict verdict = judge(*enveloped(fitPoisson(cloud, region, {}, {}).form, region), kPoints);
  EXPECT_EQ(verdict.contradictions, 0U);
  EXPECT_GE(share(verdict.spreadDecided, verdict.spread), kDecidedShare);
}

TEST(Oracle, NeverContradictsAShape) {
  for (const std::string& name : shapeNames()) {
    const Verdict verdict = judge(*transformed(namedShape(name), randomRotation(5), Vec3(3, 1, -2), 0.7), kPoints / 4);
    EXPECT_EQ(verdict.contradictions, 0U) << name;
    EXPECT_GE(share(verdict.spreadDecided, verdict.spread), kDecidedShare) << name;
  }
}

}  // namespace
}  // namespace voroform::implicit
