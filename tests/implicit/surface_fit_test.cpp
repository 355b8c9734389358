// The least-squares fit of triangles to a surface against what calculus gives.
#include "voroform/implicit/surface_fit.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <vector>

#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::implicit {
namespace {

using ::testing::Each;
using ::testing::SizeIs;

struct Surface {
  std::vector<Vec3> positions;
  std::vector<Vec3> directions;
  std::vector<std::array<double, 2>> ranges;
  std::vector<std::array<Index, 3>> triangles;

  FitProblem problem() const { return {positions, directions, ranges, triangles}; }
  std::vector<Vec3> moved(const std::vector<double>& shifts) const {
    std::vector<Vec3> result = positions;
    for (std::size_t v = 0; v < result.size(); ++v) result[v] += shifts[v] * directions[v];
    return result;
  }
};

// An octahedron whose faces are halved `levels` times, its vertices on the unit sphere, free along the normals.
Surface sphereOfTriangles(int levels) {
  Surface surface;
  for (int axis = 0; axis < 3; ++axis) {
    surface.positions.push_back(Vec3::Unit(axis));
    surface.positions.push_back(-Vec3::Unit(axis));
  }
  for (const Index x : {0, 1}) {
    for (const Index y : {2, 3}) {
      for (const Index z : {4, 5}) {
        const bool positive = (x + (y - 2) + (z - 4)) % 2 == 0;
        surface.triangles.push_back(positive ? std::array{x, y, z} : std::array{y, x, z});
      }
    }
  }
  for (int level = 0; level < levels; ++level) {
    std::map<std::array<Index, 2>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [found, isNew] = middles.try_emplace({std::min(a, b), std::max(a, b)}, 0);
      if (isNew) {
        found->second = static_cast<Index>(surface.positions.size());
        surface.positions.push_back(
            (surface.positions[static_cast<std::size_t>(a)] + surface.positions[static_cast<std::size_t>(b)])
                .normalized());
      }
      return found->second;
    };
    std::vector<std::array<Index, 3>> finer;
    for (const auto& [a, b, c] : surface.triangles) {
      const Index ab = middle(a, b);
      const Index bc = middle(b, c);
      const Index ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    surface.triangles = std::move(finer);
  }
  surface.directions = surface.positions;
  surface.ranges.assign(surface.positions.size(), {-1.0, 1.0});
  return surface;
}

// √(∫ (r − 1)² / area) over the triangles, by their 4^levels-th parts.
double rmsDistanceToUnitSphere(const std::vector<Vec3>& positions, const std::vector<std::array<Index, 3>>& triangles) {
  constexpr int kParts = 8;
  double squares = 0;
  double area = 0;
  for (const auto& t : triangles) {
    const Vec3& a = positions[static_cast<std::size_t>(t[0])];
    const Vec3 u = positions[static_cast<std::size_t>(t[1])] - a;
    const Vec3 v = positions[static_cast<std::size_t>(t[2])] - a;
    const double own = 0.5 * u.cross(v).norm();
    area += own;
    for (int i = 0; i < kParts; ++i) {
      for (int j = 0; i + j < kParts; ++j) {
        for (const int up : {0, 1}) {  // the parts' centroids
          if (up == 1 && i + j == kParts - 1) continue;
          const double shift = up == 0 ? 1.0 / 3 : 2.0 / 3;
          const double distance = (a + (i + shift) / kParts * u + (j + shift) / kParts * v).norm() - 1;
          squares += own / (kParts * kParts) * distance * distance;
        }
      }
    }
  }
  return std::sqrt(squares / area);
}

FitOptions exactFit() {
  FitOptions options;
  options.damping = 0;
  options.normalWeight = 0;
  options.huberScale = std::numeric_limits<double>::infinity();
  return options;
}

TEST(SurfaceFit, PutsFlatTrianglesOnThePlane) {
  // Half of a large box: near its face z = 1 the surface is a plane.
  const ImplicitPtr f = box(Vec3(20, 20, 2));
  Surface surface;
  for (std::uint64_t i = 0; i < 4; ++i) {
    surface.positions.emplace_back(i % 2 == 0 ? -1 : 1, i < 2 ? -1 : 1,
                                   1 + 0.1 * (randomUnit(3, RandomStream::test, i) - 0.5));
    surface.directions.push_back(Vec3(0.3, 0.1, 1).normalized());
  }
  surface.triangles = {{0, 1, 3}, {0, 3, 2}};
  surface.ranges.assign(4, {-1.0, 1.0});
  FitSummary summary;
  FitOptions options = exactFit();
  options.rounds = 2;
  const auto shifts = fitShifts(surface.problem(), *f, options, {}, summary);
  for (const Vec3& p : surface.moved(shifts)) EXPECT_NEAR(p.z(), 1, 1e-4 * 0.05);
  EXPECT_EQ(summary.unfound, 0);
  EXPECT_EQ(summary.samples, 12);
  EXPECT_EQ(summary.bounded, 0);
}

// For a paraboloid over equilateral triangles interpolation has κR²·√(3/20), the fit κR²·√(3/320) (docs/method.md): a
// quarter. A sphere's triangles are nearly so.
TEST(SurfaceFit, ErrsAQuarterOfInterpolationOnASphere) {
  const Surface surface = sphereOfTriangles(4);
  FitSummary summary;
  const auto shifts = fitShifts(surface.problem(), *sphere(1), exactFit(), {}, summary);
  const double before = rmsDistanceToUnitSphere(surface.positions, surface.triangles);
  const double after = rmsDistanceToUnitSphere(surface.moved(shifts), surface.triangles);
  EXPECT_NEAR(summary.rmsBefore, before, 2e-2 * before);
  EXPECT_GT(after, 0.2 * before);
  EXPECT_LT(after, 0.3 * before);
}

TEST(SurfaceFit, NoOtherShiftOfAVertexIsBetter) {
  const Surface surface = sphereOfTriangles(2);
  FitSummary summary;
  FitOptions options = exactFit();
  options.rounds = 3;
  auto shifts = fitShifts(surface.problem(), *sphere(1), options, {}, summary);
  const double best = rmsDistanceToUnitSphere(surface.moved(shifts), surface.triangles);
  for (const std::size_t v : {0UL, 7UL, 30UL}) {
    for (const double change : {-0.1, 0.1}) {
      auto other = shifts;
      other[v] *= 1 + change;
      EXPECT_GT(rmsDistanceToUnitSphere(surface.moved(other), surface.triangles), best) << v << ' ' << change;
    }
  }
}

TEST(SurfaceFit, IsOfSecondOrderLikeInterpolation) {
  std::vector<double> errors;
  for (const int levels : {2, 3, 4}) {
    const Surface surface = sphereOfTriangles(levels);
    FitSummary summary;
    errors.push_back(rmsDistanceToUnitSphere(
        surface.moved(fitShifts(surface.problem(), *sphere(1), exactFit(), {}, summary)), surface.triangles));
  }
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.15);
  EXPECT_NEAR(std::log2(errors[1] / errors[2]), 2, 0.1);
}

