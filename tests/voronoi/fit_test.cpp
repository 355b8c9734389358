// Fitted caps: where their vertices may go, what stays, and what they gain.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "support/surface_distance.hpp"
#include "support/voronoi_sites.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/validate.hpp"
#include "voroform/metrics/accuracy.hpp"
#include "voroform/metrics/particles.hpp"
#include "voroform/metrics/regularity.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {
namespace {

using ::testing::IsEmpty;

constexpr CapKind kCaps[] = {CapKind::cvt1, CapKind::cvt2, CapKind::cvt3};
constexpr double kOnLine = 1e-10;

ClipOptions options(CapKind cap, bool fit) {
  ClipOptions result;
  result.cap = cap;
  result.fit = fit;
  return result;
}

implicit::ImplicitPtr torus() {
  return implicit::transformed(implicit::namedShape("torus"), randomRotation(4), Vec3(0.3, 0.1, -0.2));
}

std::vector<Vec3> torusSites() {
  static const std::vector<Vec3> sites = testing::relaxed(testing::sitesInside(*torus(), 1000, 1), *torus(), 8);
  return sites;
}

double meanDistance(const testing::Tessellation& tessellation, const implicit::ImplicitFunction& f) {
  return testing::surfaceDistances(f, mesh::boundarySurface(tessellation.complex).mesh, 6, {}).mean;
}

double volume(const testing::Tessellation& tessellation) {
  return mesh::enclosedVolume(mesh::boundarySurface(tessellation.complex).mesh);
}

TEST(Fit, MovesRootsAlongTheirEdgesAndChordPointsInTheirFacets) {
  const auto before = testing::tessellateSites(torusSites(), *torus(), options(CapKind::cvt3, false));
  const auto after = testing::tessellateSites(torusSites(), *torus(), options(CapKind::cvt3, true));
  const ClippedDiagram& clipped = after.clipped;
  ASSERT_EQ(clipped.points.size(), before.clipped.points.size());
  Index moved = 0;
  for (std::size_t r = 0; r < static_cast<std::size_t>(clipped.rootCount); ++r) {
    const Vec3& a = after.diagram.vertices[static_cast<std::size_t>(clipped.rootEnds[r][0])];
    const Vec3& b = after.diagram.vertices[static_cast<std::size_t>(clipped.rootEnds[r][1])];
    const Vec3 along = (b - a).normalized();
    const Vec3 offset = clipped.points[r] - a;
    EXPECT_LT((offset - along.dot(offset) * along).norm(), kOnLine);
    EXPECT_GT(along.dot(offset), 0);
    EXPECT_LT(along.dot(offset), (b - a).norm());
    if (clipped.points[r] != before.clipped.points[r]) ++moved;
  }
  EXPECT_GT(moved, clipped.rootCount * 9 / 10);
  for (std::size_t c = 0; c < clipped.chordPointFacets.size(); ++c) {
    const auto& [a, b] = after.diagram.facetSites[static_cast<std::size_t>(clipped.chordPointFacets[c])];
    const Vec3& p = clipped.points[static_cast<std::size_t>(clipped.rootCount) + c];
    const Vec3& siteA = after.diagram.sites[static_cast<std::size_t>(a)];
    const Vec3& siteB = after.diagram.sites[static_cast<std::size_t>(b)];
    EXPECT_NEAR((p - siteA).norm(), (p - siteB).norm(), kOnLine);
  }
}

TEST(Fit, HalvesTheDistanceAndKeepsTheTessellationValid) {
  for (const CapKind cap : kCaps) {
    const auto before = testing::tessellateSites(torusSites(), *torus(), options(cap, false));
    const auto after = testing::tessellateSites(torusSites(), *torus(), options(cap, true));
    const mesh::Certificate certificate = mesh::validate(after.complex, {}, {});
    EXPECT_TRUE(certificate.valid);
    EXPECT_THAT(certificate.problems, IsEmpty());
    EXPECT_EQ(certificate.eulerCharacteristic, 0);
    EXPECT_EQ(after.complex.cellCount, before.complex.cellCount);
    EXPECT_EQ(mesh::boundarySurface(after.complex).mesh.triangles.size(),
              mesh::boundarySurface(before.complex).mesh.triangles.size());
    EXPECT_LT(meanDistance(after, *torus()), 0.6 * meanDistance(before, *torus()));
    const double exact = 2 * std::numbers::pi * std::numbers::pi * 0.16;
    EXPECT_LT(std::abs(volume(after) - exact), 0.2 * std::abs(volume(before) - exact));
    EXPECT_GT(after.clipped.summary.fittedPoints, 0);
    EXPECT_LT(after.clipped.summary.unfittedPoints, after.clipped.summary.fittedPoints / 100);
  }
}

TEST(Fit, StaysValidWhereSitesAreRandomAndPartsThin) {
  for (const std::string name : {"gyroid-ball", "two-tori", "box", "bumpy-sphere"}) {
    const implicit::ImplicitPtr f = implicit::transformed(implicit::namedShape(name), randomRotation(9), Vec3::Zero());
    for (const CapKind cap : kCaps) {
      const auto result = testing::tessellateSites(testing::sitesInside(*f, 700, 3), *f, options(cap, true));
      const mesh::Certificate certificate = mesh::validate(result.complex, {}, {});
      EXPECT_TRUE(certificate.valid) << name << static_cast<int>(cap);
      EXPECT_THAT(certificate.problems, IsEmpty());
    }
  }
}

TEST(Fit, LeavesTheEnvelopeWhereItIs) {
  const Box3 half(Vec3(-2, -2, -2), Vec3(2, 2, 0.1));
  const implicit::ImplicitPtr f = implicit::enveloped(implicit::sphere(1), half);
  const auto sites = testing::sitesInside(*f, 600, 2);
  const auto before = testing::tessellateSites(sites, *f, options(CapKind::cvt3, false));
  const auto after = testing::tessellateSites(sites, *f, options(CapKind::cvt3, true));
  EXPECT_EQ(before.complex.faceTags, after.complex.faceTags);
  std::vector<bool> onEnvelope(after.complex.vertices.size(), false);
  for (Index face = 0; face < after.complex.faceCount(); ++face) {
    if (after.complex.faceTags[static_cast<std::size_t>(face)] != mesh::FaceTag::envelope) continue;
    for (const Index v : after.complex.face(face)) onEnvelope[static_cast<std::size_t>(v)] = true;
  }
  std::size_t kept = 0;
  std::size_t moved = 0;
  for (std::size_t v = 0; v < onEnvelope.size(); ++v) {
    if (onEnvelope[v]) {
      EXPECT_EQ(after.complex.vertices[v], before.complex.vertices[v]);
      ++kept;
    } else if (after.complex.vertices[v] != before.complex.vertices[v]) {
      ++moved;
    }
  }
  EXPECT_GT(kept, 100);
  EXPECT_GT(moved, 100);
  EXPECT_TRUE(mesh::validate(after.complex, {}, {}).valid);
}

// Interpolating caps are exact on flat facets: what the fit gains along the edges may not be lost there.
TEST(Fit, GainsOnFlatFacetsWithSharpEdges) {
  const implicit::ImplicitPtr f = implicit::transformed(implicit::namedShape("box"), randomRotation(5), Vec3::Zero());
  const auto sites = testing::relaxed(testing::sitesInside(*f, 2000, 1), *f, 8);
  const auto before = testing::tessellateSites(sites, *f, options(CapKind::cvt3, false));
  const auto after = testing::tessellateSites(sites, *f, options(CapKind::cvt3, true));
  EXPECT_TRUE(mesh::validate(after.complex, {}, {}).valid);
  metrics::AccuracyOptions accuracy;
  accuracy.cellSize = std::cbrt(volume(before) / before.complex.cellCount);
  metrics::ParticleOptions particles;
  particles.spacing = accuracy.cellSize / 3;
  const metrics::SurfaceSamples samples = metrics::particleSamples(*f, particles, {});
  const auto interpolated = metrics::accuracy(before.complex, *f, samples, accuracy, {});
  const auto fitted = metrics::accuracy(after.complex, *f, samples, accuracy, {});
  EXPECT_LT(fitted.dmean, 0.98 * interpolated.dmean);
  EXPECT_LT(fitted.drmse, 0.9 * interpolated.drmse);
}

TEST(Fit, HardlyChangesTheRegularity) {
  const auto mean = [](bool fit) {
    const auto result = testing::tessellateSites(torusSites(), *torus(), options(CapKind::cvt3, fit));
    const auto moments = mesh::cellMoments(result.complex, {});
    return metrics::regularity(result.complex, metrics::regularities(moments)).all.mean;
  };
  EXPECT_NEAR(mean(true), mean(false), 0.005 * mean(false));
}

TEST(Fit, GivesTheSameBitsForAnyNumberOfThreads) {
  RunContext one;
  one.threads = 1;
  RunContext two;
  two.threads = 2;
  for (const CapKind cap : kCaps) {
    const auto a = testing::tessellateSites(torusSites(), *torus(), options(cap, true), one);
    const auto b = testing::tessellateSites(torusSites(), *torus(), options(cap, true), two);
    EXPECT_THAT(testing::differences(a.complex, b.complex), IsEmpty());
  }
}

}  // namespace
}  // namespace voroform::voronoi
