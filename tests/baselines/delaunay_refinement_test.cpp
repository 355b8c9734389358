// Delaunay refinement: what CGAL promises about its meshes, and what happens when it does not come to an end.
#include "voroform/baselines/delaunay_refinement.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <thread>

#include "support/surface_meshes.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/mesh_distance.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/validate.hpp"

namespace voroform::baselines {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kPi = std::numbers::pi;

DelaunayOptions refineOnly(double cubeEdge) {
  DelaunayOptions options;
  options.cubeEdge = cubeEdge;
  options.lloydIterations = 0;
  return options;
}

DelaunayResult meshOf(const implicit::ImplicitPtr& f, const DelaunayOptions& options) {
  DelaunayResult result = delaunayRefinement(*f, Frame{}, options, RunContext{});
  EXPECT_EQ(result.summary.status, DelaunayStatus::done) << result.summary.message;
  return result;
}

mesh::Certificate certificateOf(const mesh::PolyhedralComplex& complex) {
  const mesh::Certificate certificate = mesh::validate(complex, {}, RunContext{});
  EXPECT_THAT(certificate.problems, IsEmpty());
  return certificate;
}

// A sphere whose f does something at its n-th evaluation.
template <class Act>
class ActingSphere final : public implicit::ImplicitFunction {
 public:
  ActingSphere(std::int64_t when, Act act) : when_(when), act_(act) {}
  double value(const Vec3& p) const override {
    if (++asked_ >= when_) act_();
    return p.norm() - 1;
  }
  Vec3 gradient(const Vec3& p) const override { return p.normalized(); }
  Box3 bounds() const override { return {Vec3::Constant(-1.1), Vec3::Constant(1.1)}; }

 private:
  std::int64_t when_;
  Act act_;
  mutable std::atomic<std::int64_t> asked_{0};
};

// More than the search for the first points needs, so that it happens within CGAL.
constexpr std::int64_t kWithinCgal = 60'000;

using Tetrahedron = std::array<Vec3, 4>;

// Cells of a complex of tetrahedra, as their corners.
std::vector<Tetrahedron> tetrahedraOf(const mesh::PolyhedralComplex& complex) {
  const mesh::CellFaces faces = mesh::cellFaces(complex);
  std::vector<Tetrahedron> tetrahedra;
  for (std::size_t cell = 0; cell < static_cast<std::size_t>(complex.cellCount); ++cell) {
    std::vector<Index> corners;
    for (auto k = faces.offsets[cell]; k < faces.offsets[cell + 1]; ++k) {
      const auto loop = complex.face(faces.faces[static_cast<std::size_t>(k)]);
      corners.insert(corners.end(), loop.begin(), loop.end());
    }
    std::sort(corners.begin(), corners.end());
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    EXPECT_EQ(corners.size(), 4U);
    Tetrahedron& tetrahedron = tetrahedra.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) tetrahedron[k] = complex.vertices[static_cast<std::size_t>(corners[k])];
  }
  return tetrahedra;
}

double circumradius(const Tetrahedron& t) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.row(k) = t[static_cast<std::size_t>(k) + 1] - t[0];
  const Vec3 half = 0.5 * edges.rowwise().squaredNorm();
  return edges.partialPivLu().solve(half).norm();
}

double shortestEdge(const Tetrahedron& t) {
  double shortest = (t[0] - t[1]).norm();
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < i; ++j) shortest = std::min(shortest, (t[i] - t[j]).norm());
  }
  return shortest;
}

// Radians. Between the planes through the edge (i, j) and the other two corners, for the smallest such angle.
double smallestDihedralAngle(const Tetrahedron& t) {
  double smallest = kPi;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const std::size_t k = i != 0 && j != 0 ? 0 : (i != 1 && j != 1 ? 1 : 2);
      const std::size_t l = 6 - i - j - k;
      const Vec3 axis = (t[j] - t[i]).normalized();
      const auto across = [&](const Vec3& p) -> Vec3 { return p - t[i] - axis * axis.dot(p - t[i]); };
      const Vec3 a = across(t[k]);
      const Vec3 b = across(t[l]);
      smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
  }
  return smallest;
}

