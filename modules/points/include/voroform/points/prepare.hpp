// From raw records to a cloud that a surface can be fitted to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/points/point_cloud.hpp"

namespace voroform::points {

struct PrepareOptions {
  // Neighbors of the local plane fit when normals are estimated; at least 6.
  int normalNeighbors = 18;
};
// Every violation of the options, as sentences; empty if there is none.
std::vector<std::string> validate(const PrepareOptions& options);

struct PrepareSummary {
  std::uint64_t records = 0;      // that went in
  std::uint64_t nonFinite = 0;    // dropped: NaN or infinite coordinates or normals
  std::uint64_t zeroNormals = 0;  // dropped: normal of length zero
  std::uint64_t duplicates = 0;   // dropped: same position as an earlier record
  bool normalsEstimated = false;  // the input had none: plane fits, oriented along a minimum spanning tree
  std::uint64_t pieces = 0;       // of the neighborhood graph, oriented each for itself; only if estimated
  std::uint64_t unoriented = 0;   // dropped: the orientation did not reach them
  double spacing = 0;             // median over the points of the mean distance to their six nearest neighbors
  std::uint64_t points = 0;       // that came out
};

struct PrepareResult {
  PointCloud cloud;
  PrepareSummary summary;
};

// Shifts the frame (only if the cloud lies far from the origin, measured by its diagonal; the shift is a multiple of a
// power of two, so that it loses nothing), drops what cannot be used, normalizes the normals, estimates and orients
// them where there are none. `name` stands in messages. Throws InputError with the counts found if fewer than 50 usable
// points remain or all lie in a plane (or on a line, or at one place).
PrepareResult prepare(PointCloud raw, const std::string& name, const PrepareOptions& options,
                      const RunContext& context);

}  // namespace voroform::points
