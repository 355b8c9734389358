// The plane of a facet, and what must hold of the polygons in it.
#pragma once

#include <vector>

#include "voroform/voronoi/diagram.hpp"

namespace voroform::voronoi {

// A facet's plane as a 2D frame; the loop of its diagram vertices is counter-clockwise in it.
struct FacetFrame {
  Vec3 origin;
  Vec3 u;
  Vec3 v;
  Eigen::Vector2d operator()(const Vec3& p) const { return {u.dot(p - origin), v.dot(p - origin)}; }
};
FacetFrame facetFrame(const Diagram& diagram, Index facet);

// Points put inside a facet or a cell keep this share of the way to its border clear. A fan over a loop on the border
// of a convex cell, about a point strictly inside it, cannot cross itself.
inline constexpr double kBorderShare = 1e-3;

// How far a ray from p in direction d stays within the convex facet, given by its corners counter-clockwise.
double reachInFacet(const std::vector<Eigen::Vector2d>& facet, const Eigen::Vector2d& p, const Eigen::Vector2d& d);

// Whether no two edges of the polygons, given as one list of closed rings, cross; edges that share an end do not.
bool simpleAndApart(const std::vector<std::vector<Eigen::Vector2d>>& rings);

// How far a ray from p in direction d stays within the site's convex cell.
double reachInCell(const Diagram& diagram, Index site, const Vec3& p, const Vec3& d);

}  // namespace voroform::voronoi