TEST(SurfaceFit, DependsOnNoScaleOfFAndScalesWithTheSurface) {
  Surface surface = sphereOfTriangles(3);
  FitSummary summary;
  const auto shifts = fitShifts(surface.problem(), *sphere(1), {}, {}, summary);
  constexpr double kScale = 1024;
  for (Vec3& p : surface.positions) p *= kScale;
  for (auto& range : surface.ranges) range = {-kScale, kScale};
  const auto scaled = fitShifts(surface.problem(), *sphere(kScale), {}, {}, summary);
  for (std::size_t v = 0; v < shifts.size(); ++v) EXPECT_NEAR(scaled[v], kScale * shifts[v], 1e-9 * kScale);
}

TEST(SurfaceFit, KeepsFixedVerticesAndRanges) {
  Surface surface = sphereOfTriangles(3);
  surface.directions[0] = Vec3::Zero();
  surface.ranges[1] = {0.0, 0.0};
  surface.ranges[2] = {-1.0, 1e-5};
  FitSummary summary;
  const auto shifts = fitShifts(surface.problem(), *sphere(1), {}, {}, summary);
  EXPECT_EQ(shifts[0], 0);
  EXPECT_EQ(shifts[1], 0);
  EXPECT_EQ(shifts[2], 1e-5);
  EXPECT_EQ(summary.bounded, 1);
  EXPECT_GT(shifts[3], 1e-4);  // the others move outward
}

// The upper edge of a box stood on another edge, and triangles that interpolate it: a roof whose ridge lies between two
// columns of vertices.
struct Roof {
  static constexpr int kColumns = 21;
  static constexpr int kRows = 15;
  static constexpr double kRidge = 10.4;  // between columns 10 and 11
  ImplicitPtr box = transformed(implicit::box(Vec3::Constant(80)),
                                Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitY()).toRotationMatrix(),
                                Vec3(kRidge, 0, -40 * std::numbers::sqrt2));
  Surface surface;

  Roof() {
    for (int i = 0; i < kColumns; ++i) {
      for (int j = 0; j < kRows; ++j) {
        surface.positions.emplace_back(i, j - 0.5 * kRows, -std::abs(i - kRidge));
        surface.directions.push_back(Vec3(i < kRidge ? -1 : 1, 0, 1).normalized());
        if (i + 1 == kColumns || j + 1 == kRows) continue;
        const auto at = [](int column, int row) { return static_cast<Index>(column * kRows + row); };
        surface.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
        surface.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      }
    }
    surface.ranges.assign(surface.positions.size(), {-1.0, 1.0});
  }

  // Mean distance to the box by area, at the centroids of 64 parts of each triangle.
  double meanDistance(const std::vector<Vec3>& positions) const {
    constexpr int kParts = 8;
    double sum = 0;
    double area = 0;
    for (const auto& t : surface.triangles) {
      const Vec3& a = positions[static_cast<std::size_t>(t[0])];
      const Vec3 u = positions[static_cast<std::size_t>(t[1])] - a;
      const Vec3 v = positions[static_cast<std::size_t>(t[2])] - a;
      const double part = 0.5 * u.cross(v).norm() / (kParts * kParts);
      for (int i = 0; i < kParts; ++i) {
        for (int j = 0; i + j < kParts; ++j) {
          for (const double offset : {1.0 / 3, 2.0 / 3}) {
            if (offset > 0.5 && i + j == kParts - 1) continue;
            sum += part * std::abs(box->value(a + (i + offset) / kParts * u + (j + offset) / kParts * v));
            area += part;
          }
        }
      }
    }
    return sum / area;
  }
};

