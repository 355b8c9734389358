// The dimensionless second moment G of cells (thesis 3.3), in the plane (M = 2) and in space (M = 3).
#pragma once

namespace voroform {

// G of the best known cells: the hexagon's 5/(36·√3), the truncated octahedron's 19/(192·∛2).
template <int M>
inline constexpr double kOptimalRegularity = M == 2 ? 0.08018753738744804 : 0.07854328121717653;

// G(P) = (1/M) ∫_P ‖x − x̂‖² dx / |P|^((M+2)/M), x̂ the centroid: of a cell with this second moment about it, the size
// |P|^(1/M) and the mass |P|. Where the moments are weighted by a density, the size is not: G is free of its units.
template <int M>
constexpr double dimensionlessSecondMoment(double secondMoment, double mass, double size) {
  return secondMoment / (M * mass * size * size);
}

}  // namespace voroform
