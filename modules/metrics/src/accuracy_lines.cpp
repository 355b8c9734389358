#include "accuracy_lines.hpp"

#include <algorithm>
#include <cmath>

#include "voroform/implicit/roots.hpp"

namespace voroform::metrics {

namespace {

// The first try goes a little beyond the guess.
constexpr double kBeyondGuess = 1.25;
constexpr double kLeastTry = 1e-3;        // of the resolution
constexpr double kStep = 0.125;           // of the resolution
constexpr double kRootTolerance = 1e-12;  // of the resolution

// Where the line through the origin crosses a triangle with corners relative to it; infinite if nowhere. Signs of the
// triple products agree between triangles that share an edge, so no line slips through between them.
double crossing(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& direction) {
  constexpr double kNowhere = std::numeric_limits<double>::infinity();
  const double u = direction.dot(b.cross(c));
  const double v = direction.dot(c.cross(a));
  const double w = direction.dot(a.cross(b));
  if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return kNowhere;
  const double sum = u + v + w;
  if (sum == 0) return kNowhere;
  return std::abs(direction.dot(u * a + v * b + w * c) / sum);
}

}  // namespace

std::optional<double> crossingOfForm(const implicit::ImplicitFunction& f, const SampleLine& line, double resolution) {
  const double valueAtOrigin = f.value(line.origin);
  const bool inside = valueAtOrigin < 0;
  struct Side {
    Vec3 direction;
    double value;
  };
  Side sides[2] = {{line.direction, valueAtOrigin}, {-line.direction, valueAtOrigin}};
  double near = 0;
  double far = std::min({kBeyondGuess * line.guess + kLeastTry * resolution, kStep * resolution, line.reach});
  while (true) {
    double best = std::numeric_limits<double>::infinity();
    for (Side& side : sides) {
      const double value = f.value(line.origin + far * side.direction);
      if ((value < 0) != inside) {
        std::int64_t evaluations = 0;
        const double t = implicit::findRoot(f, line.origin + near * side.direction, line.origin + far * side.direction,
                                            side.value, value, kRootTolerance * resolution / (far - near),
                                            implicit::RootFinder::itp, evaluations);
        best = std::min(best, near + t * (far - near));
      }
      side.value = value;
    }
    if (std::isfinite(best)) return best;
    if (far >= line.reach) return std::nullopt;
    near = far;
    far = std::min(far + kStep * resolution, line.reach);
  }
}

LineCrossings::LineCrossings(const mesh::TriangleMesh& mesh) : mesh_(mesh) {
  std::vector<Box3> boxes(mesh.triangles.size());
  for (std::size_t t = 0; t < boxes.size(); ++t) {
    for (const Index v : mesh.triangles[t]) boxes[t].extend(mesh.vertices[static_cast<std::size_t>(v)]);
  }
  tree_ = mesh::BoxTree(boxes);
}

double LineCrossings::within(const SampleLine& line, double length) const {
  // Grown by the rounding of what follows, so that a crossing at the very border of a box is not lost.
  const double slack = 1e-12 * (line.origin.cwiseAbs().maxCoeff() + length);
  const Vec3 half = length * line.direction.cwiseAbs() + Vec3::Constant(slack);
  double best = std::numeric_limits<double>::infinity();
  tree_.forEachOverlap(Box3(line.origin - half, line.origin + half), [&](Index t) {
    const auto& triangle = mesh_.triangles[static_cast<std::size_t>(t)];
    const auto corner = [&](std::size_t k) -> Vec3 {
      return mesh_.vertices[static_cast<std::size_t>(triangle[k])] - line.origin;
    };
    best = std::min(best, crossing(corner(0), corner(1), corner(2), line.direction));
  });
  return best <= length ? best : std::numeric_limits<double>::infinity();
}

std::optional<double> LineCrossings::nearest(const SampleLine& line) const {
  // Short pieces of the line meet few boxes, and nearly always suffice.
  double length = std::min(kBeyondGuess * line.guess + kLeastTry * line.reach, line.reach);
  while (true) {
    const double distance = within(line, length);
    if (std::isfinite(distance)) return distance;
    if (length >= line.reach) return std::nullopt;
    length = std::min(4 * length, line.reach);
  }
}

}  // namespace voroform::metrics
