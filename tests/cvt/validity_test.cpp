// Whatever the shape, the resolution and the caps: the certificate finds nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "voroform/core/random.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/validate.hpp"

namespace voroform::cvt {
namespace {

struct Subject {
  std::string name;
  implicit::ImplicitPtr form;
};

implicit::ImplicitPtr rotated(const implicit::ImplicitPtr& shape, std::uint64_t seed) {
  return implicit::transformed(shape, randomRotation(seed), Vec3::Zero());
}

Subject sheet(double thickness) {
  return {"sheet of " + std::to_string(thickness), rotated(implicit::box(Vec3(2, 2, thickness)), 3)};
}

Subject gap(double width) {
  return {"gap of " + std::to_string(width),
          implicit::differenceOf(implicit::box(Vec3(1, 1, 1)), rotated(implicit::box(Vec3(0.9, 0.9, width)), 5))};
}

// Half of it is thinner than a cell or has corners: what the caps' rules are there for.
std::vector<Subject> subjects() {
  return {sheet(0.005),
          sheet(0.02),
          sheet(0.06),
          gap(0.02),
          gap(0.05),
          {"gyroid-ball", implicit::gyroidBall()},
          {"two-tori", implicit::twoTori()},
          {"box", implicit::box(Vec3(2, 2, 2))},
          {"rotated box", rotated(implicit::box(Vec3(2, 1, 1)), 8)},
          {"bumpy-sphere", implicit::bumpySphere()}};
}

class Validity : public ::testing::TestWithParam<Index> {};

TEST_P(Validity, HoldsForEveryShapeAndCap) {
  std::uint64_t seed = 0;
  Index cells = 0;
  for (const Subject& subject : subjects()) {
    for (const voronoi::CapKind cap : {voronoi::CapKind::cvt1, voronoi::CapKind::cvt2, voronoi::CapKind::cvt3}) {
      TessellateOptions options;
      options.sites = GetParam();
      options.cap = cap;
      options.seed = ++seed;
      options.iterations = static_cast<int>(seed % 3) * 2;
      SCOPED_TRACE(subject.name + ", cvt" + std::to_string(static_cast<int>(cap)) + ", seed " + std::to_string(seed) +
                   ", iterations " + std::to_string(options.iterations));
      const TessellateResult result = tessellate(*subject.form, {}, options, {});
      const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
      EXPECT_THAT(certificate.problems, ::testing::IsEmpty());
      EXPECT_TRUE(certificate.valid);
      EXPECT_EQ(result.summary.clip.crossingCells, 0);
      EXPECT_EQ(result.complex.cellCount + result.summary.emptySites, options.sites);
      cells += result.complex.cellCount;
    }
  }
  // An empty complex would be valid, too.
  EXPECT_GT(cells, static_cast<Index>(0.75 * 30 * GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Sites, Validity, ::testing::Values(30, 200, 1000, 2000));

// Where thin walls meet few sites: in some of these runs caps of one cell would cross each other.
TEST(CrossingCaps, AreSetApart) {
  const Subject walls[] = {
      gap(0.02),
      {"gyroid-ball", implicit::gyroidBall()},
      {"bumpy shell", implicit::differenceOf(implicit::bumpySphere(), implicit::sphere(0.86))},
  };
  Index fallbacks = 0;
  for (const Subject& subject : walls) {
    for (const Index sites : {30, 100}) {
      for (const voronoi::CapKind cap : {voronoi::CapKind::cvt2, voronoi::CapKind::cvt3}) {
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
          TessellateOptions options;
          options.sites = sites;
          options.cap = cap;
          options.seed = seed;
          options.iterations = seed % 2 == 0 ? 0 : 4;
          const TessellateResult result = tessellate(*subject.form, {}, options, {});
          EXPECT_EQ(result.summary.clip.crossingCells, 0) << subject.name << ", seed " << seed;
          EXPECT_THAT(mesh::validate(result.complex, {}, {}).problems, ::testing::IsEmpty())
              << subject.name << ", " << sites << " sites, cvt" << static_cast<int>(cap) << ", seed " << seed;
          fallbacks += result.summary.clip.fallbackCaps;
        }
      }
    }
  }
  EXPECT_GT(fallbacks, 0);
}

}  // namespace
}  // namespace voroform::cvt
