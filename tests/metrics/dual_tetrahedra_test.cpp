// The dual tetrahedralization of CVTs of shapes known exactly.
#include "voroform/metrics/dual_tetrahedra.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "dual_sites.hpp"
#include "support/complexes.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/validate.hpp"
#include "voroform/metrics/shape_quality.hpp"

namespace voroform::metrics {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kMajor = 1;
constexpr double kMinor = 0.4;

mesh::PolyhedralComplex cvtOf(const implicit::ImplicitFunction& f, Index sites) {
  cvt::TessellateOptions options;
  options.sites = sites;
  options.cap = voronoi::CapKind::cvt1;
  return cvt::tessellate(f, Frame{Vec3(1, 2, 3)}, options, RunContext{}).complex;
}

DualResult dualOf(const implicit::ImplicitFunction& f, const mesh::PolyhedralComplex& cvt, int iterations = 20) {
  DualOptions options;
  options.iterations = iterations;
  return dualTetrahedra(cvt, f, options, RunContext{});
}

double sphereDistance(const Vec3& p) { return p.norm() - 1; }
double torusDistance(const Vec3& p) { return std::hypot(std::hypot(p[0], p[1]) - kMajor, p[2]) - kMinor; }

void expectValid(const DualResult& dual, std::int64_t eulerCharacteristic, Index components = 1) {
  const mesh::Certificate certificate = mesh::validate(dual.complex, {}, RunContext{});
  EXPECT_TRUE(certificate.valid) << ::testing::PrintToString(certificate.problems);
  EXPECT_EQ(certificate.eulerCharacteristic, eulerCharacteristic);
  EXPECT_EQ(certificate.components, components);
}

// All vertices of the boundary lie on S, and no others; every site is a vertex.
template <class Distance>
void expectBoundaryOnSurface(const DualResult& dual, std::size_t sites, const Distance& distance) {
  EXPECT_EQ(dual.complex.vertices.size(), sites);
  std::vector<std::uint8_t> onBoundary(dual.complex.vertices.size(), 0);
  for (Index f = 0; f < dual.complex.faceCount(); ++f) {
    if (!dual.complex.isBoundary(f)) continue;
    for (const Index v : dual.complex.face(f)) onBoundary[static_cast<std::size_t>(v)] = 1;
  }
  double farthest = 0;
  double nearestInside = std::numeric_limits<double>::infinity();
  for (std::size_t v = 0; v < onBoundary.size(); ++v) {
    const double d = distance(dual.complex.vertices[v]);
    if (onBoundary[v] != 0) {
      farthest = std::max(farthest, std::abs(d));
    } else {
      nearestInside = std::min(nearestInside, -d);
    }
  }
  EXPECT_LE(farthest, 1e-9);
  EXPECT_GT(nearestInside, 0.01);
  EXPECT_EQ(dual.summary.surfaceSites, std::count(onBoundary.begin(), onBoundary.end(), 1));
  EXPECT_EQ(dual.summary.exposedSites, 0);
  EXPECT_EQ(dual.summary.buriedSites, 0);
  EXPECT_EQ(dual.summary.droppedSites, 0);
  EXPECT_EQ(dual.summary.unprojectedSites, 0);
}

TEST(DualTetrahedra, Sphere) {
  const auto sphere = implicit::sphere(1);
  const mesh::PolyhedralComplex cvt = cvtOf(*sphere, 1000);
  const DualResult dual = dualOf(*sphere, cvt);
  expectValid(dual, 2);
  expectBoundaryOnSurface(dual, 1000, sphereDistance);
  EXPECT_EQ(dual.complex.frame.origin, Vec3(1, 2, 3));
  EXPECT_TRUE(dual.complex.cellSites.empty());
  // The sites of the CVT's boundary cells, and hardly any that come later.
  EXPECT_LE(dual.summary.addedSurfaceSites, dual.summary.surfaceSites / 50);
}

TEST(DualTetrahedra, SitesWhoseCellsReachTheSurfaceAreProjected) {
  const auto sphere = implicit::sphere(1);
  const RunContext context;
  DualSites sites(cvtOf(*sphere, 1000).cellSites, *sphere, 1, context);
  EXPECT_EQ(sites.surfaceCount(), 0);
  // Nothing is on S yet, so that every piece of S is large enough.
  sites.step();
  EXPECT_GT(sites.surfaceCount(), 300);
  for (std::size_t i = 0; i < sites.positions().size(); ++i) {
    const double d = sphereDistance(sites.positions()[i]);
    EXPECT_TRUE(sites.onSurface()[i] != 0 ? std::abs(d) < 1e-9 : d < -0.05) << d;
  }
}

TEST(DualTetrahedra, SitesOfOneProjectionStayApart) {
  // Two sites on one radius: the second one stays where it is.
  const auto sphere = implicit::sphere(1);
  const RunContext context;
  DualSites sites({Vec3(0.5, 0, 0), Vec3(0.75, 0, 0), Vec3(0, 0.5, 0)}, *sphere, 1, context);
  EXPECT_EQ(sites.project({1, 1, 1}), 2);
  EXPECT_NE(sites.positions()[0], sites.positions()[1]);
  EXPECT_NEAR(sites.positions()[0].norm(), 1, 1e-9);
  EXPECT_EQ(sites.positions()[1], Vec3(0.75, 0, 0));
  EXPECT_NEAR(sites.positions()[2].norm(), 1, 1e-9);
}

TEST(DualTetrahedra, Torus) {
  const auto torus = implicit::torus(kMajor, kMinor);
  const mesh::PolyhedralComplex cvt = cvtOf(*torus, 2000);
  const DualResult dual = dualOf(*torus, cvt);
  expectValid(dual, 0);
  expectBoundaryOnSurface(dual, 2000, torusDistance);
}

TEST(DualTetrahedra, ComponentsAndTunnels) {
  const auto tori = implicit::twoTori();
  expectValid(dualOf(*tori, cvtOf(*tori, 2000)), 0, 2);
}

TEST(DualTetrahedra, VolumeErrorFallsWithTheSquareOfTheSpacing) {
  const auto torus = implicit::torus(kMajor, kMinor);
  const double exact = 2 * std::numbers::pi * std::numbers::pi * kMajor * kMinor * kMinor;
  std::vector<double> errors;
  for (const Index sites : {500, 4000}) {
    const mesh::PolyhedralComplex cvt = cvtOf(*torus, sites);
    const DualResult dual = dualOf(*torus, cvt);
    const double volume = mesh::enclosedVolume(mesh::boundarySurface(dual.complex).mesh);
    const double ofCvt = mesh::enclosedVolume(mesh::boundarySurface(cvt).mesh);
    EXPECT_NEAR(dual.summary.volumeError, std::abs(volume - ofCvt) / ofCvt, 1e-12);
    errors.push_back(std::abs(volume - exact) / exact);
  }
  // Half the spacing.
  EXPECT_LT(errors[0], 0.05);
  EXPECT_GT(errors[0] / errors[1], 3);
  EXPECT_LT(errors[0] / errors[1], 6);
}

// Means of VQ1 … VQ4 and SQ1 … SQ4.
struct Means {
  std::array<double, 4> tetrahedra;
  std::array<double, 4> triangles;
};
Means meansOf(const DualResult& dual) {
  return {tetrahedraQuality(dual.complex, RunContext{}).mean, boundaryTriangleQuality(dual.complex).mean};
}

TEST(DualTetrahedra, QualityGrowsWithTheIterations) {
  const auto torus = implicit::torus(kMajor, kMinor);
  const mesh::PolyhedralComplex cvt = cvtOf(*torus, 2000);
  const Means none = meansOf(dualOf(*torus, cvt, 0));
  const Means some = meansOf(dualOf(*torus, cvt, 5));
  const Means all = meansOf(dualOf(*torus, cvt, 20));
  for (std::size_t k = 0; k < 4; ++k) {
    SCOPED_TRACE(k);
    const double sign = k == 1 ? -1 : 1;
    EXPECT_GT(sign * some.tetrahedra[k], sign * none.tetrahedra[k]);
    EXPECT_GT(sign * all.tetrahedra[k], sign * some.tetrahedra[k]);
    EXPECT_GT(sign * some.triangles[k], sign * none.triangles[k]);
    EXPECT_GT(sign * all.triangles[k], sign * some.triangles[k]);
  }
  // What Delaunay refinement reached in the thesis, tables 5.2 and 5.3 (DANCER); without iterations it is missed.
  EXPECT_GT(all.tetrahedra[0], 50.75);
  EXPECT_LT(all.tetrahedra[1], 96.48);
  EXPECT_GT(all.tetrahedra[2], 0.84);
  EXPECT_GT(all.triangles[0], 47.92);
  EXPECT_LT(all.triangles[1], 75.13);
  EXPECT_GT(all.triangles[2], 0.93);
  EXPECT_GT(all.triangles[3], 0.94);
  EXPECT_LT(none.tetrahedra[0], 50.75);
  EXPECT_GT(none.tetrahedra[1], 96.48);
  EXPECT_LT(none.tetrahedra[2], 0.84);
}

TEST(DualTetrahedra, FlatTetrahedraLeaveTheBoundary) {
  const auto torus = implicit::torus(kMajor, kMinor);
  const DualResult dual = dualOf(*torus, cvtOf(*torus, 2000), 0);
  EXPECT_GT(dual.summary.flatTetrahedra, 5);
  EXPECT_EQ(dual.summary.removedTetrahedra, dual.summary.flatTetrahedra);
  expectValid(dual, 0);
}

TEST(DualTetrahedra, UnoptimizedSitesAreRepaired) {
  // Random sites: circumcenters alone leave pinched edges and vertices.
  const auto shape = implicit::gyroidBall();
  cvt::TessellateOptions options;
  options.sites = 1500;
  options.iterations = 0;
  options.cap = voronoi::CapKind::cvt1;
  const mesh::PolyhedralComplex cvt = cvt::tessellate(*shape, {}, options, RunContext{}).complex;
  const DualResult dual = dualOf(*shape, cvt, 0);
  const mesh::Certificate certificate = mesh::validate(dual.complex, {}, RunContext{});
  EXPECT_TRUE(certificate.valid) << ::testing::PrintToString(certificate.problems);
  EXPECT_GT(dual.summary.removedTetrahedra - dual.summary.flatTetrahedra + dual.summary.addedTetrahedra, 0);
}

TEST(DualTetrahedra, EnvelopeFacesAreTagged) {
  const auto torus = implicit::torus(kMajor, kMinor);
  const auto half = implicit::enveloped(torus, Box3(Vec3(-2, -2, -2), Vec3(2, 2, 0.1)));
  const DualResult dual = dualOf(*half, cvtOf(*half, 1500));
  const mesh::Certificate certificate = mesh::validate(dual.complex, {}, RunContext{});
  EXPECT_TRUE(certificate.valid) << ::testing::PrintToString(certificate.problems);
  double area = 0;
  for (Index f = 0; f < dual.complex.faceCount(); ++f) {
    const auto loop = dual.complex.face(f);
    const auto corner = [&](std::size_t k) -> const Vec3& {
      return dual.complex.vertices[static_cast<std::size_t>(loop[k])];
    };
    if (dual.complex.faceTags[static_cast<std::size_t>(f)] != mesh::FaceTag::envelope) continue;
    EXPECT_TRUE(dual.complex.isBoundary(f));
    area += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  }
  // A ring: 4π·R·√(r² − 0.1²).
  const double ring = 4 * std::numbers::pi * kMajor * std::sqrt(kMinor * kMinor - 0.01);
  EXPECT_NEAR(area, ring, 0.15 * ring);
}

TEST(DualTetrahedra, SameBitsForAnyNumberOfThreads) {
  const auto shape = implicit::bumpySphere();
  const mesh::PolyhedralComplex cvt = cvtOf(*shape, 1000);
  RunContext one;
  one.threads = 1;
  const DualResult a = dualTetrahedra(cvt, *shape, {}, one);
  const DualResult b = dualTetrahedra(cvt, *shape, {}, RunContext{});
  EXPECT_EQ(a.complex.vertices, b.complex.vertices);
  EXPECT_EQ(a.complex.faceVertices, b.complex.faceVertices);
  EXPECT_EQ(a.complex.faceCells, b.complex.faceCells);
}

TEST(DualTetrahedra, ScaledSolid) {
  // A power of two: the same mesh but for rounding in the roots.
  const auto torus = implicit::torus(kMajor, kMinor);
  const double scale = std::ldexp(1.0, -20);
  const auto small = implicit::transformed(torus, Mat3::Identity(), Vec3::Zero(), scale);
  mesh::PolyhedralComplex cvt = cvtOf(*torus, 1000);
  const DualResult large = dualOf(*torus, cvt, 3);
  for (Vec3& v : cvt.vertices) v *= scale;
  for (Vec3& v : cvt.cellSites) v *= scale;
  const DualResult scaled = dualOf(*small, cvt, 3);
  EXPECT_EQ(scaled.complex.cellCount, large.complex.cellCount);
  const Means a = meansOf(large);
  const Means b = meansOf(scaled);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_NEAR(a.tetrahedra[k], b.tetrahedra[k], 1e-4);
    EXPECT_NEAR(a.triangles[k], b.triangles[k], 1e-4);
  }
}

TEST(DualTetrahedra, BadInput) {
  const auto sphere = implicit::sphere(1);
  const auto withIterations = [&](const mesh::PolyhedralComplex& cvt, int iterations) {
    return [&, iterations] { dualOf(*sphere, cvt, iterations); };
  };
  mesh::PolyhedralComplex few = testing::block(1);
  few.cellSites = {Vec3(0.1, 0.2, 0.3)};
  EXPECT_THAT(withIterations(few, -1), ThrowsMessage<UsageError>(HasSubstr("iterations is -1")));
  EXPECT_THAT(withIterations(few, 0), ThrowsMessage<MethodError>(HasSubstr("use more sites")));
  EXPECT_THAT(withIterations(testing::block(2), 0), ThrowsMessage<UsageError>(HasSubstr("8 cells and 0 sites")));
  EXPECT_THAT(withIterations(mesh::PolyhedralComplex{}, 0), ThrowsMessage<UsageError>(HasSubstr("0 cells")));
}

}  // namespace
}  // namespace voroform::metrics
