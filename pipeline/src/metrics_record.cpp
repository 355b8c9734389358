#include <sys/resource.h>

#include "records.hpp"

namespace voroform::pipeline {

namespace {

Json statisticsJson(const metrics::RegularityStatistics& statistics) {
  return {{"cells", statistics.cells},   {"max", statistics.max},   {"mean", statistics.mean},
          {"median", statistics.median}, {"rmse", statistics.rmse}, {"histogram", statistics.histogram}};
}

Json optionsJson(const FormRecord& form, const WriteOptions& options) {
  Json formats = Json::array();
  for (const ExtraFormat format : options.formats) formats.push_back(toString(format));
  const cvt::TessellateOptions& cvt = options.tessellate;
  Json json = {{"method", toString(CvtMethod{cvt.cap, cvt.fit})}};
  json.update(siteOptionsJson(cvt));
  json["density"] = densityJson(cvt.density);
  json.update(Json{{"root_finder", toString(cvt.rootFinder)},
                   {"envelope", toString(form.envelope)},
                   {"margin", form.margin},
                   {"formats", std::move(formats)}});
  return json;
}

Json directedJson(const metrics::DirectedAccuracy& directed) {
  return {{"samples", directed.samples},
          {"variation", directed.variation},
          {"mean", directed.mean},
          {"rms", directed.rms},
          {"max", directed.max},
          {"normal_mean", directed.normalMean},
          {"normal_rms", directed.normalRms},
          {"unfound", directed.unfound}};
}

Json relativeJson(const metrics::Accuracy& accuracy, double unit) {
  return {{"dmean", accuracy.dmean / unit}, {"drmse", accuracy.drmse / unit}, {"dmax", accuracy.dmax / unit}};
}

}  // namespace

Json siteOptionsJson(const cvt::SiteOptions& options) {
  return {{"sites", options.sites},
          {"initialization", toString(options.initialization)},
          {"subdivisions", options.subdivisions},
          {"subdivision_rule", toString(options.subdivisionRule)},
          {"iterations", options.iterations},
          {"optimizer", toString(options.optimizer)},
          {"perturbations", options.perturbations},
          {"convergence", options.convergence},
          {"gradient_tolerance", options.gradientTolerance},
          {"relative_error", options.relativeError}};
}

Json densityJson(const cvt::DensityOptions& options) {
  return {{"kind", cvt::toString(options.kind)}, {"ratio", options.ratio}, {"width", options.width}};
}

Json hierarchyJson(const std::vector<cvt::HierarchyLevel>& levels) {
  Json json = Json::array();
  for (const cvt::HierarchyLevel& level : levels) {
    json.push_back({{"sites", level.sites},
                    {"subdivided", level.subdivided},
                    {"inserted", level.inserted},
                    {"iterations", level.optimization.iterationsDone},
                    {"evaluations", level.optimization.evaluations},
                    {"stop", cvt::toString(level.optimization.stop)},
                    {"energy", level.optimization.energy},
                    {"relative_error", level.optimization.relativeError}});
  }
  return json;
}

Json energyJson(const cvt::OptimizeSummary& summary) {
  Json steps = Json::array();
  for (const cvt::IterationRecord& record : summary.iterations) {
    steps.push_back({{"value", record.energy},
                     {"rms_move", record.rmsMove},
                     {"mean_regularity", record.meanRegularity},
                     {"evaluations", record.evaluations}});
  }
  return {{"value", summary.energy},
          {"optimal", summary.optimalEnergy},
          {"relative_error", summary.relativeError},
          {"iterations", summary.iterationsDone},
          {"restarts", summary.restarts},
          {"rejected_steps", summary.rejectedSteps},
          {"evaluations", summary.evaluations},
          {"stop", cvt::toString(summary.stop)},
          {"history", std::move(steps)}};
}

Json clippingJson(const cvt::TessellateSummary& summary) {
  const voronoi::ClipSummary& clip = summary.clip;
  return {{"roots", clip.roots},
          {"double_root_edges", clip.doubleRootEdges},
          {"caps", clip.loops},
          {"cap_points", clip.capPoints},
          {"fitted_points", clip.fittedPoints},
          {"unfitted_points", clip.unfittedPoints},
          {"chord_points", clip.chordPoints},
          {"tongue_points", clip.tonguePoints},
          {"tips", clip.tips},
          {"function_evaluations", clip.evaluations},
          {"oracle_share", clip.oracleShare},
          {"reseeded_sites", summary.reseededSites},
          {"moved_sites", summary.movedSites}};
}

Json accuracyJson(const std::optional<metrics::Accuracy>& accuracy) {
  if (!accuracy) return nullptr;
  return {{"units", {{"distances", "the input's"}, {"angles", "radians"}}},
          {"cell_size", accuracy->cellSize},
          {"diagonal", accuracy->diagonal},
          {"dmean", accuracy->dmean},
          {"drmse", accuracy->drmse},
          {"dmax", accuracy->dmax},
          {"nmean", accuracy->nmean},
          {"nrmse", accuracy->nrmse},
          {"relative",
           {{"diagonal", relativeJson(*accuracy, accuracy->diagonal)},
            {"cell_size", relativeJson(*accuracy, accuracy->cellSize)}}},
          {"per_direction",
           {{"form_to_boundary", directedJson(accuracy->fromForm)},
            {"boundary_to_form", directedJson(accuracy->fromBoundary)}}},
          {"normal_line",
           {{"mean", accuracy->normalLine.mean},
            {"rms", accuracy->normalLine.rms},
            {"misses", accuracy->normalLine.misses}}},
          {"unfound", accuracy->fromForm.unfound + accuracy->fromBoundary.unfound}};
}

std::uint64_t peakMemoryBytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::int64_t boundaryTriangles(const mesh::PolyhedralComplex& complex) {
  std::int64_t triangles = 0;
  for (Index f = 0; f < complex.faceCount(); ++f) {
    if (complex.isBoundary(f)) triangles += static_cast<std::int64_t>(complex.face(f).size()) - 2;
  }
  return triangles;
}

Json countsJson(const mesh::PolyhedralComplex& complex, const Measurement& measurement, Index sites) {
  return {{"sites", sites},
          {"cells", complex.cellCount},
          {"boundary_cells", measurement.regularity.boundary.cells},
          {"vertices", complex.vertices.size()},
          {"faces", complex.faceCount()},
          {"boundary_triangles", boundaryTriangles(complex)}};
}

Json validityJson(const mesh::Certificate& certificate) {
  return {{"valid", certificate.valid},
          {"closed_cells", certificate.closedCells()},
          {"manifold_boundary", certificate.manifoldBoundary()},
          {"oriented", certificate.oriented()},
          {"self_intersections", certificate.selfIntersections},
          {"point_samples", certificate.pointSamples},
          {"point_violations", certificate.pointViolations},
          {"volume", certificate.volume},
          {"volume_error", certificate.volumeError},
          {"components", certificate.components},
          {"euler_characteristic", certificate.eulerCharacteristic},
          {"problems", certificate.problems}};
}

void setMeasuredFidelity(Json& fidelity, const metrics::Fidelity& measured, bool hasCloud) {
  fidelity["volume_error"] = measured.volumeError;
  fidelity["sampled_volume"] = measured.sampledVolume;
  fidelity["sampled_volume_sigma"] = measured.sampledVolumeSigma;
  fidelity["missed_share"] = measured.missedShare;
  fidelity["disconnected_cells"] = measured.disconnectedCells;
  fidelity["envelope_share"] = measured.envelopeShare;
  fidelity["unsupported_share"] = hasCloud ? Json(measured.unsupportedShare) : Json(nullptr);
}

Json regularityJson(const metrics::Regularity& regularity) {
  return {{"optimal", regularity.optimal},
          {"all", statisticsJson(regularity.all)},
          {"interior", statisticsJson(regularity.interior)},
          {"boundary", statisticsJson(regularity.boundary)}};
}

Json metricsJson(const Form& form, const Tessellation& tessellation, const WriteOptions& options) {
  const cvt::TessellateSummary& summary = tessellation.summary;
  const Measurement& measurement = tessellation.measurement;
  Json json = {{"schema", kMetricsSchema},
               {"input", inputJson(form.record.input)},
               {"options", optionsJson(form.record, options)},
               {"versions", versionsJson()},
               {"seed", options.tessellate.seed},
               {"threads", options.threads}};
  const Json formRecordJson = formJson(form.record);
  for (const char* key : {"mesh", "points", "implicit"}) {
    if (formRecordJson.contains(key)) json[key] = formRecordJson[key];
  }
  json["counts"] = countsJson(tessellation.complex, measurement, summary.sites);
  json["validity"] = validityJson(measurement.certificate);
  Json fidelity = Json::object();
  setMeasuredFidelity(fidelity, measurement.fidelity, form.record.points.has_value());
  fidelity["empty_sites"] = summary.emptySites;
  fidelity["multi_loop_cells"] = summary.clip.multiLoopCells;
  fidelity["unprojected_points"] = summary.clip.unprojectedPoints;
  fidelity["fallback_caps"] = summary.clip.fallbackCaps;
  json["fidelity"] = std::move(fidelity);
  json["clipping"] = clippingJson(summary);
  json["regularity"] = regularityJson(measurement.regularity);
  json["accuracy"] = accuracyJson(tessellation.accuracy);
  json["energy"] = energyJson(summary);
  if (!summary.levels.empty()) json["hierarchy"] = hierarchyJson(summary.levels);
  json["seconds"] = {
      {"points", form.secondsPoints},
      {"implicit", form.secondsImplicit},
      {"tessellation", tessellation.seconds},
      {"metrics", tessellation.secondsMetrics},
      {"total", form.secondsPoints + form.secondsImplicit + tessellation.seconds + tessellation.secondsMetrics}};
  json["peak_memory_bytes"] = peakMemoryBytes();
  json["warnings"] = tessellation.warnings;
  return json;
}

}  // namespace voroform::pipeline