double worstDihedralAngle(const mesh::PolyhedralComplex& complex) {
  double worst = kPi;
  for (const Tetrahedron& t : tetrahedraOf(complex)) worst = std::min(worst, smallestDihedralAngle(t));
  return worst * 180 / kPi;
}

bool sameBits(const mesh::PolyhedralComplex& a, const mesh::PolyhedralComplex& b) {
  return a.vertices == b.vertices && a.faceVertices == b.faceVertices && a.faceCells == b.faceCells;
}

TEST(DelaunayRefinement, Sphere) {
  double lastError = 0;
  for (const double edge : {0.4, 0.2}) {
    const DelaunayResult result = meshOf(implicit::sphere(1), refineOnly(edge));
    const mesh::Certificate certificate = certificateOf(result.complex);
    EXPECT_TRUE(certificate.valid);
    EXPECT_EQ(certificate.components, 1);
    EXPECT_EQ(certificate.eulerCharacteristic, 2);
    // Inscribed: the volume falls short. Were all triangles equilateral and as large as allowed (circumradius r = √3/2
    // of the edge), their mean depth 3/8 r² would take 9/8 r² of it.
    const double error = 1 - certificate.volume / (4 * kPi / 3);
    EXPECT_GT(error, 0);
    EXPECT_LT(error, 27.0 / 32 * edge * edge);
    if (lastError > 0) {
      EXPECT_NEAR(std::log2(lastError / error), 2, 0.4);
    }
    lastError = error;
    for (const Vec3& vertex : mesh::boundarySurface(result.complex).mesh.vertices) {
      ASSERT_NEAR(vertex.norm(), 1, 1e-12);
    }
  }
}

TEST(DelaunayRefinement, NamesNoUnusedVertex) {
  const DelaunayResult result = meshOf(implicit::sphere(1), refineOnly(0.3));
  std::vector<bool> used(result.complex.vertices.size(), false);
  for (const Index vertex : result.complex.faceVertices) used[static_cast<std::size_t>(vertex)] = true;
  EXPECT_EQ(std::count(used.begin(), used.end(), false), 0);
  EXPECT_THAT(result.complex.cellSites, IsEmpty());
}

TEST(DelaunayRefinement, KeepsItsCriteria) {
  const double edge = 0.2;
  const double size = std::sqrt(3.0) / 2 * edge;
  constexpr double kRounding = 1 + 1e-9;
  const DelaunayResult result = meshOf(implicit::torus(1, 0.4), refineOnly(edge));
  double largest = 0;
  double largestRatio = 0;
  for (const Tetrahedron& t : tetrahedraOf(result.complex)) {
    const double radius = circumradius(t);
    largest = std::max(largest, radius);
    largestRatio = std::max(largestRatio, radius / shortestEdge(t));
  }
  EXPECT_LE(largest, size * kRounding);
  EXPECT_GE(largest, 0.8 * size);  // and it does not mesh finer than it is asked to
  EXPECT_LE(largestRatio, 2 * kRounding);
  EXPECT_GE(largestRatio, 1);

  const mesh::TriangleMesh surface = mesh::boundarySurface(result.complex).mesh;
  double smallestAngle = kPi;
  for (const auto& triangle : surface.triangles) {
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = surface.vertices[static_cast<std::size_t>(triangle[k])];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 u = p[(k + 1) % 3] - p[k];
      const Vec3 v = p[(k + 2) % 3] - p[k];
      const double angle = std::atan2(u.cross(v).norm(), u.dot(v));
      smallestAngle = std::min(smallestAngle, angle);
      EXPECT_LE((u - v).norm() / (2 * std::sin(angle)), size * kRounding);
    }
  }
  EXPECT_GE(smallestAngle * 180 / kPi, 30 / kRounding);
}

