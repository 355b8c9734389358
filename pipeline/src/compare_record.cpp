// The comparison on disk.
#include <array>
#include <fstream>
#include <iomanip>
#include <string>

#include "comparing.hpp"
#include "records.hpp"
#include "results.hpp"
#include "text_files.hpp"
#include "voroform/core/output_file.hpp"
#include "voroform/mesh/formats.hpp"

namespace voroform::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr const char* kSchema = "voroform.comparison/1";

Json orNull(std::uint64_t bytes) { return bytes > 0 ? Json(bytes) : Json(nullptr); }

Json optionsJson(const Form& form, const CompareOptions& options) {
  return {{"methods", options.methods},
          {"resolution", options.resolution},
          {"iterations", options.iterations},
          {"lloyd_iterations", options.delaunay.lloydIterations},
          {"odt_iterations", options.delaunay.odtIterations},
          {"perturb", options.delaunay.perturb},
          {"exude", options.delaunay.exude},
          {"facet_angle", options.delaunay.facetAngle},
          {"radius_edge_ratio", options.delaunay.radiusEdgeRatio},
          {"facet_distance", options.delaunay.facetDistance},
          {"delaunay_time_limit", options.delaunayTimeLimit},
          {"equal_triangles", options.equalTriangles},
          {"fit_baselines", options.fitBaselines},
          {"dual_tetrahedra", options.dualTetrahedra},
          {"envelope", toString(form.record.envelope)},
          {"margin", form.record.margin}};
}

Json countsJson(const MethodOutcome& outcome) {
  return {{"cells", outcome.cells},
          {"boundary_cells", outcome.measurement.regularity.boundary.cells},
          {"vertices", outcome.vertices},
          {"faces", outcome.faces},
          {"boundary_triangles", outcome.boundaryTriangles}};
}

Json qualityJson(const std::optional<metrics::QualityStatistics>& quality, const std::string& prefix) {
  if (!quality) return nullptr;
  Json mean = Json::object();
  Json worst = Json::object();
  for (std::size_t i = 0; i < quality->mean.size(); ++i) {
    const std::string key = prefix + std::to_string(i + 1);
    mean[key] = quality->mean[i];
    worst[key] = quality->worst[i];
  }
  Json json = {{"elements", quality->elements}, {"mean", std::move(mean)}, {"worst", std::move(worst)}};
  if (prefix == "vq") json["slivers"] = quality->slivers;
  return json;
}

Json dualJson(const MethodOutcome& outcome) {
  if (!outcome.dual) return nullptr;
  return {{"surface_sites", outcome.dual->surfaceSites},
          {"removed_tetrahedra", outcome.dual->removedTetrahedra},
          {"volume_error", outcome.dual->volumeError},
          {"tetrahedra", qualityJson(outcome.tetrahedra, "vq")},
          {"boundary_triangles", qualityJson(outcome.dualTriangles, "sq")}};
}

Json marchingCubesJson(const baselines::MarchingCubesSummary& summary) {
  return {{"cut_cells", summary.cutCells},
          {"disconnected_cells", summary.disconnectedCells},
          {"tunnelled_cells", summary.tunnelledCells},
          {"ambiguous_faces", summary.ambiguousFaces},
          {"cases", summary.cases},
          {"function_evaluations", summary.evaluations}};
}

Json ratiosJson(const MethodOutcome& outcome, const std::vector<MethodOutcome>& methods, const std::string& name) {
  for (const MethodOutcome& reference : methods) {
    if (reference.method != name || !reference.accuracy || !outcome.accuracy) continue;
    return {{"dmean", outcome.accuracy->dmean / reference.accuracy->dmean},
            {"drmse", outcome.accuracy->drmse / reference.accuracy->drmse},
            {"nmean", outcome.accuracy->nmean / reference.accuracy->nmean},
            {"nrmse", outcome.accuracy->nrmse / reference.accuracy->nrmse}};
  }
  return nullptr;
}

