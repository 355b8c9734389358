// The thesis's variant of the distance between surfaces (5.3.3): from a sample along a line to the nearest crossing.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/box_tree.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

// A line through a sample on one surface, and what is known of the other.
struct SampleLine {
  Vec3 origin = Vec3::Zero();
  Vec3 direction = Vec3::Zero();  // unit
  // Lengths at which the search tries its luck first: the distance of the other surface's tangent plane along the line.
  double guess = 0;
  double reach = 0;  // crossings farther than this, to either side, are of no interest
};

// How far along the line, to either side, S is crossed first: the distance, or nothing within the reach. Crossings
// that lie less than an eighth of `resolution` apart may be overlooked in pairs.
std::optional<double> crossingOfForm(const implicit::ImplicitFunction& f, const SampleLine& line, double resolution);

// The same for a triangle mesh, exactly. The mesh must outlive this.
class LineCrossings {
 public:
  explicit LineCrossings(const mesh::TriangleMesh& mesh);
  std::optional<double> nearest(const SampleLine& line) const;

 private:
  // The least distance of a crossing within `length` to either side; infinite if there is none.
  double within(const SampleLine& line, double length) const;

  const mesh::TriangleMesh& mesh_;
  mesh::BoxTree tree_;
};

}  // namespace voroform::metrics
