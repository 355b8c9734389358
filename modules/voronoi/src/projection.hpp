// Finding S along a line.
#pragma once

#include <cstdint>
#include <optional>

#include "voroform/implicit/roots.hpp"

namespace voroform::voronoi {

struct Ray {
  Vec3 origin;
  Vec3 direction;  // unit length, pointing out of the solid
  double outward;  // reach along the direction
  double inward;   // reach against it
};

// The distance along the ray's direction at which it meets S first, going outward if the origin is inside and inward
// if it is outside; nothing if S is not met within reach. `step` is the first step to try; later ones double; one of 0
// finds nothing.
std::optional<double> projectOnSurface(const implicit::ImplicitFunction& f, const Ray& ray, double step,
                                       double tolerance, implicit::RootFinder finder, std::int64_t& evaluations);

}  // namespace voroform::voronoi
