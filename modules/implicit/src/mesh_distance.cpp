#include "voroform/implicit/mesh_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include "clearance_grid.hpp"
#include "rounding.hpp"
#include "voroform/core/error.hpp"
#include "voroform/mesh/closest_triangle.hpp"
#include "voroform/mesh/read_mesh.hpp"
#include "voroform/mesh/surface_locator.hpp"

namespace voroform::implicit {

namespace {

constexpr int kGridResolution = 192;
// Height over longest edge below which a triangle's normal is not relied on.
constexpr double kThin = 1e-8;
// Distance below which the direction from the nearest point is lost to rounding, as a share of the mesh's size.
constexpr double kNoDirection = 1e-12;

using Corners = std::array<Vec3, 3>;

// Unit normal, or zero for a triangle too thin to have one.
Vec3 unitNormal(const Corners& corners) {
  const Vec3 ab = corners[1] - corners[0];
  const Vec3 ac = corners[2] - corners[0];
  const Vec3 normal = ab.cross(ac);
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (corners[2] - corners[1]).squaredNorm()});
  return normal.norm() > kThin * longest ? Vec3(normal.normalized()) : Vec3::Zero();
}

double angleAt(const Corners& corners, std::size_t i) {
  const Vec3 ab = corners[(i + 1) % 3] - corners[i];
  const Vec3 ac = corners[(i + 2) % 3] - corners[i];
  return std::atan2(ab.cross(ac).norm(), ab.dot(ac));
}

// Pseudonormals of a triangle's features in the order of mesh::ClosestTriangle::Hit::feature. Of the inside and the
// edges of unit length, of the corners not. Zero: the feature touches a triangle without a normal.
using FeatureNormals = std::array<Vec3, 7>;

std::vector<FeatureNormals> pseudonormals(const mesh::TriangleMesh& mesh) {
  const std::size_t count = mesh.triangles.size();
  std::vector<FeatureNormals> normals(count);
  std::vector<Vec3> atVertex(mesh.vertices.size(), Vec3::Zero());
  std::vector<std::uint8_t> doubtful(mesh.vertices.size(), 0);
  const auto cornersOf = [&](std::size_t t) {
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][i])];
    return corners;
  };
  // The edge's other triangle, by its vertices in that triangle's order.
  std::unordered_map<std::uint64_t, std::uint32_t> triangleOfEdge;
  triangleOfEdge.reserve(3 * count);
  const auto keyOf = [](Index from, Index to) {
    return static_cast<std::uint64_t>(from) << 32U | static_cast<std::uint64_t>(to);
  };
  for (std::size_t t = 0; t < count; ++t) {
    const Corners corners = cornersOf(t);
    const auto& triangle = mesh.triangles[t];
    normals[t][0] = unitNormal(corners);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto v = static_cast<std::size_t>(triangle[i]);
      atVertex[v] += angleAt(corners, i) * normals[t][0];
      if (normals[t][0].isZero(0)) doubtful[v] = 1;
      triangleOfEdge[keyOf(triangle[i], triangle[(i + 1) % 3])] = static_cast<std::uint32_t>(t);
    }
  }
  for (std::size_t t = 0; t < count; ++t) {
    const auto& triangle = mesh.triangles[t];
    for (std::size_t i = 0; i < 3; ++i) {
      const auto found = triangleOfEdge.find(keyOf(triangle[(i + 1) % 3], triangle[i]));
      if (found == triangleOfEdge.end()) throw std::invalid_argument("meshDistance: the mesh is not closed");
      const Vec3& other = normals[found->second][0];
      const Vec3 sum = normals[t][0] + other;
      const bool known = !normals[t][0].isZero(0) && !other.isZero(0) && sum.norm() > 1e-6;
      normals[t][1 + i] = known ? Vec3(sum.normalized()) : Vec3::Zero();
      const auto v = static_cast<std::size_t>(triangle[i]);
      normals[t][4 + i] = doubtful[v] != 0 ? Vec3::Zero() : atVertex[v];
    }
  }
  return normals;
}

class MeshDistance final : public ImplicitFunction {
 public:
  MeshDistance(std::shared_ptr<const mesh::TriangleMesh> mesh, const RunContext& context)
      : mesh_(std::move(mesh)), tree_(*mesh_), normals_(pseudonormals(*mesh_)) {
    for (const Vec3& vertex : mesh_->vertices) box_.extend(vertex);
    noDirection_ = kNoDirection * (box_.diagonal().norm() + box_.center().norm());
    const mesh::MeshIntersections found = mesh::meshIntersections(*mesh_, context);
    parity_ = found.pairs > 0;
    if (parity_) {
      const Vec3 at = mesh_->frame.origin + corner(found.first[0], 0);
      context.warn("the mesh intersects itself (" + std::to_string(found.pairs) +
                   " pairs of triangles, the first near (" + std::to_string(at.x()) + ", " + std::to_string(at.y()) +
                   ", " + std::to_string(at.z()) +
                   ")); what lies within an even number of its sheets counts as outside");
    }
    const bool hasAllNormals = std::none_of(normals_.begin(), normals_.end(), [](const FeatureNormals& of) {
      return std::any_of(of.begin(), of.end(), [](const Vec3& normal) { return normal.isZero(0); });
    });
    if (parity_ || !hasAllNormals) {
      const double tolerance = mesh::locationTolerance(box_);
      for (int axis = 0; axis < 3; ++axis) {
        locators_[static_cast<std::size_t>(axis)].emplace(*mesh_, axis, tolerance);
      }
    }
    buildGrid(context);
  }

