#include "voroform/mesh/surface_locator.hpp"

#include <limits>

#include "ray_crossing.hpp"

namespace voroform::mesh {

namespace {

// Relative to the coordinates' size; some thousand times the rounding of a double.
constexpr double kRelativeTolerance = 1e-12;

std::vector<Box3> triangleBoxes(const TriangleMesh& mesh) {
  std::vector<Box3> boxes;
  boxes.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    Box3 box;
    for (const Index v : triangle) box.extend(mesh.vertices[static_cast<std::size_t>(v)]);
    boxes.push_back(box);
  }
  return boxes;
}

}  // namespace

double locationTolerance(const Box3& box) {
  if (box.isEmpty()) return 0;
  const double farthest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  return kRelativeTolerance * std::max(farthest, box.diagonal().norm());
}

SurfaceLocator::SurfaceLocator(const TriangleMesh& mesh, int axis, double tolerance)
    : mesh_(mesh), axis_(axis), tolerance_(tolerance), tree_(triangleBoxes(mesh)) {}

Location SurfaceLocator::locate(const Vec3& point) const {
  const Vec3 margin = Vec3::Constant(tolerance_);
  Box3 ray(point - margin, point + margin);
  ray.max()[axis_] = std::numeric_limits<double>::infinity();
  bool inside = false;
  bool uncertain = false;
  tree_.forEachOverlap(ray, [&](Index t) {
    const auto& triangle = mesh_.triangles[static_cast<std::size_t>(t)];
    const auto corner = [&](std::size_t i) -> const Vec3& {
      return mesh_.vertices[static_cast<std::size_t>(triangle[i])];
    };
    const Crossing crossing = rayCrossing(point, corner(0), corner(1), corner(2), axis_, tolerance_);
    if (crossing == Crossing::crossed) inside = !inside;
    if (crossing == Crossing::uncertain) uncertain = true;
  });
  if (uncertain) return Location::uncertain;
  return inside ? Location::inside : Location::outside;
}

}  // namespace voroform::mesh
