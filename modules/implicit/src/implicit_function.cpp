#include "voroform/implicit/implicit_function.hpp"

#include <stdexcept>

namespace voroform::implicit {

namespace {

void requireSameSize(std::span<const Vec3> points, std::span<double> out) {
  if (points.size() != out.size()) throw std::invalid_argument("values: as many results as points are needed");
}

}  // namespace

void ImplicitFunction::values(std::span<const Vec3> points, std::span<double> out) const {
  requireSameSize(points, out);
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = value(points[i]);
}

void ImplicitFunction::clearances(std::span<const Vec3> points, std::span<double> out) const {
  requireSameSize(points, out);
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = clearance(points[i]);
}

}  // namespace voroform::implicit
