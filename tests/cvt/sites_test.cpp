#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "support/voronoi_sites.hpp"
#include "voroform/core/error.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::cvt {
namespace {

TEST(RandomSites, LieInsideInTheNumberAskedFor) {
  for (const std::string& name : implicit::shapeNames()) {
    const auto form = implicit::namedShape(name);
    for (const Index count : {1, 7, 5000}) {
      const auto sites = randomSites(ImplicitDomain(*form), count, 1, {});
      ASSERT_EQ(sites.size(), static_cast<std::size_t>(count)) << name;
      for (const Vec3& site : sites) EXPECT_LT(form->value(site), 0) << name;
    }
  }
}

TEST(RandomSites, FillABallEvenly) {
  const auto ball = implicit::sphere(1);
  constexpr int kCount = 16000;
  // Eight octants times two shells of equal volume: 16 bins.
  std::array<int, 16> bins{};
  for (const Vec3& site : randomSites(ImplicitDomain(*ball), kCount, 2, {})) {
    const int octant = (site.x() > 0 ? 1 : 0) + (site.y() > 0 ? 2 : 0) + (site.z() > 0 ? 4 : 0);
    ++bins[static_cast<std::size_t>(octant + (site.norm() > std::cbrt(0.5) ? 8 : 0))];
  }
  const double expected = kCount / 16.0;
  double chiSquare = 0;
  for (const int bin : bins) chiSquare += (bin - expected) * (bin - expected) / expected;
  // Fifteen degrees of freedom: 99.9 % of even samples stay below 37.7, and hardly any falls below 2.
  EXPECT_LT(chiSquare, 37.7);
  EXPECT_GT(chiSquare, 2);
}

TEST(RandomSites, DependOnTheSeedAlone) {
  const auto form = implicit::torus(1, 0.4);
  RunContext one;
  one.threads = 1;
  const auto reference = randomSites(ImplicitDomain(*form), 20000, 3, one);
  for (const int threads : {2, 3}) {
    RunContext several;
    several.threads = threads;
    EXPECT_TRUE(testing::sameBits(reference, randomSites(ImplicitDomain(*form), 20000, 3, several)));
  }
  EXPECT_FALSE(testing::sameBits(reference, randomSites(ImplicitDomain(*form), 20000, 4, one)));
}

TEST(RandomSites, TheOracleChangesNone) {
  const auto form = implicit::torus(1, 0.4);
  const testing::WithoutOracle idle(form);
  EXPECT_TRUE(testing::sameBits(randomSites(ImplicitDomain(*form), 3000, 5, {}),
                                randomSites(ImplicitDomain(idle), 3000, 5, {})));
}

TEST(RandomSites, ComeInSpatialOrder) {
  const auto sites = randomSites(ImplicitDomain(*implicit::sphere(1)), 4000, 6, {});
  double path = 0;
  for (std::size_t i = 1; i < sites.size(); ++i) path += (sites[i] - sites[i - 1]).norm();
  // Their spacing is 0.1; two random points of the unit ball lie 36/35 apart on average.
  EXPECT_LT(path / static_cast<double>(sites.size()), 0.2);
}

TEST(RandomSites, RejectAFormWithoutAnInside) {
  // The bounds are those of the first shape; what is left of it is nothing, or next to nothing.
  const auto nothing = implicit::differenceOf(implicit::sphere(1), implicit::sphere(2));
  EXPECT_THROW(randomSites(ImplicitDomain(*nothing), 10, 1, {}), MethodError);
  try {
    randomSites(ImplicitDomain(*nothing), 10, 1, {});
  } catch (const MethodError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("10 sites"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("empty or too thin"));
  }
  const auto shell = implicit::differenceOf(implicit::sphere(1), implicit::sphere(1 - 1e-7));
  EXPECT_THROW(randomSites(ImplicitDomain(*shell), 10, 1, {}), MethodError);
}

}  // namespace
}  // namespace voroform::cvt
