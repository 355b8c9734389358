// Regions of the plane, bounded by polygons.
#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "voroform/core/error.hpp"
#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"

namespace voroform::mesh {

// What is wrong with rings of points that shall bound a region, and where: ring and point from 0.
struct RingFault {
  std::string message;
  std::size_t ring = 0;
  std::size_t point = 0;
};
// Says the place first, counted from 1: "ring 2, point 5: …".
struct InvalidRegion : InputError {
  explicit InvalidRegion(RingFault what);
  RingFault fault;
};

// The first fault of the rings, if any: no ring, fewer than 3 points, a coordinate that is not finite, a point equal to
// its successor, edges that cross, touch or overlap (of one ring or of two). Decided exactly; O(n log n) for n edges
// that overlap little in their boxes.
std::optional<RingFault> findFault(std::span<const std::vector<Vec2>> rings);

// The interior of disjoint rings by the even-odd rule: a ring within an even number of others is an outer one, within
// an odd number a hole's. The interior lies on the left of each edge: outer rings run counter-clockwise, holes
// clockwise, whatever their direction was when given. Safe to ask from many threads at once.
class PlanarRegion {
 public:
  // Throws InvalidRegion with the first fault, or if double precision does not hold the area.
  explicit PlanarRegion(std::span<const std::vector<Vec2>> rings);

  // The points of all rings; edge k runs from point k to point next(k) of the same ring.
  std::span<const Vec2> points() const { return points_; }
  std::size_t ringCount() const { return ringOffsets_.size() - 1; }
  // Ring r's points are points()[ringOffsets()[r] … ringOffsets()[r + 1]).
  std::span<const std::uint32_t> ringOffsets() const { return ringOffsets_; }
  std::span<const Vec2> ring(std::size_t r) const {
    return points().subspan(ringOffsets_[r], ringOffsets_[r + 1] - ringOffsets_[r]);
  }
  bool isHole(std::size_t r) const { return depths_[r] % 2 != 0; }
  std::size_t holeCount() const;
  Index next(std::size_t point) const { return next_[point]; }

  double area() const { return area_; }
  const Box2& bounds() const { return bounds_; }

  // Whether the point lies in the open region; exact, points of the boundary are outside.
  bool contains(const Vec2& point) const;
  // Distance to the boundary, negative inside.
  double signedDistance(const Vec2& point) const;

 private:
  class EdgeTree;

  std::vector<Vec2> points_;
  std::vector<std::uint32_t> ringOffsets_ = {0};
  std::vector<Index> depths_;  // how many other rings hold the ring
  std::vector<Index> next_;
  std::shared_ptr<const EdgeTree> edges_;
  double area_ = 0;
  Box2 bounds_;
};

// Centered at the origin. Edge 20, axis-parallel: area 400.
PlanarRegion squareRegion();
// A regular pentagram's outline, one branch upwards, of area 117.6. With outer radius R and inner radius
// r = R·sin 18°/sin 54° its area is 5·R·r·sin 36°, so R = √(117.6·sin 54°/(5·sin 18°·sin 36°)) ≈ 10.235.
PlanarRegion starRegion();
// A regular polygon of 720 corners with the area π of the unit disc; its radius exceeds 1 by 6e-6.
PlanarRegion discRegion();

// The named regions of the command line: square, star, disc. Throws UsageError, listing the names, for an unknown one.
PlanarRegion namedRegion(std::string_view name);

// Reads .wkt (one POLYGON or MULTIPOLYGON of well-known text, also over several lines) or .xy and .txt (two numbers a
// line, blanks or a comma between them; a blank line begins the next ring; # begins a comment; a ring may repeat its
// first point at its end). WKT must name as holes what lies in an odd number of rings. Throws InputError naming the
// file and the line; allocates nothing that the file does not hold.
PlanarRegion readPlanarRegion(const std::filesystem::path& path, const RunContext& context);

// The same from a stream; `format` is the lower-case extension with its dot, `name` stands in messages.
PlanarRegion readPlanarRegion(std::istream& stream, const std::string& format, const std::string& name,
                              const RunContext& context);

}  // namespace voroform::mesh