Json secondsJson(const MethodOutcome& outcome) {
  Json seconds = {{"tessellation", outcome.seconds}, {"evaluation", outcome.secondsEvaluation}};
  if (outcome.cvt) {
    seconds["initial"] = outcome.cvt->secondsInitial;
    seconds["optimization"] = outcome.cvt->secondsOptimization;
    seconds["clipping"] = outcome.cvt->secondsClipping;
  }
  if (outcome.delaunay) {
    seconds["refinement"] = outcome.delaunay->secondsRefinement;
    seconds["optimization"] = outcome.delaunay->secondsOptimization;
  }
  return seconds;
}

Json methodJson(const Form& form, const MethodOutcome& outcome) {
  if (!outcome.failure.empty()) return {{"failure", outcome.failure}, {"seconds", secondsJson(outcome)}};
  Json json = {{"failure", nullptr}};
  if (outcome.cubeEdge > 0) json["cube_edge"] = outcome.cubeEdge;
  json["counts"] = countsJson(outcome);
  json["validity"] = validityJson(outcome.measurement.certificate);
  Json fidelity = Json::object();
  setMeasuredFidelity(fidelity, outcome.measurement.fidelity, form.record.points.has_value());
  if (outcome.cvt) {
    fidelity["empty_sites"] = outcome.cvt->emptySites;
    fidelity["multi_loop_cells"] = outcome.cvt->clip.multiLoopCells;
    fidelity["unprojected_points"] = outcome.cvt->clip.unprojectedPoints;
    fidelity["fallback_caps"] = outcome.cvt->clip.fallbackCaps;
  }
  json["fidelity"] = std::move(fidelity);
  json["regularity"] = regularityJson(outcome.measurement.regularity);
  json["accuracy"] = accuracyJson(outcome.accuracy);
  json["quality"] = {{"boundary_triangles", qualityJson(outcome.triangles, "sq")},
                     {"tetrahedra", outcome.dual ? Json(nullptr) : qualityJson(outcome.tetrahedra, "vq")},
                     {"dual", dualJson(outcome)}};
  if (outcome.marchingCubes) json["marching_cubes"] = marchingCubesJson(*outcome.marchingCubes);
  if (outcome.cvt) {
    json["energy"] = energyJson(*outcome.cvt);
    json["clipping"] = clippingJson(*outcome.cvt);
  }
  if (outcome.fit) {
    json["fit"] = {{"moved_vertices", outcome.fit->moved},
                   {"taken_back", outcome.fit->takenBack},
                   {"samples", outcome.fit->summary.samples},
                   {"unfound", outcome.fit->summary.unfound}};
  }
  json["seconds"] = secondsJson(outcome);
  json["peak_memory_bytes"] = orNull(outcome.peakMemoryBytes);
  return json;
}

Json equalTrianglesJson(const Form& form, const Comparison& comparison) {
  if (!comparison.options.equalTriangles) return nullptr;
  Json json = Json::object();
  for (const MethodOutcome& outcome : comparison.equalTriangles) {
    Json& group = json[outcome.matched];
    for (const MethodOutcome& cvt : comparison.methods) {
      if (cvt.method == outcome.matched) group["boundary_triangles"] = cvt.boundaryTriangles;
    }
    group[outcome.method] = methodJson(form, outcome);
  }
  return json;
}

