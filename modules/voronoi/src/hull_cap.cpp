// cvt1's cap: the faces of the convex hull over a loop (thesis, section 5.2.2.2).
#include <algorithm>
#include <utility>

#include "caps.hpp"

namespace voroform::voronoi {

namespace {

// Six times the signed volume of (a, b, c, p): > 0 where p lies above the triangle, seen from which it is
// counter-clockwise.
double above(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p) { return (b - a).cross(c - a).dot(p - a); }

bool inOneFacet(const std::array<Index, 2>& a, const std::array<Index, 2>& b, const std::array<Index, 2>& c) {
  return std::any_of(a.begin(), a.end(), [&](Index facet) {
    return std::count(b.begin(), b.end(), facet) != 0 && std::count(c.begin(), c.end(), facet) != 0;
  });
}

// A point is above a triangle only beyond rounding: this share of the loop's size cubed.
constexpr double kAboveTolerance = 1e-12;

}  // namespace

std::vector<std::array<std::size_t, 3>> hullCap(std::span<const Vec3> loop,
                                                std::span<const std::array<Index, 2>> facetsOf,
                                                std::span<const Vec3> kept) {
  std::vector<std::array<std::size_t, 3>> triangles;
  // Chains [first, last] of the loop still to be closed by the edge last → first; the first one by the chord
  // (n−1 → 0), which the hull is known to have.
  std::vector<std::pair<std::size_t, std::size_t>> chains = {{0, loop.size() - 1}};
  while (!chains.empty()) {
    const auto [first, last] = chains.back();
    chains.pop_back();
    if (last - first < 2) continue;
    std::size_t apex = loop.size();
    for (std::size_t k = first + 1; k < last; ++k) {
      if (inOneFacet(facetsOf[first], facetsOf[k], facetsOf[last])) continue;
      if (apex == loop.size() || above(loop[first], loop[apex], loop[last], loop[k]) > 0) apex = k;
    }
    if (apex == loop.size()) return {};
    triangles.push_back({first, apex, last});
    chains.emplace_back(first, apex);
    chains.emplace_back(apex, last);
  }

  Box3 box;
  for (const Vec3& p : loop) box.extend(p);
  const double tolerance = kAboveTolerance * std::pow(box.diagonal().norm(), 3);
  for (const auto& [a, b, c] : triangles) {
    for (const auto& points : {loop, kept}) {
      for (const Vec3& p : points) {
        if (above(loop[a], loop[b], loop[c], p) > tolerance) return {};
      }
    }
  }
  return triangles;
}

}  // namespace voroform::voronoi
