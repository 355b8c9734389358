// Caps: the triangles that close the loops of a cell's cut.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {

// Caps of all loops. A triangle's points are numbered like the clipped diagram's; the caps' own points follow them.
struct Caps {
  std::vector<Vec3> points;
  std::vector<Index> apexes;                    // of each loop: the point about which its cap is a fan, or kNone
  std::vector<std::uint32_t> triangleOffsets;   // rows: loops → triangles
  std::vector<std::array<Index, 3>> triangles;  // counter-clockwise seen from outside the solid

  // Loops that lie in the plane of one of their cell's facets and whose caps do not leave it: what the cell holds there
  // has no volume. It is given up, and the facet's polygon becomes boundary of the cell on its other side.
  struct Collapsed {
    Index polygon;
    Index site;  // whose cell gives it up
  };
  std::vector<Collapsed> collapsed;

  // Loops around a hole in one of their cell's facets whose caps do not leave its plane. If the cell on the other side
  // has the same patch, the hole is none: the patch becomes a face between the two.
  struct Patch {
    Index site;
    Index neighbor;
    std::vector<Index> loop;  // counter-clockwise seen from the neighbor
  };
  std::vector<Patch> patches;
};

// Adds to the clipped diagram's summary.
Caps buildCaps(const Diagram& diagram, ClippedDiagram& clipped, const implicit::ImplicitFunction& f,
               const ClipOptions& options, const RunContext& context);

// A closed polygon in space as the convex hull's faces over it, by pivoting; empty if it has none: some triangle would
// lie in a facet, or a point of `kept` above a triangle. facetsOf[k] are the two facets (as neighbor sites) of point k.
std::vector<std::array<std::size_t, 3>> hullCap(std::span<const Vec3> loop,
                                                std::span<const std::array<Index, 2>> facetsOf,
                                                std::span<const Vec3> kept);

// Triangles of a simple polygon in the plane with the given normal, seen from which it is counter-clockwise, by cutting
// ears; as indices into the polygon.
std::vector<std::array<std::size_t, 3>> cutEars(std::span<const Vec3> polygon, const Vec3& normal);

// Whether any triangle of `a` meets any of `b` (exact).
bool trianglesMeet(std::span<const std::array<Vec3, 3>> a, std::span<const std::array<Vec3, 3>> b);

}  // namespace voroform::voronoi
