// What the clipping of a planar diagram asks of points and sites, decided exactly. Ties are broken as if each point p
// of the region, not the sites, were moved by (ε, ε²) with an infinitely small ε > 0 (Edelsbrunner, Mücke 1990).
#pragma once

#include "voroform/core/types.hpp"

namespace voroform::voronoi {

// Is the region's point p nearer to b than to a?
bool isNearer(const Vec2& p, const Vec2& a, const Vec2& b);

// On the way from p to q, both of the region, is the bisector of (site, a) crossed before that of (site, b)? q must be
// nearer to both a and b than to the site; a and b differ.
bool isCrossedBefore(const Vec2& p, const Vec2& q, const Vec2& site, const Vec2& a, const Vec2& b);

// Where the segment from p to q, nearer to a and nearer to b, crosses the bisector of a and b: to a few ulps of the
// coordinates, however flat the angle.
Vec2 bisectorCrossing(const Vec2& p, const Vec2& q, const Vec2& a, const Vec2& b);

}  // namespace voroform::voronoi