TEST(DelaunayRefinement, FacetDistanceIsACriterionIfAsked) {
  DelaunayOptions options = refineOnly(0.4);
  const auto coarse = mesh::boundarySurface(meshOf(implicit::sphere(1), options).complex).mesh.triangles.size();
  options.facetDistance = 0.002;
  const auto fine = mesh::boundarySurface(meshOf(implicit::sphere(1), options).complex).mesh.triangles.size();
  EXPECT_GT(fine, 3 * coarse);
}

// Flat facets make tetrahedra without volume, whose duals reach as far as rounding lets them.
TEST(DelaunayRefinement, PutsVerticesOnFlatFacets) {
  const auto mesh = std::make_shared<const mesh::TriangleMesh>(testing::icosphere(3, 1));
  const implicit::ImplicitPtr forms[] = {
      implicit::transformed(implicit::box(Vec3(2, 2, 2)), randomRotation(3), Vec3::Zero()),
      implicit::meshDistance(mesh, {})};
  for (const implicit::ImplicitPtr& f : forms) {
    const DelaunayResult result = meshOf(f, refineOnly(2.0 / 30));
    double worst = 0;
    for (Index face = 0; face < result.complex.faceCount(); ++face) {
      if (!result.complex.isBoundary(face)) continue;
      for (const Index v : result.complex.face(face)) {
        worst = std::max(worst, std::abs(f->value(result.complex.vertices[static_cast<std::size_t>(v)])));
      }
    }
    EXPECT_LT(worst, 1e-9);
    EXPECT_GT(result.complex.cellCount, 1000);
  }
}

TEST(DelaunayRefinement, MeshesEveryPiece) {
  const mesh::Certificate tori = certificateOf(meshOf(implicit::twoTori(), refineOnly(0.08)).complex);
  EXPECT_TRUE(tori.valid);
  EXPECT_EQ(tori.components, 2);
  EXPECT_EQ(tori.eulerCharacteristic, 0);
  EXPECT_NEAR(tori.volume, 2 * (2 * kPi * 0.7 * kPi * 0.04), 0.04);

  // A ball of a few cubes far from another one, and a cavity.
  const auto away = implicit::transformed(implicit::sphere(0.2), Mat3::Identity(), Vec3(3, 1, 2));
  const auto hollow = implicit::differenceOf(implicit::sphere(1), implicit::sphere(0.5));
  const mesh::Certificate pieces = certificateOf(meshOf(implicit::unionOf(hollow, away), refineOnly(0.1)).complex);
  EXPECT_TRUE(pieces.valid);
  EXPECT_EQ(pieces.components, 3);
  EXPECT_EQ(pieces.eulerCharacteristic, 6);
  EXPECT_NEAR(pieces.volume, 4 * kPi / 3 * (1 - 0.125 + 0.008), 0.03);
}

TEST(DelaunayRefinement, RotatedTorusWithLloyd) {
  DelaunayOptions options = refineOnly(0.15);
  options.lloydIterations = 10;
  const auto form = implicit::transformed(implicit::torus(1, 0.4), randomRotation(5), Vec3(10, -20, 30));
  const DelaunayResult result = meshOf(form, options);
  const mesh::Certificate certificate = certificateOf(result.complex);
  EXPECT_TRUE(certificate.valid);
  EXPECT_EQ(certificate.components, 1);
  EXPECT_EQ(certificate.eulerCharacteristic, 0);
  EXPECT_NEAR(certificate.volume, 2 * kPi * kPi * 0.16, 0.03 * 2 * kPi * kPi * 0.16);
  for (const Vec3& vertex : mesh::boundarySurface(result.complex).mesh.vertices) {
    ASSERT_NEAR(form->value(vertex), 0, 1e-12);
  }
  EXPECT_GT(result.summary.secondsRefinement, 0);
  EXPECT_GT(result.summary.secondsOptimization, 0);
  EXPECT_GE(result.summary.seconds, result.summary.secondsRefinement + result.summary.secondsOptimization);
  EXPECT_GT(result.summary.peakMemoryBytes, 1U << 20);
}