TEST(SurfaceFit, CreasesPullFlatsLessThanInLeastSquares) {
  const Roof roof;
  FitSummary summary;
  FitOptions squares;
  squares.huberScale = std::numeric_limits<double>::infinity();
  const auto plain = fitShifts(roof.surface.problem(), *roof.box, squares, {}, summary);
  const auto shifts = fitShifts(roof.surface.problem(), *roof.box, {}, {}, summary);
  EXPECT_LT(roof.meanDistance(roof.surface.moved(shifts)), 0.9 * roof.meanDistance(roof.surface.moved(plain)));
  // The vertices beside the ridge move out, those of the next columns less than in plain least squares.
  for (int row = 3; row < Roof::kRows - 3; ++row) {
    const auto at = [&](int column) { return static_cast<std::size_t>(column * Roof::kRows + row); };
    EXPECT_GT(shifts[at(10)], 1e-3);
    EXPECT_GT(shifts[at(11)], 1e-3);
    for (const int column : {9, 12}) EXPECT_LT(std::abs(shifts[at(column)]), 0.75 * std::abs(plain[at(column)]));
    for (const int column : {3, 18}) EXPECT_NEAR(shifts[at(column)], 0, 1e-3);
  }
}

TEST(SurfaceFit, HoldsVerticesOfTrianglesThatFollowNoSurface) {
  Surface surface = sphereOfTriangles(3);
  std::swap(surface.triangles[5][0], surface.triangles[5][1]);  // S is behind it
  FitSummary summary;
  const auto shifts = fitShifts(surface.problem(), *sphere(1), {}, {}, summary);
  EXPECT_EQ(summary.held, 3);
  std::size_t kept = 0;
  for (std::size_t v = 0; v < shifts.size(); ++v) {
    if (shifts[v] == 0) ++kept;
  }
  EXPECT_EQ(kept, 3U);
  for (const Index v : surface.triangles[5]) EXPECT_EQ(shifts[static_cast<std::size_t>(v)], 0);
}

TEST(SurfaceFit, DampingShrinksShifts) {
  const Surface surface = sphereOfTriangles(3);
  FitSummary summary;
  FitOptions options = exactFit();
  const auto sumOfSquares = [&](double damping) {
    options.damping = damping;
    double sum = 0;
    for (const double s : fitShifts(surface.problem(), *sphere(1), options, {}, summary)) sum += s * s;
    return sum;
  };
  const double free = sumOfSquares(0);
  EXPECT_LT(sumOfSquares(1), 0.5 * free);
  EXPECT_LT(sumOfSquares(1e9), 1e-12 * free);
}

TEST(SurfaceFit, CountsWhatSeesNoSurface) {
  Surface surface = sphereOfTriangles(2);
  for (auto& [a, b, c] : surface.triangles) std::swap(b, c);  // inside out: S is never in front
  FitSummary summary;
  const auto shifts = fitShifts(surface.problem(), *sphere(1), exactFit(), {}, summary);
  EXPECT_EQ(summary.unfound, summary.samples);
  EXPECT_THAT(shifts, Each(0.0));
}

TEST(SurfaceFit, GivesTheSameBitsForAnyNumberOfThreads) {
  const Surface surface = sphereOfTriangles(5);
  FitSummary summary;
  RunContext one;
  one.threads = 1;
  RunContext two;
  two.threads = 2;
  EXPECT_EQ(fitShifts(surface.problem(), *sphere(1), {}, one, summary),
            fitShifts(surface.problem(), *sphere(1), {}, two, summary));
}

TEST(SurfaceFit, RefusesOptionsOutOfRange) {
  FitOptions options;
  options.damping = -1;
  options.normalWeight = std::nan("");
  options.huberScale = 0;
  options.rounds = 0;
  EXPECT_THAT(validate(options), SizeIs(4));
  FitSummary summary;
  EXPECT_THROW(fitShifts({}, *sphere(1), options, {}, summary), UsageError);
  EXPECT_THAT(validate(FitOptions{}), SizeIs(0));
}

}  // namespace
}  // namespace voroform::implicit
