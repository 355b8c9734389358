// Regularity of cells: the dimensionless second moment G (thesis 3.3).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/regularity.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/planar_moments.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

// G of each cell.
std::vector<double> regularities(std::span<const mesh::CellMoments> moments);
std::vector<double> regularities(std::span<const mesh::PlanarCellMoments> moments);

struct RegularityStatistics {
  Index cells = 0;
  double max = 0;
  double mean = 0;
  double median = 0;
  double rmse = 0;               // root mean square of G − G_m
  std::vector<Index> histogram;  // 50 bins over [0.078, 0.128], the last holds all above
};

struct Regularity {
  double optimal = kOptimalRegularity<3>;  // G_m
  RegularityStatistics all;
  RegularityStatistics interior;  // cells without a boundary face; in the plane, without a boundary edge
  RegularityStatistics boundary;
};

Regularity regularity(const mesh::PolyhedralComplex& complex, std::span<const double> values);
// Of the plane's cells; `onBoundary` is not 0 for boundary cells.
Regularity planarRegularity(std::span<const double> values, std::span<const std::uint8_t> onBoundary);

}  // namespace voroform::metrics