TEST(DelaunayRefinement, TakesTheStepsItIsAskedFor) {
  DelaunayOptions options = refineOnly(0.4);
  std::vector<mesh::PolyhedralComplex> meshes;
  for (const int steps : {0, 1, 9, 10}) {
    options.lloydIterations = steps;
    meshes.push_back(meshOf(implicit::sphere(1), options).complex);
  }
  for (std::size_t k = 1; k < meshes.size(); ++k) EXPECT_FALSE(sameBits(meshes[k], meshes[k - 1]));
}

TEST(DelaunayRefinement, OtherOptimizations) {
  DelaunayOptions options = refineOnly(0.3);
  const auto form = implicit::sphere(1);
  const mesh::PolyhedralComplex refined = meshOf(form, options).complex;
  options.odtIterations = 5;
  const mesh::PolyhedralComplex smooth = meshOf(form, options).complex;
  EXPECT_FALSE(sameBits(refined, smooth));
  EXPECT_TRUE(certificateOf(smooth).valid);
  options.odtIterations = 0;
  options.perturb = true;
  const mesh::PolyhedralComplex perturbed = meshOf(form, options).complex;
  EXPECT_TRUE(certificateOf(perturbed).valid);
  EXPECT_GT(worstDihedralAngle(perturbed), worstDihedralAngle(refined) + 1);
  options.perturb = false;
  options.exude = true;
  const mesh::PolyhedralComplex exuded = meshOf(form, options).complex;
  EXPECT_TRUE(certificateOf(exuded).valid);
  EXPECT_GT(worstDihedralAngle(exuded), worstDihedralAngle(refined) + 1);
}

TEST(DelaunayRefinement, SameBitsTwice) {
  DelaunayOptions options = refineOnly(0.2);
  options.lloydIterations = 3;
  options.perturb = options.exude = true;
  const auto form = implicit::torus(1, 0.4);
  RunContext one;
  one.threads = 1;
  const DelaunayResult first = delaunayRefinement(*form, Frame{}, options, one);
  // Other addresses in the second run must not matter.
  const std::vector<std::vector<double>> clutter(1000, std::vector<double>(321));
  const DelaunayResult second = delaunayRefinement(*form, Frame{}, options, RunContext{});
  EXPECT_GT(first.complex.cellCount, 1000);
  EXPECT_TRUE(sameBits(first.complex, second.complex));
  options.seed = 1;
  EXPECT_FALSE(sameBits(first.complex, meshOf(form, options).complex));
}

TEST(DelaunayRefinement, TagsTheEnvelope) {
  const Box3 box(Vec3(-2, -2, -2), Vec3(2, 2, 0.5));
  const auto form = implicit::enveloped(implicit::sphere(1), box);
  const Frame frame{.origin = Vec3(7, 8, 9)};
  const DelaunayResult result = delaunayRefinement(*form, frame, refineOnly(0.1), RunContext{});
  EXPECT_EQ(result.complex.frame.origin, frame.origin);
  double area = 0;
  const mesh::PolyhedralComplex& complex = result.complex;
  for (Index face = 0; face < complex.faceCount(); ++face) {
    if (complex.faceTags[static_cast<std::size_t>(face)] != mesh::FaceTag::envelope) continue;
    ASSERT_TRUE(complex.isBoundary(face));
    const auto loop = complex.face(face);
    const auto corner = [&](std::size_t k) { return complex.vertices[static_cast<std::size_t>(loop[k])]; };
    area += 0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  }
  // The disk that the plane z = 1/2 cuts from the ball; its rim is blunt, for Delaunay refinement knows no sharp edges.
  EXPECT_NEAR(area, kPi * 0.75, 0.15 * kPi * 0.75);
}

