// Quality of tetrahedra and of boundary triangles (thesis 5.3.4.2 and 5.3.4.3).
#pragma once

#include <array>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

// VQ1, VQ2: smallest and largest dihedral angle, in degrees; VQ3: 3·inradius/circumradius; VQ4: 12·∛(9V²)/Σ l². VQ3 and
// VQ4 are 1 for the regular tetrahedron and 0 for a flat one.
struct TetrahedronQuality {
  double smallestDihedral = 0;
  double largestDihedral = 0;
  double radiusRatio = 0;
  double meshingQuality = 0;
};
TetrahedronQuality tetrahedronQuality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

// SQ1, SQ2: smallest and largest angle, in degrees; SQ3: 2·inradius/circumradius; SQ4: 4√3·area/Σ l². SQ3 and SQ4 are 1
// for the equilateral triangle and 0 for a flat one.
struct TriangleQuality {
  double smallestAngle = 0;
  double largestAngle = 0;
  double radiusRatio = 0;
  double meshingQuality = 0;
};
TriangleQuality triangleQuality(const Vec3& a, const Vec3& b, const Vec3& c);

// Means and worst values of a mesh's elements.
struct QualityStatistics {
  std::int64_t elements = 0;
  std::array<double, 4> mean = {};   // of criteria 1 … 4
  std::array<double, 4> worst = {};  // smallest of 1, 3 and 4, largest of 2
  std::int64_t slivers = 0;          // tetrahedra with a dihedral angle below kSliverAngle; 0 for triangles
};
inline constexpr double kSliverAngle = 10;  // degrees

// Over the cells of a complex of tetrahedra. Throws UsageError if a cell is none.
QualityStatistics tetrahedraQuality(const mesh::PolyhedralComplex& complex, const RunContext& context);
// Over the triangles of the boundary; `withEnvelope` false leaves those on the envelope out.
QualityStatistics boundaryTriangleQuality(const mesh::PolyhedralComplex& complex, bool withEnvelope = true);

}  // namespace voroform::metrics
