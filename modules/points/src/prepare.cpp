#include "voroform/points/prepare.hpp"

#include "clean.hpp"
#include "neighbors.hpp"
#include "normals.hpp"
#include "voroform/core/error.hpp"

namespace voroform::points {

std::vector<std::string> validate(const PrepareOptions& options) {
  std::vector<std::string> violations;
  if (options.normalNeighbors < kFewestNormalNeighbors) {
    violations.push_back("normalNeighbors is " + std::to_string(options.normalNeighbors) + "; it must be at least " +
                         std::to_string(kFewestNormalNeighbors));
  }
  return violations;
}

PrepareResult prepare(PointCloud raw, const std::string& name, const PrepareOptions& options,
                      const RunContext& context) {
  for (const std::string& violation : validate(options)) throw UsageError(violation);
  PrepareResult result{std::move(raw), {}};
  PointCloud& cloud = result.cloud;
  PrepareSummary& summary = result.summary;
  summary.records = cloud.positions.size();
  summary.normalsEstimated = !cloud.hasNormals();
  if (cloud.hasNormals() && cloud.normals.size() != cloud.positions.size()) {
    throw UsageError(name + ": the cloud has " + std::to_string(cloud.positions.size()) + " positions, but " +
                     std::to_string(cloud.normals.size()) + " normals");
  }
  dropNonFinite(cloud, summary);
  dropZeroNormals(cloud, summary);
  dropDuplicates(cloud, summary);
  shiftFrame(cloud);
  requireUsable(cloud, summary, name);
  context.throwIfCancelled();
  if (summary.normalsEstimated) {
    estimateNormals(cloud, options, summary, context);
    requireUsable(cloud, summary, name);
  }
  summary.spacing = medianSpacing(cloud.positions, context);
  summary.points = cloud.positions.size();
  return result;
}

}  // namespace voroform::points
