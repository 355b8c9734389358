#include "thin_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "facet_frame.hpp"
#include "projection.hpp"

namespace voroform::voronoi {

namespace {

// A tongue's rays begin this far off the edge, and it is at least so long, in units of the stretch.
constexpr double kOffEdge = 0.05;
constexpr double kLeastLength = 0.1;
// Directions of a tongue's rays; two more go to its sides.
constexpr int kTongueRays = 7;
// First step along a ray, in units of the stretch or the radius.
constexpr double kFirstStep = 0.1;
// Width of a tongue in its narrowest direction, in units of the stretch: what is thinner cannot be told from a segment.
constexpr double kLeastWidth = 1e-4;
// A tip is searched by rounds of rays in cones about the longest ray so far, each a third as wide as the last.
constexpr int kRounds = 4;
constexpr int kRoundRays = 24;
constexpr double kWidestCone = std::numbers::pi / 3;

double cross(const Vec2& o, const Vec2& a, const Vec2& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

// Andrew's monotone chain: counter-clockwise, without collinear points.
std::vector<Vec2> convexHull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(),
            [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
  std::vector<Vec2> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t base = hull.size();
    for (const Vec2& p : points) {
      while (hull.size() >= base + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();  // the other half begins with it
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

bool isWide(const std::vector<Vec2>& hull, double least) {
  for (std::size_t k = 0; k < hull.size(); ++k) {
    const Vec2& from = hull[k];
    const Vec2& to = hull[(k + 1) % hull.size()];
    double width = 0;
    for (const Vec2& p : hull) width = std::max(width, cross(from, to, p) / (to - from).norm());
    if (!(width > least)) return false;
  }
  return hull.size() >= 3;
}

}  // namespace

std::vector<Vec3> facetTongue(const Diagram& diagram, Index facet, const Vec3& enter, const Vec3& leave,
                              const implicit::ImplicitFunction& f, const ClipOptions& options,
                              std::int64_t& evaluations) {
  const FacetFrame frame = facetFrame(diagram, facet);
  std::vector<Vec2> corners;
  for (const Index v : diagram.facet(facet)) corners.push_back(frame(diagram.vertices[static_cast<std::size_t>(v)]));
  const Vec2 from = frame(enter);
  const Vec2 to = frame(leave);
  const double width = (to - from).norm();
  if (!(width > 0)) return {};
  const Vec2 along = (to - from) / width;
  const Vec2 left(-along.y(), along.x());  // into the facet
  const auto inSpace = [&](const Vec2& p) -> Vec3 { return frame.origin + p.x() * frame.u + p.y() * frame.v; };
  // Where a ray from a point in the solid leaves it.
  const auto cast = [&](const Vec2& origin, const Vec2& direction) -> std::optional<Vec2> {
    Ray ray;
    ray.origin = inSpace(origin);
    ray.direction = direction.x() * frame.u + direction.y() * frame.v;
    ray.outward = (1 - kBorderShare) * reachInFacet(corners, origin, direction);
    ray.inward = 0;
    const std::optional<double> distance =
        projectOnSurface(f, ray, kFirstStep * width, options.rootTolerance * width, options.rootFinder, evaluations);
    if (!distance) return std::nullopt;
    return origin + *distance * direction;
  };

  const Vec2 base = 0.5 * (from + to) + kOffEdge * width * left;
  std::vector<Vec2> points;
  Vec2 tip = base;
  for (int k = 1; k <= kTongueRays; ++k) {
    const double angle = std::numbers::pi * k / (kTongueRays + 1);
    const std::optional<Vec2> point = cast(base, std::cos(angle) * along + std::sin(angle) * left);
    if (!point) continue;
    points.push_back(*point);
    if ((*point - base).norm() > (tip - base).norm()) tip = *point;
  }
  if (!((tip - base).norm() > kLeastLength * width)) return {};
  const Vec2 axis = (tip - base).normalized();
  for (const double side : {-1.0, 1.0}) {
    if (const auto point = cast(0.5 * (base + tip), side * Vec2(-axis.y(), axis.x()))) points.push_back(*point);
  }
  points.push_back(from);
  points.push_back(to);
  std::vector<Vec2> hull = convexHull(std::move(points));
  if (!isWide(hull, kLeastWidth * width)) return {};
  std::rotate(hull.begin(), std::find(hull.begin(), hull.end(), to), hull.end());
  if (hull.front() != to || hull.back() != from) return {};
  std::vector<Vec3> tongue;
  for (std::size_t k = 1; k + 1 < hull.size(); ++k) tongue.push_back(inSpace(hull[k]));
  return tongue;
}

std::optional<Vec3> findTip(const TipSearch& search, const implicit::ImplicitFunction& f, const ClipOptions& options,
                            std::int64_t& evaluations) {
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));  // the golden angle: a spiral of equal areas on the cone
  Vec3 best = search.axis;
  double longest = search.least;
  double cone = kWidestCone;
  for (int round = 0; round < kRounds; ++round, cone /= 3) {
    const Vec3 axis = best;
    const Vec3 u = axis.unitOrthogonal();
    const Vec3 v = axis.cross(u);
    for (int k = 0; k < kRoundRays; ++k) {
      const double along = 1 - (1 - std::cos(cone)) * (k + 0.5) / kRoundRays;
      Ray ray;
      ray.origin = search.origin;
      ray.direction = along * axis + std::sqrt(1 - along * along) * (std::cos(turn * k) * u + std::sin(turn * k) * v);
      ray.outward = (1 - kBorderShare) * search.reach(ray.direction);
      ray.inward = 0;
      const std::optional<double> distance = projectOnSurface(
          f, ray, kFirstStep * search.radius, options.rootTolerance * search.radius, options.rootFinder, evaluations);
      if (!distance || !(*distance > longest)) continue;
      longest = *distance;
      best = ray.direction;
    }
  }
  if (longest == search.least) return std::nullopt;
  return search.origin + longest * best;
}

}  // namespace voroform::voronoi
