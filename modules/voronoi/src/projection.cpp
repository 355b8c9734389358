#include "projection.hpp"

#include <algorithm>

namespace voroform::voronoi {

std::optional<double> projectOnSurface(const implicit::ImplicitFunction& f, const Ray& ray, double step,
                                       double tolerance, implicit::RootFinder finder, std::int64_t& evaluations) {
  double nearValue = f.value(ray.origin);
  ++evaluations;
  const bool inside = nearValue < 0;
  const double reach = inside ? ray.outward : ray.inward;
  const Vec3 direction = inside ? ray.direction : Vec3(-ray.direction);
  double near = 0;
  while (near < reach && step > 0) {
    const double far = std::min(near + step, reach);
    const double farValue = f.value(ray.origin + far * direction);
    ++evaluations;
    if ((farValue < 0) != inside) {
      const double t = implicit::findRoot(f, ray.origin + near * direction, ray.origin + far * direction, nearValue,
                                          farValue, tolerance / (far - near), finder, evaluations);
      const double distance = near + t * (far - near);
      return inside ? distance : -distance;
    }
    near = far;
    nearValue = farValue;
    step *= 2;
  }
  return std::nullopt;
}

}  // namespace voroform::voronoi
