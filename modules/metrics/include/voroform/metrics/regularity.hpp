// Regularity of cells: the dimensionless second moment G (thesis 3.3).
#pragma once

#include <span>
#include <vector>

#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

// G of the best known cell, the truncated octahedron: 19/(192·∛2) (thesis 3.3).
inline constexpr double kOptimalRegularity = 0.07854328121717653;

// G(P) = (1/3) ∫_P ‖x − x̂‖² dx / |P|^(5/3), x̂ the centroid; one value a cell.
std::vector<double> regularities(std::span<const mesh::CellMoments> moments);

struct RegularityStatistics {
  Index cells = 0;
  double max = 0;
  double mean = 0;
  double median = 0;
  double rmse = 0;               // root mean square of G − G₃
  std::vector<Index> histogram;  // 50 bins over [0.078, 0.128], the last holds all above
};

struct Regularity {
  RegularityStatistics all;
  RegularityStatistics interior;  // cells without a boundary face
  RegularityStatistics boundary;
};

Regularity regularity(const mesh::PolyhedralComplex& complex, std::span<const double> values);

}  // namespace voroform::metrics
