// voroform: basic types and the conventions that every module keeps.
//
// Sign: an implicit function is negative inside the solid, zero on its surface, positive outside; f = 0 counts as
// outside. Orientation: a face's loop runs counter-clockwise seen from the cell ahead of it, so its normal points from
// the cell behind to the cell ahead; a boundary face's normal points out of the solid. Coordinates are doubles in the
// input's units, shifted by an origin that is stored with the data (see Frame).
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

namespace voroform {

// Points and boxes of M dimensions.
template <int M>
using Vec = Eigen::Matrix<double, M, 1>;
template <int M>
using Box = Eigen::AlignedBox<double, M>;

using Vec2 = Vec<2>;
using Vec3 = Vec<3>;
using Mat3 = Eigen::Matrix3d;
using Box2 = Box<2>;
using Box3 = Box<3>;

// Index of an element; -1 stands for "none" (for a cell: the exterior).
using Index = std::int32_t;
inline constexpr Index kNone = -1;

// Where local coordinates lie in the input's: world = origin + local.
struct Frame {
  Vec3 origin = Vec3::Zero();
};

}  // namespace voroform
