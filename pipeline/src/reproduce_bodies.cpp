// The bodies of thesis table 3.1 (Conway and Sloane 1982) as cells.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "voroform/core/error.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"
#include "voroform/metrics/regularity.hpp"
#include "voroform/pipeline/reproduce.hpp"

namespace voroform::pipeline {

namespace {

using Points = std::vector<Vec3>;

// All ways to give the coordinates signs, without repetition for zeros.
Points withSigns(const Points& points) {
  Points result;
  for (const Vec3& p : points) {
    for (unsigned signs = 0; signs < 8; ++signs) {
      Vec3 q = p;
      bool repeats = false;
      for (unsigned axis = 0; axis < 3; ++axis) {
        if ((signs >> axis & 1U) == 0) continue;
        q[axis] = -q[axis];
        repeats = repeats || p[axis] == 0;
      }
      if (!repeats) result.push_back(q);
    }
  }
  return result;
}

Points rotations(const Vec3& p) { return {p, {p.y(), p.z(), p.x()}, {p.z(), p.x(), p.y()}}; }

Points join(Points a, const Points& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Points hexagonalPrism() {
  // The height at which the second moments about all axes agree, where G is smallest: h²/12 = 5a²/24.
  const double half = 0.5 * std::sqrt(2.5);
  Points points;
  for (int i = 0; i < 6; ++i) {
    const double angle = i * std::numbers::pi / 3;
    for (const double z : {-half, half}) points.emplace_back(std::cos(angle), std::sin(angle), z);
  }
  return points;
}

Points cornersOf(const std::string& name) {
  constexpr double kGolden = std::numbers::phi;
  if (name == "tetrahedron") return {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  if (name == "cube") return withSigns({{1, 1, 1}});
  if (name == "octahedron") return withSigns(rotations({1, 0, 0}));
  if (name == "hexagonal prism") return hexagonalPrism();
  if (name == "rhombic dodecahedron") return withSigns(join(rotations({2, 0, 0}), {{1, 1, 1}}));
  if (name == "truncated octahedron") return withSigns(join(rotations({0, 1, 2}), rotations({0, 2, 1})));
  if (name == "dodecahedron") return withSigns(join(rotations({0, 1 / kGolden, kGolden}), {{1, 1, 1}}));
  if (name == "icosahedron") return withSigns(rotations({0, 1, kGolden}));
  throw UsageError("unknown body " + name);
}

// The corners of the facet in the plane through `corner` with this outward normal, counter-clockwise seen from outside.
std::vector<Index> facetLoop(const Points& points, const std::set<Index>& corners, const Vec3& normal) {
  Vec3 center = Vec3::Zero();
  for (const Index i : corners) center += points[static_cast<std::size_t>(i)];
  center /= static_cast<double>(corners.size());
  const Vec3 u = normal.unitOrthogonal();
  const Vec3 v = normal.cross(u);
  std::vector<Index> loop(corners.begin(), corners.end());
  const auto angle = [&](Index i) {
    const Vec3 d = points[static_cast<std::size_t>(i)] - center;
    return std::atan2(d.dot(v), d.dot(u));
  };
  std::sort(loop.begin(), loop.end(), [&](Index a, Index b) { return angle(a) < angle(b); });
  return loop;
}

// The convex hull of corners about the origin as one cell, facet by facet, from all planes through three corners that
// have no corner beyond them: for a few dozen corners.
mesh::PolyhedralComplex convexCell(const Points& points) {
  constexpr double kTolerance = 1e-9;  // of bodies of size 1 to 2
  mesh::PolyhedralComplex complex;
  complex.vertices = points;
  complex.cellCount = 1;
  std::set<std::set<Index>> known;
  const std::size_t n = points.size();
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      for (std::size_t c = b + 1; c < n; ++c) {
        Vec3 normal = (points[b] - points[a]).cross(points[c] - points[a]);
        if (normal.norm() < kTolerance) continue;
        normal.normalize();
        if (normal.dot(points[a]) < 0) normal = -normal;
        const double offset = normal.dot(points[a]);
        std::set<Index> corners;
        bool supports = true;
        for (std::size_t i = 0; i < n && supports; ++i) {
          const double beyond = normal.dot(points[i]) - offset;
          supports = beyond < kTolerance;
          if (std::abs(beyond) < kTolerance) corners.insert(static_cast<Index>(i));
        }
        if (supports && known.insert(corners).second) complex.addFace(facetLoop(points, corners, normal), 0, kNone);
      }
    }
  }
  return complex;
}

// Each triangle cut into four, with the new corners on the unit sphere.
mesh::PolyhedralComplex geodesicSphere(int subdivisions) {
  mesh::PolyhedralComplex sphere = convexCell(cornersOf("icosahedron"));
  for (Vec3& p : sphere.vertices) p.normalize();
  for (int step = 0; step < subdivisions; ++step) {
    mesh::PolyhedralComplex finer;
    finer.vertices = sphere.vertices;
    finer.cellCount = 1;
    std::map<std::array<Index, 2>, Index> middles;
    const auto middle = [&](Index a, Index b) {
      const auto [place, added] =
          middles.emplace(std::array{std::min(a, b), std::max(a, b)}, static_cast<Index>(finer.vertices.size()));
      if (added) {
        finer.vertices.push_back(
            (finer.vertices[static_cast<std::size_t>(a)] + finer.vertices[static_cast<std::size_t>(b)]).normalized());
      }
      return place->second;
    };
    for (Index f = 0; f < sphere.faceCount(); ++f) {
      const auto loop = sphere.face(f);
      const std::array<Index, 3> m = {middle(loop[0], loop[1]), middle(loop[1], loop[2]), middle(loop[2], loop[0])};
      finer.addFace(std::array{loop[0], m[0], m[2]}, 0, kNone);
      finer.addFace(std::array{loop[1], m[1], m[0]}, 0, kNone);
      finer.addFace(std::array{loop[2], m[2], m[1]}, 0, kNone);
      finer.addFace(m, 0, kNone);
    }
    sphere = std::move(finer);
  }
  return sphere;
}

}  // namespace

double regularityOfBody(const std::string& name) {
  // G is smallest for the sphere, so its error is of second order in the polyhedron's: below 1e-8 after five steps.
  constexpr int kSubdivisions = 5;
  const mesh::PolyhedralComplex cell = name == "sphere" ? geodesicSphere(kSubdivisions) : convexCell(cornersOf(name));
  return metrics::regularities(mesh::cellMoments(cell, {})).front();
}

}  // namespace voroform::pipeline
