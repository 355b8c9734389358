// The steps of prepare() that need no neighborhoods.
#pragma once

#include <string>

#include "voroform/points/prepare.hpp"

namespace voroform::points {

// Drop records in place, keep the order of the others, count in the summary.
void dropNonFinite(PointCloud& cloud, PrepareSummary& summary);
void dropZeroNormals(PointCloud& cloud, PrepareSummary& summary);  // and brings the others to length one
void dropDuplicates(PointCloud& cloud, PrepareSummary& summary);   // the first of equal positions stays

// Moves the origin to the cloud if it lies more than 16 diagonals away. Every local coordinate is exact, and so is
// origin + local.
void shiftFrame(PointCloud& cloud);

// Throws InputError, with the counts, unless at least 50 points are left that fill all three dimensions.
void requireUsable(const PointCloud& cloud, const PrepareSummary& summary, const std::string& name);

}  // namespace voroform::points
