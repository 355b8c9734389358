// The baselines' boundaries fitted to the surface.
#include "voroform/baselines/fit_boundary.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/surface_distance.hpp"
#include "voroform/baselines/delaunay_refinement.hpp"
#include "voroform/baselines/marching_cubes.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/validate.hpp"

namespace voroform::baselines {
namespace {

double meanDistance(const mesh::PolyhedralComplex& complex, const implicit::ImplicitFunction& f) {
  return testing::surfaceDistances(f, mesh::boundarySurface(complex).mesh, 6, {}).mean;
}

implicit::ImplicitPtr torus() {
  return implicit::transformed(implicit::namedShape("torus"), randomRotation(5), Vec3(0.2, 0.1, 0));
}

TEST(FitBoundary, MovesMarchingCubesVerticesAlongTheirEdges) {
  const implicit::ImplicitPtr f = torus();
  const CubeGrid grid = gridOf(solidBox(*f, {}), 24);
  const mesh::PolyhedralComplex before = marchingCubes(*f, {}, grid, {}, {}).complex;
  mesh::PolyhedralComplex after = before;
  const BoundaryFit fit = fitMarchingCubes(after, grid, *f, {}, {});
  Index moved = 0;
  for (std::size_t v = 0; v < after.vertices.size(); ++v) {
    if (after.vertices[v] == before.vertices[v]) continue;
    ++moved;
    const Vec3 from = (before.vertices[v] - grid.origin) / grid.edge;
    const Vec3 to = (after.vertices[v] - grid.origin) / grid.edge;
    int changed = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(from[axis] - to[axis]) > 1e-12) ++changed;
      EXPECT_EQ(std::floor(from[axis] + 1e-9), std::floor(to[axis] + 1e-9));
    }
    EXPECT_LE(changed, 1);
  }
  EXPECT_EQ(moved, fit.moved);
  EXPECT_GT(moved, 500);
  const mesh::Certificate certificate = mesh::validate(after, {}, {});
  EXPECT_TRUE(certificate.valid);
  EXPECT_EQ(certificate.eulerCharacteristic, 0);
  EXPECT_LT(meanDistance(after, *f), 0.6 * meanDistance(before, *f));
}

TEST(FitBoundary, KeepsTetrahedraTheRightWayOut) {
  const implicit::ImplicitPtr f = torus();
  DelaunayOptions options;
  options.cubeEdge = 0.15;
  options.lloydIterations = 2;
  const DelaunayResult result = delaunayRefinement(*f, {}, options, {});
  ASSERT_EQ(result.summary.status, DelaunayStatus::done);
  mesh::PolyhedralComplex after = result.complex;
  const BoundaryFit fit = fitTetrahedra(after, *f, {}, {});
  EXPECT_GT(fit.moved, 100);
  const mesh::Certificate certificate = mesh::validate(after, {}, {});
  EXPECT_TRUE(certificate.valid);
  EXPECT_EQ(certificate.nonPositiveVolumes, 0);
  EXPECT_LT(meanDistance(after, *f), 0.6 * meanDistance(result.complex, *f));
}

TEST(FitBoundary, LeavesTheEnvelopeWhereItIs) {
  const implicit::ImplicitPtr f = implicit::enveloped(implicit::sphere(1), Box3(Vec3(-2, -2, -2), Vec3(2, 2, 0.13)));
  const CubeGrid grid = gridOf(solidBox(*f, {}), 16);
  const mesh::PolyhedralComplex before = marchingCubes(*f, {}, grid, {}, {}).complex;
  mesh::PolyhedralComplex after = before;
  fitMarchingCubes(after, grid, *f, {}, {});
  std::size_t onEnvelope = 0;
  for (Index face = 0; face < after.faceCount(); ++face) {
    if (after.faceTags[static_cast<std::size_t>(face)] != mesh::FaceTag::envelope) continue;
    for (const Index v : after.face(face)) {
      ++onEnvelope;
      EXPECT_EQ(after.vertices[static_cast<std::size_t>(v)], before.vertices[static_cast<std::size_t>(v)]);
    }
  }
  EXPECT_GT(onEnvelope, 100U);
}

}  // namespace
}  // namespace voroform::baselines
