// Parts of the solid thinner than a cell, which reach beyond the last diagram edges that meet them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {

// What the solid keeps of a facet beyond a stretch of one of its edges, where nothing else of its border is inside: the
// points after `leave` and before `enter`, the stretch's ends, of a convex polygon, counter-clockwise in the facet's
// frame. Empty if it does not go on beyond the edge by more than a tenth of the stretch. Adds to `evaluations`.
std::vector<Vec3> facetTongue(const Diagram& diagram, Index facet, const Vec3& enter, const Vec3& leave,
                              const implicit::ImplicitFunction& f, const ClipOptions& options,
                              std::int64_t& evaluations);

// The tip of what is seen from a point of the solid around an axis: where the longest ray leaves the solid. Nothing if
// no ray is longer than `least`.
struct TipSearch {
  Vec3 origin;
  Vec3 axis;      // unit length
  double radius;  // above 0: of what is to be searched, for steps and tolerance
  double least;
  std::function<double(const Vec3& direction)> reach;
};
std::optional<Vec3> findTip(const TipSearch& search, const implicit::ImplicitFunction& f, const ClipOptions& options,
                            std::int64_t& evaluations);

}  // namespace voroform::voronoi
