#include "voroform/points/point_cloud.hpp"

namespace voroform::points {

Box3 PointCloud::boundingBox() const {
  Box3 box;
  for (const Vec3& position : positions) box.extend(position);
  return box;
}

}  // namespace voroform::points