  double value(const Vec3& p) const override { return signedDistance(p, tree_.find(p)); }

  void values(std::span<const Vec3> points, std::span<double> out) const override {
    if (points.size() != out.size()) throw std::invalid_argument("values: lists of unlike lengths");
    // The distance at the point before bounds that at the next; see ClosestTriangle::find.
    double bound = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (i > 0) bound = (bound + (points[i] - points[i - 1]).norm()) * (1 + 1e-9) + noDirection_;
      if (std::isnan(bound)) bound = std::numeric_limits<double>::infinity();
      const mesh::ClosestTriangle::Hit hit = tree_.find(points[i], bound);
      out[i] = signedDistance(points[i], hit);
      bound = hit.distance;
    }
  }

  Vec3 gradient(const Vec3& p) const override {
    const mesh::ClosestTriangle::Hit hit = tree_.find(p);
    if (hit.triangle == kNone) return Vec3::Zero();
    const Vec3& normal = normalOf(hit);
    if (hit.distance > noDirection_ && (hit.feature != 0 || parity_ || normal.isZero(0))) {
      return (signedDistance(p, hit) < 0 ? -1.0 : 1.0) / hit.distance * (p - hit.point);
    }
    return normal.isZero(0) ? knownNormalNear(hit) : Vec3(normal.normalized());
  }

  Box3 bounds() const override { return inflated(box_); }

  double clearance(const Vec3& p) const override { return grid_->clearance(p); }

 private:
  const Vec3& corner(Index t, std::size_t i) const {
    return mesh_->vertices[static_cast<std::size_t>(mesh_->triangles[static_cast<std::size_t>(t)][i])];
  }

  const Vec3& normalOf(const mesh::ClosestTriangle::Hit& hit) const {
    return normals_[static_cast<std::size_t>(hit.triangle)][static_cast<std::size_t>(hit.feature)];
  }

  double signedDistance(const Vec3& p, const mesh::ClosestTriangle::Hit& hit) const {
    if (hit.triangle == kNone) return std::numeric_limits<double>::infinity();  // no place is near to infinity
    // Far away the heights below are all rounding.
    if (!box_.contains(p)) return hit.distance;
    const Vec3& normal = normalOf(hit);
    if (parity_ || normal.isZero(0)) return signByRays(p, hit) * hit.distance;
    // Above the inside of a triangle the height is more exact than the difference to the foot.
    if (hit.feature == 0) return normal.dot(p - corner(hit.triangle, 0));
    return normal.dot(p - hit.point) < 0 ? -hit.distance : hit.distance;
  }

  double signByRays(const Vec3& p, const mesh::ClosestTriangle::Hit& hit) const {
    for (const auto& locator : locators_) {
      const mesh::Location location = locator->locate(p);
      if (location != mesh::Location::uncertain) return location == mesh::Location::inside ? -1 : 1;
    }
    const Vec3& normal = normalOf(hit);
    return (normal.isZero(0) ? knownNormalNear(hit) : normal).dot(p - hit.point) < 0 ? -1 : 1;
  }

  // A pseudonormal of the triangle hit that there is, of unit length.
  Vec3 knownNormalNear(const mesh::ClosestTriangle::Hit& hit) const {
    const FeatureNormals& normals = normals_[static_cast<std::size_t>(hit.triangle)];
    for (const Vec3& normal : normals) {
      if (!normal.isZero(0)) return normal.normalized();
    }
    return (hit.point - box_.center()).stableNormalized();
  }

  void buildGrid(const RunContext& context) {
    grid_.emplace(box_, kGridResolution);
    for (std::size_t t = 0; t < mesh_->triangles.size(); ++t) {
      Box3 box;
      for (std::size_t i = 0; i < 3; ++i) box.extend(corner(static_cast<Index>(t), i));
      grid_->mark(box, corner(static_cast<Index>(t), 0), normals_[t][0]);
    }
    grid_->finish([this](const Vec3& p) { return value(p) < 0; }, context);
  }

  std::shared_ptr<const mesh::TriangleMesh> mesh_;
  mesh::ClosestTriangle tree_;
  std::vector<FeatureNormals> normals_;
  Box3 box_;
  double noDirection_ = 0;
  bool parity_ = false;  // the mesh intersects itself: the sign is that of the even-odd rule
  std::array<std::optional<mesh::SurfaceLocator>, 3> locators_;
  std::optional<ClearanceGrid> grid_;
};

}  // namespace

ImplicitPtr meshDistance(std::shared_ptr<const mesh::TriangleMesh> mesh, const RunContext& context) {
  if (!mesh || mesh->triangles.empty()) throw InputError("the mesh has no triangles");
  return std::make_shared<MeshDistance>(std::move(mesh), context);
}

}  // namespace voroform::implicit
