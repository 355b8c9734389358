#include "facet_frame.hpp"

#include <algorithm>
#include <limits>

namespace voroform::voronoi {

namespace {

double cross2(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

bool properlyCross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                   const Eigen::Vector2d& d) {
  const double abc = cross2(b - a, c - a);
  const double abd = cross2(b - a, d - a);
  const double cda = cross2(d - c, a - c);
  const double cdb = cross2(d - c, b - c);
  return (abc > 0) != (abd > 0) && (cda > 0) != (cdb > 0);
}

}  // namespace

FacetFrame facetFrame(const Diagram& diagram, Index facet) {
  const auto& [a, b] = diagram.facetSites[static_cast<std::size_t>(facet)];
  const Vec3 normal =
      (diagram.sites[static_cast<std::size_t>(b)] - diagram.sites[static_cast<std::size_t>(a)]).normalized();
  FacetFrame frame;
  frame.u = normal.unitOrthogonal();
  frame.v = normal.cross(frame.u);
  frame.origin = diagram.vertices[static_cast<std::size_t>(diagram.facet(facet).front())];
  return frame;
}

double reachInFacet(const std::vector<Eigen::Vector2d>& facet, const Eigen::Vector2d& p, const Eigen::Vector2d& d) {
  double reach = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < facet.size(); ++k) {
    const Eigen::Vector2d& a = facet[k];
    const Eigen::Vector2d edge = facet[(k + 1) % facet.size()] - a;
    const double approach = cross2(d, edge);  // > 0 where the ray nears this edge's line from its left
    if (approach > 0) reach = std::min(reach, std::max(0.0, cross2(edge, p - a) / approach));
  }
  return reach;
}

bool simpleAndApart(const std::vector<std::vector<Eigen::Vector2d>>& rings) {
  struct Segment {
    const Eigen::Vector2d* a;
    const Eigen::Vector2d* b;
  };
  std::vector<Segment> segments;
  for (const auto& ring : rings) {
    for (std::size_t k = 0; k < ring.size(); ++k) segments.push_back({&ring[k], &ring[(k + 1) % ring.size()]});
  }
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (std::size_t j = i + 1; j < segments.size(); ++j) {
      const Segment& s = segments[i];
      const Segment& t = segments[j];
      if (s.a == t.b || s.b == t.a) continue;
      if (properlyCross(*s.a, *s.b, *t.a, *t.b)) return false;
    }
  }
  return true;
}

double reachInCell(const Diagram& diagram, Index site, const Vec3& p, const Vec3& d) {
  const Vec3& own = diagram.sites[static_cast<std::size_t>(site)];
  double reach = std::numeric_limits<double>::infinity();
  for (const Index facet : diagram.facetsOf(site)) {
    const auto& [a, b] = diagram.facetSites[static_cast<std::size_t>(facet)];
    const Vec3& other = diagram.sites[static_cast<std::size_t>(a == site ? b : a)];
    const Vec3 across = other - own;
    const double approach = across.dot(d);
    if (approach > 0) reach = std::min(reach, std::max(0.0, across.dot(0.5 * (own + other) - p) / approach));
  }
  return reach;
}

}  // namespace voroform::voronoi
