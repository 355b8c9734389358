// Given sites in the worst positions: on lattices, in a plane, on a line, in one octant, twice at one place.
#include <cmath>
#include <functional>

#include <gmock/gmock.h>

#include "voroform/core/error.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/validate.hpp"

namespace voroform::cvt {
namespace {

// Points i·step + offset in the unit ball for which `keep` holds.
std::vector<Vec3> gridSites(double step, const Vec3& offset, const std::function<bool(const Vec3&)>& keep) {
  std::vector<Vec3> sites;
  const int most = static_cast<int>(std::ceil(1 / step)) + 1;
  for (int i = -most; i <= most; ++i) {
    for (int j = -most; j <= most; ++j) {
      for (int k = -most; k <= most; ++k) {
        const Vec3 p = step * Vec3(i, j, k) + offset;
        if (p.squaredNorm() < 0.98 && keep(p)) sites.push_back(p);
      }
    }
  }
  return sites;
}

TessellateOptions keeping(const std::vector<Vec3>& sites) {
  TessellateOptions options;
  options.initialization = Initialization::given;
  options.given = sites;
  options.iterations = 0;
  return options;
}

void expectValid(const std::vector<Vec3>& sites, bool someMoved) {
  const auto ball = implicit::sphere(1);
  for (const voronoi::CapKind cap : {voronoi::CapKind::cvt1, voronoi::CapKind::cvt2, voronoi::CapKind::cvt3}) {
    for (const bool fit : {false, true}) {
      TessellateOptions options = keeping(sites);
      options.cap = cap;
      options.fit = fit;
      const TessellateResult result = tessellate(*ball, {}, options, {});
      ASSERT_GT(result.complex.cellCount, 0);
      EXPECT_EQ(result.summary.movedSites > 0, someMoved);
      const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
      EXPECT_TRUE(certificate.valid) << ::testing::PrintToString(certificate.problems);
    }
  }
}

constexpr auto kAll = [](const Vec3&) { return true; };

TEST(DegenerateSites, OnACubicLattice) { expectValid(gridSites(0.25, Vec3::Zero(), kAll), true); }

TEST(DegenerateSites, OnABodyCenteredLattice) {
  std::vector<Vec3> sites = gridSites(0.3, Vec3::Zero(), kAll);
  const std::vector<Vec3> centers = gridSites(0.3, Vec3::Constant(0.15), kAll);
  sites.insert(sites.end(), centers.begin(), centers.end());
  expectValid(sites, true);
}

TEST(DegenerateSites, InAPlane) {
  expectValid(gridSites(0.12, Vec3::Zero(), [](const Vec3& p) { return p.z() == 0; }), true);
}

TEST(DegenerateSites, InOneOctant) {
  expectValid(gridSites(0.2, Vec3::Constant(0.1), [](const Vec3& p) { return (p.array() > 0).all(); }), true);
}

TEST(DegenerateSites, InGeneralPositionStayWhereTheyAre) {
  TessellateOptions options;
  options.sites = 500;
  const OptimizedSites<3> optimized = optimizeSites(*implicit::sphere(1), options, {});
  const TessellateResult result = tessellate(*implicit::sphere(1), {}, keeping(optimized.sites), {});
  EXPECT_EQ(result.summary.movedSites, 0);
  EXPECT_EQ(result.complex.cellSites, optimized.sites);
}

// Walls between slabs meet S without an edge of the diagram doing so: no cell, but no failure either.
TEST(DegenerateSites, OnALineHaveNoCells) {
  std::vector<Vec3> sites;
  for (int i = -9; i <= 9; ++i) sites.emplace_back(0.1 * i, 0, 0);
  const TessellateResult result = tessellate(*implicit::sphere(1), {}, keeping(sites), {});
  EXPECT_TRUE(result.complex.cellCount == 0 || mesh::validate(result.complex, {}, {}).valid);
  EXPECT_EQ(result.complex.cellCount + result.summary.emptySites, 19);
}

TEST(DegenerateSites, TwiceAtOnePlaceOrOutsideAreRefused) {
  EXPECT_THROW(tessellate(*implicit::sphere(1), {}, keeping({Vec3(0.1, 0, 0), Vec3(0.1, 0, 0)}), {}), MethodError);
  EXPECT_THROW(tessellate(*implicit::sphere(1), {}, keeping({Vec3(0.1, 0, 0), Vec3(1.1, 0, 0)}), {}), MethodError);
  EXPECT_THROW(tessellate(*implicit::sphere(1), {}, keeping({Vec3(0, 0, std::nan(""))}), {}), MethodError);
  EXPECT_THROW(tessellate(*implicit::sphere(1), {}, keeping({}), {}), MethodError);
}

}  // namespace
}  // namespace voroform::cvt
