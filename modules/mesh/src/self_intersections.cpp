#include "self_intersections.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include "voroform/core/parallel.hpp"
#include "voroform/mesh/box_tree.hpp"

namespace voroform::mesh {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;

constexpr std::size_t kGrain = 1024;

Point toPoint(const Vec3& p) { return {p[0], p[1], p[2]}; }

// A triangle's corners, the vertices shared with the other triangle first.
struct Corners {
  std::array<Index, 3> v;
  std::array<Vec3, 3> p;
};

// Is every point of `points` certainly on the same side of the triangle's plane? A filter: the bound is generous
// against the rounding of the determinant (a few ulps of the product of the lengths), and "no" decides nothing.
bool surelyOneSide(const Corners& triangle, std::span<const Vec3> points) {
  constexpr double kRounding = 1e-14;
  const Vec3 e1 = triangle.p[1] - triangle.p[0];
  const Vec3 e2 = triangle.p[2] - triangle.p[0];
  const Vec3 normal = e1.cross(e2);
  const double scale = kRounding * e1.cwiseAbs().sum() * e2.cwiseAbs().sum();
  int sides = 0;
  for (const Vec3& point : points) {
    const Vec3 d = point - triangle.p[0];
    const double determinant = normal.dot(d);
    if (!(std::abs(determinant) > scale * d.cwiseAbs().sum())) return false;
    sides += determinant > 0 ? 1 : -1;
  }
  return std::abs(sides) == static_cast<int>(points.size());
}

bool degenerate(const Corners& triangle) {
  return CGAL::collinear(toPoint(triangle.p[0]), toPoint(triangle.p[1]), toPoint(triangle.p[2]));
}

// Two triangles over the edge (p0, p1) overlap if they lie in one plane, on the same side of the edge.
bool edgeNeighborsOverlap(const Corners& a, const Corners& b) {
  const Point p = toPoint(a.p[0]);
  const Point q = toPoint(a.p[1]);
  const Point r = toPoint(a.p[2]);
  const Point s = toPoint(b.p[2]);
  return CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
}

// Two triangles with the corner p0 in common. Their intersection is convex and holds p0; if it holds another point, the
// farthest one on the ray from p0 through it lies on the side of one triangle opposite to p0, and in the other
// triangle.
bool vertexNeighborsMeet(const Corners& a, const Corners& b) {
  if (surelyOneSide(a, std::span(b.p).subspan(1)) || surelyOneSide(b, std::span(a.p).subspan(1))) return false;
  const Kernel::Triangle_3 first(toPoint(a.p[0]), toPoint(a.p[1]), toPoint(a.p[2]));
  const Kernel::Triangle_3 second(toPoint(b.p[0]), toPoint(b.p[1]), toPoint(b.p[2]));
  return CGAL::do_intersect(first, Kernel::Segment_3(second[1], second[2])) ||
         CGAL::do_intersect(second, Kernel::Segment_3(first[1], first[2]));
}

bool strangersMeet(const Corners& a, const Corners& b) {
  if (surelyOneSide(a, b.p) || surelyOneSide(b, a.p)) return false;
  return CGAL::do_intersect(Kernel::Triangle_3(toPoint(a.p[0]), toPoint(a.p[1]), toPoint(a.p[2])),
                            Kernel::Triangle_3(toPoint(b.p[0]), toPoint(b.p[1]), toPoint(b.p[2])));
}

// Brings shared vertices to the front of both, in the same order; returns their number.
int alignShared(Corners& a, Corners& b) {
  int shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = static_cast<std::size_t>(shared); j < 3; ++j) {
      if (a.v[i] != b.v[j]) continue;
      const auto front = static_cast<std::size_t>(shared);
      std::swap(a.v[i], a.v[front]);
      std::swap(a.p[i], a.p[front]);
      std::swap(b.v[j], b.v[front]);
      std::swap(b.p[j], b.p[front]);
      ++shared;
      break;
    }
  }
  return shared;
}

bool intersect(Corners a, Corners b) {
  switch (alignShared(a, b)) {
    case 0:
      return strangersMeet(a, b);
    case 1:
      return vertexNeighborsMeet(a, b);
    case 2:
      return edgeNeighborsOverlap(a, b);
    default:
      return true;
  }
}

}  // namespace

SelfIntersections selfIntersections(const TriangleMesh& mesh, const RunContext& context) {
  const auto corners = [&](std::size_t t) {
    const auto& v = mesh.triangles[t];
    const auto point = [&](std::size_t i) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(v[i])]; };
    return Corners{v, {point(0), point(1), point(2)}};
  };
  const std::size_t count = mesh.triangles.size();
  std::vector<Box3> boxes(count);
  std::vector<std::uint8_t> flat(count);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const Corners triangle = corners(t);
      for (const Vec3& p : triangle.p) boxes[t].extend(p);
      flat[t] = static_cast<std::uint8_t>(degenerate(triangle));
    }
  });
  const BoxTree tree(boxes);
  return parallelReduce(
      context, count, kGrain, SelfIntersections{},
      [&](std::size_t begin, std::size_t end, SelfIntersections found) {
        for (std::size_t t = begin; t < end; ++t) {
          if (flat[t] != 0) continue;
          const Corners triangle = corners(t);
          Index lowest = kNone;
          tree.forEachOverlap(boxes[t], [&](Index other) {
            const auto o = static_cast<std::size_t>(other);
            if (o <= t || flat[o] != 0 || !intersect(triangle, corners(o))) return;
            ++found.pairs;
            if (lowest == kNone || other < lowest) lowest = other;
          });
          if (lowest != kNone && found.first[0] == kNone) found.first = {static_cast<Index>(t), lowest};
        }
        return found;
      },
      [](const SelfIntersections& left, const SelfIntersections& right) {
        return SelfIntersections{left.pairs + right.pairs, left.first[0] == kNone ? right.first : left.first};
      });
}

}  // namespace voroform::mesh
