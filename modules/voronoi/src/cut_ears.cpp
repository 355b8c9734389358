#include <numeric>

#include "caps.hpp"

namespace voroform::voronoi {

namespace {

double turn(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
  return normal.dot((b - a).cross(c - a));
}

}  // namespace

std::vector<std::array<std::size_t, 3>> cutEars(std::span<const Vec3> polygon, const Vec3& normal) {
  std::vector<std::array<std::size_t, 3>> triangles;
  std::vector<std::size_t> rest(polygon.size());
  std::iota(rest.begin(), rest.end(), std::size_t{0});
  const auto isEar = [&](std::size_t k) {
    const std::size_t n = rest.size();
    const std::size_t a = rest[(k + n - 1) % n];
    const std::size_t b = rest[k];
    const std::size_t c = rest[(k + 1) % n];
    if (!(turn(polygon[a], polygon[b], polygon[c], normal) > 0)) return false;
    for (const std::size_t other : rest) {
      if (other == a || other == b || other == c) continue;
      const Vec3& p = polygon[other];
      if (turn(polygon[a], polygon[b], p, normal) >= 0 && turn(polygon[b], polygon[c], p, normal) >= 0 &&
          turn(polygon[c], polygon[a], p, normal) >= 0) {
        return false;
      }
    }
    return true;
  };
  while (rest.size() > 2) {
    const std::size_t n = rest.size();
    std::size_t ear = 0;
    while (ear < n && !isEar(ear)) ++ear;
    if (ear == n) ear = 0;  // what is left has no area: any cut will do
    triangles.push_back({rest[(ear + n - 1) % n], rest[ear], rest[(ear + 1) % n]});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

}  // namespace voroform::voronoi
