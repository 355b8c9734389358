// A regular grid of signed lower bounds of the distance to S: the inside oracle of tetrahedral forms.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"

namespace voroform::implicit {

// Use: construct; mark every voxel that S touches; finish(). Voxels without S that share a face have one sign, so one
// value of f tells it for all; and no point of S is nearer than the nearest marked voxel.
class ClearanceGrid {
 public:
  // `solid` surely contains {f < 0}; the longest side gets `resolution` voxels.
  ClearanceGrid(const Box3& solid, int resolution);

  // Marks the voxels that meet a planar piece of S: those that meet its box and the plane through `point` with this
  // normal; with the normal 0 all that meet the box. Both with a margin far above rounding.
  void mark(const Box3& box, const Vec3& point, const Vec3& normal);

  // Finds the signs (negative(p) tells if f(p) < 0) and the distances.
  void finish(const std::function<bool(const Vec3&)>& negative, const RunContext& context);

  // As ImplicitFunction::clearance.
  double clearance(const Vec3& p) const;

  std::size_t voxels() const { return codes_.size(); }

 private:
  std::size_t indexOf(int x, int y, int z) const;
  void findSigns(const std::function<bool(const Vec3&)>& negative);
  void findDistances(const RunContext& context);

  Box3 solid_;
  Vec3 origin_;
  double edge_;
  double margin_;
  std::array<int, 3> counts_;
  // 0: meets S. Else the sign of f, and as magnitude 1 + the gap to the nearest marked voxel in steps of half an edge.
  std::vector<std::int8_t> codes_;
};

}  // namespace voroform::implicit