Json comparisonJson(const Form& form, const Comparison& comparison) {
  Json json = {{"schema", kSchema},
               {"input", inputJson(form.record.input)},
               {"options", optionsJson(form, comparison.options)},
               {"versions", versionsJson()},
               {"seed", comparison.options.seed},
               {"threads", comparison.options.threads}};
  const Json record = formJson(form.record);
  for (const char* key : {"rotation", "points", "mesh", "implicit"}) {
    if (record.contains(key)) json[key] = record[key];
  }
  json["resolution"] = comparison.options.resolution;
  json["sites"] = comparison.sites;
  json["cube_edge"] = comparison.grid.edge;
  json["cubes"] = comparison.grid.cubes;
  json["volume"] = comparison.volume;
  json["cell_size"] = comparison.cellSize;
  json["diagonal"] = comparison.diagonal;
  json["surface_samples"] = {{"count", comparison.samples}, {"variation", comparison.sampleVariation}};
  Json methods = Json::object();
  for (const MethodOutcome& outcome : comparison.methods) {
    Json& method = methods[outcome.method] = methodJson(form, outcome);
    if (!outcome.failure.empty()) continue;
    method["relative_to"] = {{"mc", ratiosJson(outcome, comparison.methods, "mc")},
                             {"delaunay", ratiosJson(outcome, comparison.methods, "delaunay")}};
  }
  json["methods"] = std::move(methods);
  json["equal_triangles"] = equalTrianglesJson(form, comparison);
  json["seconds"] = {{"points", form.secondsPoints},
                     {"implicit", form.secondsImplicit},
                     {"evaluation", comparison.secondsEvaluation},
                     {"total", form.secondsPoints + form.secondsImplicit + comparison.secondsTotal}};
  json["peak_memory_bytes"] = peakMemoryBytes();
  json["warnings"] = comparison.warnings;
  return json;
}

// A row a sample, in world coordinates, all digits.
void writePairs(const fs::path& path, const metrics::AccuracyPairs& pairs, const Frame& frame) {
  OutputFile file(path);
  std::ostream& out = file.stream();
  out << std::setprecision(17) << "from,x,y,z,nearest_x,nearest_y,nearest_z,distance,angle\n";
  const auto write = [&](const char* from, const std::vector<metrics::AccuracyPair>& list) {
    for (const metrics::AccuracyPair& pair : list) {
      const Vec3 sample = frame.origin + pair.sample;
      const Vec3 nearest = frame.origin + pair.nearest;
      out << from << ',' << sample.x() << ',' << sample.y() << ',' << sample.z() << ',' << nearest.x() << ','
          << nearest.y() << ',' << nearest.z() << ',' << pair.distance << ',' << pair.angle << '\n';
    }
  };
  write("form", pairs.fromForm);
  write("boundary", pairs.fromBoundary);
  file.commit();
}

}  // namespace

std::vector<std::string> writeComparison(const Form& form, const Comparison& comparison, const fs::path& folder,
                                         const RunContext& context) {
  context.report("writing", 0);
  ArtifactStore store(folder);
  writeForm(form, store);
  for (const MethodOutcome& outcome : comparison.methods) {
    if (!outcome.failure.empty()) continue;
    store.put(outcome.method + "/" + kCellsFile,
              [&](const fs::path& path) { writeCells(path, outcome.complex, outcome.measurement); });
    const mesh::BoundarySurface surface = mesh::boundarySurface(outcome.complex);
    store.put(outcome.method + "/surface.ply",
              [&](const fs::path& path) { mesh::writeSurfacePly(path, surface, outcome.complex); });
    if (comparison.options.accuracySamples) {
      store.put(outcome.method + "/accuracy-samples.csv",
                [&](const fs::path& path) { writePairs(path, outcome.pairs, outcome.complex.frame); });
    }
    context.throwIfCancelled();
  }
  Json json = comparisonJson(form, comparison);
  // The tables hold times and so differ from run to run.
  json["sha256"] = filesJson(store.pathOf(""), store.names());
  putText(store, "comparison.md", comparisonMarkdown(form, comparison));
  putText(store, "comparison.csv", comparisonCsv(comparison.methods));
  if (comparison.options.equalTriangles) {
    putText(store, "comparison-equal-triangles.csv", comparisonCsv(comparison.equalTriangles));
  }
  store.put(kComparisonFile, [&](const fs::path& path) { writeJson(path, json); });
  context.throwIfCancelled();
  store.commit();
  context.report("writing", 1);
  return store.names();
}

}  // namespace voroform::pipeline