TEST(DelaunayRefinement, TimeLimit) {
  DelaunayOptions options = refineOnly(0.005);
  options.timeLimit = 0.3;
  const auto form = implicit::sphere(1);
  const Stopwatch watch;
  const DelaunayResult result = delaunayRefinement(*form, Frame{}, options, RunContext{});
  EXPECT_GE(watch.seconds(), 0.3);
  EXPECT_LT(watch.seconds(), 1.5);
  EXPECT_EQ(result.summary.status, DelaunayStatus::timedOut);
  EXPECT_EQ(result.summary.message, "did not finish in 0.3 s");
  EXPECT_EQ(result.complex.cellCount, 0);
  EXPECT_GT(result.summary.peakMemoryBytes, 0U);

  options.cubeEdge = 0.4;
  options.timeLimit = 60;
  EXPECT_GT(meshOf(form, options).complex.cellCount, 0);
}

TEST(DelaunayRefinement, CanBeCancelled) {
  std::atomic<bool> cancelled{false};
  RunContext context;
  context.cancelled = &cancelled;
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    cancelled = true;
  });
  const auto form = implicit::sphere(1);
  const Stopwatch watch;
  EXPECT_THROW(delaunayRefinement(*form, Frame{}, refineOnly(0.005), context), Cancelled);
  EXPECT_LT(watch.seconds(), 1.5);
  other.join();
}

TEST(DelaunayRefinement, FailuresAreResults) {
  const auto run = [](const implicit::ImplicitFunction& form) {
    const DelaunayResult result = delaunayRefinement(form, Frame{}, refineOnly(0.1), RunContext{});
    EXPECT_EQ(result.summary.status, DelaunayStatus::failed);
    EXPECT_EQ(result.complex.cellCount, 0);
    return result.summary.message;
  };
  EXPECT_EQ(run(ActingSphere(1, [] { throw MethodError("f is out of order"); })), "f is out of order");
  EXPECT_EQ(run(ActingSphere(kWithinCgal, [] { throw std::runtime_error("later"); })), "later");
  EXPECT_EQ(run(ActingSphere(kWithinCgal, [] { throw 7; })), "an exception of unknown type");
  EXPECT_THAT(run(ActingSphere(kWithinCgal, [] { std::abort(); })), HasSubstr("signal 6"));
  EXPECT_THAT(run(ActingSphere(kWithinCgal, [] { std::_Exit(0); })), HasSubstr("cut off"));
  EXPECT_THAT(run(ActingSphere(kWithinCgal, [] { std::_Exit(9); })), HasSubstr("code 9"));
  // Nothing is inside.
  const auto empty = implicit::differenceOf(implicit::sphere(1), implicit::sphere(2));
  EXPECT_THAT(run(*empty), HasSubstr("no surface"));
}

TEST(DelaunayRefinement, RejectsBadOptions) {
  EXPECT_THAT(validate(refineOnly(0.1)), IsEmpty());
  DelaunayOptions options;
  EXPECT_THAT(validate(options), ElementsAre("cubeEdge is 0, but must be positive"));
  EXPECT_THROW(delaunayRefinement(*implicit::sphere(1), Frame{}, options, RunContext{}), UsageError);
  options.cubeEdge = std::nan("");
  options.facetAngle = 31;
  options.radiusEdgeRatio = 1.9;
  options.facetDistance = -1;
  options.lloydIterations = -1;
  options.odtIterations = -2;
  options.timeLimit = HUGE_VAL;
  EXPECT_THAT(
      validate(options),
      ElementsAre("cubeEdge is nan, but must be positive", "facetAngle is 31, but must be from 0 to 30 degrees",
                  "radiusEdgeRatio is 1.9, but must be at least 2", "facetDistance is -1, but must be at least 0",
                  "lloydIterations is -1, but must be at least 0", "odtIterations is -2, but must be at least 0",
                  "timeLimit is inf, but must be at least 0 and finite"));
}

}  // namespace
}  // namespace voroform::baselines
