// The files of a planar tessellation.
#include "records.hpp"
#include "results.hpp"
#include "voroform/mesh/planar_formats.hpp"
#include "voroform/pipeline/planar.hpp"

namespace voroform::pipeline {

namespace {

Json regionJson(const mesh::PlanarRegion& region) {
  return {{"area", region.area()},
          {"rings", region.ringCount()},
          {"holes", region.holeCount()},
          {"points", region.points().size()}};
}

Json planarOptionsJson(const PlanarOptions& options) {
  Json json = siteOptionsJson(options);
  json["density"] = densityJson(options.density);
  return json;
}

Json planarCountsJson(const PlanarResult& result) {
  const mesh::PlanarTessellation& tessellation = result.tessellation;
  std::size_t boundaryEdges = 0;
  for (const Index neighbor : tessellation.neighbors) boundaryEdges += neighbor == kNone ? 1U : 0U;
  return {{"sites", tessellation.cellCount() + result.emptySites},
          {"empty_sites", result.emptySites},
          {"cells", tessellation.cellCount()},
          {"boundary_cells", result.measurement.regularity.boundary.cells},
          {"vertices", tessellation.vertices.size()},
          {"edges", (tessellation.neighbors.size() + boundaryEdges) / 2},
          {"boundary_edges", boundaryEdges}};
}

Json planarValidityJson(const mesh::PlanarCertificate& certificate) {
  return {{"valid", certificate.valid},
          {"closed", certificate.closed()},
          {"invalid_loops", certificate.invalidLoops},
          {"non_finite_vertices", certificate.nonFiniteVertices},
          {"unmatched_edges", certificate.unmatchedEdges},
          {"open_vertices", certificate.openVertices},
          {"stray_edges", certificate.strayEdges},
          {"non_positive_areas", certificate.nonPositiveAreas},
          {"boundary_loops", certificate.boundaryLoops},
          {"boundary_error", certificate.boundaryError},
          {"point_samples", certificate.pointSamples},
          {"point_violations", certificate.pointViolations},
          {"area", certificate.area},
          {"area_error", certificate.areaError},
          {"problems", certificate.problems}};
}

Json planarSecondsJson(const PlanarInput& input, const PlanarResult& result) {
  Json levels = Json::array();
  for (const cvt::HierarchyLevel& level : result.summary.levels) levels.push_back(level.seconds);
  return {{"reading", input.secondsReading},
          {"initial_sites", result.summary.secondsInitial},
          {"levels", std::move(levels)},
          {"optimization", result.summary.secondsOptimization},
          {"tessellation", result.secondsTessellation},
          {"metrics", result.secondsMetrics},
          {"total", input.secondsReading + result.secondsTessellation + result.secondsMetrics}};
}

Json planarMetricsJson(const PlanarInput& input, const PlanarResult& result, const PlanarWriteOptions& options) {
  Json json = {{"schema", kMetricsSchema},
               {"dimension", 2},
               {"input", inputJson(input.record)},
               {"options", planarOptionsJson(options.tessellate)},
               {"versions", versionsJson()},
               {"seed", options.tessellate.seed},
               {"threads", options.threads},
               {"region", regionJson(input.region)},
               {"counts", planarCountsJson(result)},
               {"validity", planarValidityJson(result.measurement.certificate)},
               {"regularity", regularityJson(result.measurement.regularity)},
               {"energy", energyJson(result.summary)}};
  if (!result.summary.levels.empty()) json["hierarchy"] = hierarchyJson(result.summary.levels);
  json["seconds"] = planarSecondsJson(input, result);
  json["peak_memory_bytes"] = peakMemoryBytes();
  json["warnings"] = result.warnings;
  return json;
}

void writePlanarCells(const std::filesystem::path& path, const PlanarResult& result) {
  const PlanarMeasurement& measurement = result.measurement;
  std::vector<double> areas;
  areas.reserve(measurement.moments.size());
  for (const mesh::PlanarCellMoments& moments : measurement.moments) areas.push_back(moments.area);
  const std::vector<mesh::CellData> data = {
      {"area", std::move(areas)},
      {"regularity", measurement.regularities},
      {"boundary", {measurement.onBoundary.begin(), measurement.onBoundary.end()}}};
  mesh::writePlanarVtu(path, result.tessellation, data);
}

}  // namespace

std::vector<std::string> writePlanarResults(const PlanarInput& input, const PlanarResult& result,
                                            const PlanarWriteOptions& options, const std::filesystem::path& folder,
                                            const RunContext& context) {
  using Path = std::filesystem::path;
  context.report("writing", 0);
  ArtifactStore store(folder);
  store.put(kCellsFile, [&](const Path& path) { writePlanarCells(path, result); });
  context.throwIfCancelled();
  mesh::PlanarSvgOptions picture;
  picture.low = kOptimalRegularity<2>;
  picture.high = kPlanarScaleEnd;
  picture.label = "regularity G";
  store.put("cells.svg", [&](const Path& path) {
    mesh::writePlanarSvg(path, result.tessellation, result.measurement.regularities, picture);
  });
  store.put("sites.ply", [&](const Path& path) { mesh::writePlanarSitesPly(path, result.tessellation.sites); });
  Json json = planarMetricsJson(input, result, options);
  json["sha256"] = filesJson(store.pathOf(""), store.names());
  store.put(kMetricsFile, [&](const Path& path) { writeJson(path, json); });
  context.throwIfCancelled();
  store.commit();
  context.report("writing", 1);
  return store.names();
}

}  // namespace voroform::pipeline
