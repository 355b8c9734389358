#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "caps.hpp"

namespace voroform::voronoi {

bool trianglesMeet(std::span<const std::array<Vec3, 3>> a, std::span<const std::array<Vec3, 3>> b) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  const auto toKernel = [](const std::array<Vec3, 3>& triangle) {
    const auto point = [](const Vec3& p) { return Kernel::Point_3(p.x(), p.y(), p.z()); };
    return Kernel::Triangle_3(point(triangle[0]), point(triangle[1]), point(triangle[2]));
  };
  for (const auto& s : a) {
    const Kernel::Triangle_3 first = toKernel(s);
    for (const auto& t : b) {
      const Kernel::Triangle_3 second = toKernel(t);
      // A triangle without area holds nothing that its neighbors do not.
      if (first.is_degenerate() || second.is_degenerate()) continue;
      if (CGAL::do_intersect(first, second)) return true;
    }
  }
  return false;
}

}  // namespace voroform::voronoi
