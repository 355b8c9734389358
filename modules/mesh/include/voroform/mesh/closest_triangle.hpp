// The point of a triangle mesh that is nearest to a given one.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "voroform/core/types.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::mesh {

// A tree of boxes over a copy of the triangles; built in O(n log n). A query costs about O(log n) near the mesh. Safe
// to query from many threads at once.
class ClosestTriangle {
 public:
  struct Hit {
    Index triangle = kNone;  // kNone if no triangle is nearer than the bound
    Vec3 point = Vec3::Zero();
    // Where on the triangle the point lies: 0 its inside, 1 + i the edge from corner i to the next, 4 + i corner i.
    int feature = 0;
    double distance = std::numeric_limits<double>::infinity();
  };

  ClosestTriangle() = default;
  // Coordinates must be finite, indices in range. Triangles without area count as their edges.
  explicit ClosestTriangle(const TriangleMesh& mesh);

  // Of equally near triangles the one with the lowest index, so the result depends on the point alone as long as the
  // bound is above the distance: a bound known beforehand, as from a point nearby, only saves time.
  Hit find(const Vec3& p, double bound = std::numeric_limits<double>::infinity()) const;

 private:
  // The boxes of both children (rounded outward) beside each other; a child is a node, or a leaf of `count` triangles
  // from `first` on.
  struct Node {
    std::array<std::array<float, 6>, 2> boxes;
    std::array<std::uint32_t, 2> first = {0, 0};
    std::array<std::uint32_t, 2> count = {0, 0};
  };
  struct Triangle {
    std::array<Vec3, 3> corners;
    Index index = kNone;
    bool thin = false;
  };

  std::uint32_t build(std::vector<std::uint32_t>& order, const std::vector<Box3>& boxes, std::uint32_t begin,
                      std::uint32_t end);
  void visitLeaf(const Vec3& p, std::uint32_t first, std::uint32_t count, double& bestSquared, Hit& best) const;

  std::vector<Node> nodes_;
  std::vector<Triangle> triangles_;  // in the order of the leaves
  double slack_ = 0;                 // bounds the rounding of distances
};

}  // namespace voroform::mesh
