// Convex cells by cutting a box with half-spaces one after the other: slow, and obvious. Header-only test support.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::testing {

struct ReferenceMoments {
  double volume = 0;
  Vec3 centroid = Vec3::Zero();
  double secondMoment = 0;  // ∫ ‖x − centroid‖² dx
};

// A convex polyhedron as its faces, each a ring of points counter-clockwise seen from outside, with the number of the
// plane that it lies on.
class HalfSpaceCell {
 public:
  static constexpr int kBoxPlane = -1;

  explicit HalfSpaceCell(const Box3& box) {
    constexpr int kRings[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& ring : kRings) {
      Face face{kBoxPlane, {}};
      for (const int c : ring) face.ring.push_back(box.corner(static_cast<Box3::CornerType>(c)));
      faces_.push_back(face);
    }
  }

  // Keeps normal·x ≤ offset.
  void cut(const Vec3& normal, double offset, int plane) {
    std::vector<Face> kept;
    std::vector<Vec3> rim;
    for (const Face& face : faces_) {
      Face part{face.plane, {}};
      for (std::size_t k = 0; k < face.ring.size(); ++k) {
        const Vec3& a = face.ring[k];
        const Vec3& b = face.ring[(k + 1) % face.ring.size()];
        const double heightA = normal.dot(a) - offset;
        const double heightB = normal.dot(b) - offset;
        if (heightA <= 0) part.ring.push_back(a);
        if ((heightA <= 0) != (heightB <= 0)) {
          part.ring.push_back(a + heightA / (heightA - heightB) * (b - a));
          rim.push_back(part.ring.back());
        }
      }
      if (part.ring.size() > 2) kept.push_back(part);
    }
    if (!rim.empty()) kept.push_back({plane, inOrder(rim, normal.normalized())});
    faces_ = kept;
  }

  // How many faces lie on planes that `accept` names.
  template <class Accept>
  std::size_t countFaces(const Accept& accept) const {
    return static_cast<std::size_t>(
        std::count_if(faces_.begin(), faces_.end(), [&](const Face& face) { return accept(face.plane); }));
  }
  std::size_t boxFaces() const {
    return countFaces([](int plane) { return plane == kBoxPlane; });
  }

  ReferenceMoments moments() const {
    ReferenceMoments sum;
    if (faces_.empty()) return sum;
    const Vec3 apex = faces_[0].ring[0];
    Vec3 first = Vec3::Zero();
    double second = 0;
    for (const Face& face : faces_) {
      for (std::size_t k = 2; k < face.ring.size(); ++k) {
        const Vec3 a = face.ring[0] - apex;
        const Vec3 b = face.ring[k - 1] - apex;
        const Vec3 c = face.ring[k] - apex;
        const double volume = a.dot(b.cross(c)) / 6;
        sum.volume += volume;
        first += volume / 4 * (a + b + c);
        second += volume / 20 * (a.squaredNorm() + b.squaredNorm() + c.squaredNorm() + (a + b + c).squaredNorm());
      }
    }
    const Vec3 offset = first / sum.volume;
    sum.centroid = apex + offset;
    sum.secondMoment = second - sum.volume * offset.squaredNorm();
    return sum;
  }

 private:
  struct Face {
    int plane;
    std::vector<Vec3> ring;
  };

  static std::vector<Vec3> inOrder(std::vector<Vec3> rim, const Vec3& normal) {
    Vec3 center = Vec3::Zero();
    for (const Vec3& p : rim) center += p / static_cast<double>(rim.size());
    const Vec3 u = normal.unitOrthogonal();
    const Vec3 v = normal.cross(u);
    const auto angle = [&](const Vec3& p) { return std::atan2(v.dot(p - center), u.dot(p - center)); };
    std::sort(rim.begin(), rim.end(), [&](const Vec3& a, const Vec3& b) { return angle(a) < angle(b); });
    return rim;
  }

  std::vector<Face> faces_;
};

// The Voronoi cell of sites[i] within the box. Faces towards another site carry its number.
inline HalfSpaceCell referenceCell(std::span<const Vec3> sites, std::size_t i, const Box3& box) {
  HalfSpaceCell cell(box);
  for (std::size_t j = 0; j < sites.size(); ++j) {
    if (j == i) continue;
    const Vec3 normal = sites[j] - sites[i];
    cell.cut(normal, normal.dot(0.5 * (sites[i] + sites[j])), static_cast<int>(j));
  }
  return cell;
}

}  // namespace voroform::testing
