// Point clouds.
#pragma once

#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::points {

// Positions in local coordinates (world = frame.origin + local), and normals: empty, or one for each position, of unit
// length, pointing out of the solid.
struct PointCloud {
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;
  Frame frame;

  bool hasNormals() const { return !normals.empty(); }
  Box3 boundingBox() const;
};

}  // namespace voroform::points
