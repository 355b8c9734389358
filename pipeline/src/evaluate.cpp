#include <algorithm>
#include <system_error>

#include "records.hpp"
#include "results.hpp"
#include "voroform/core/error.hpp"
#include "voroform/mesh/formats.hpp"
#include "voroform/pipeline/sha256.hpp"
#include "voroform/pipeline/tessellation.hpp"
#include "warnings.hpp"

namespace voroform::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr const char* kChangedFile = " has changed since metrics.json was written";

// The value of a key that the record must have, with a message that names it.
Json& member(Json& json, const char* key, const fs::path& path) {
  if (!json.is_object() || !json.contains(key)) {
    throw InputError(path.string() + ": the key \"" + key + "\" is missing; expected a record as tessellate writes it");
  }
  return json[key];
}

template <class T>
T value(Json& json, const char* key, const fs::path& path) {
  return valueAs<T>(member(json, key, path), key, path.string());
}

Form formOfResults(const fs::path& folder, Json& json, const fs::path& metricsPath, const RunContext& context) {
  Json& input = member(json, "input", metricsPath);
  if (value<std::string>(input, "kind", metricsPath) == "shape") {
    try {
      return formFromShape(value<std::string>(input, "name", metricsPath),
                           rotationSeed(input, metricsPath.string() + ", input"));
    } catch (const UsageError& error) {
      throw InputError(metricsPath.string() + ": " + error.what());
    }
  }
  return formFromFile(formFileOf(folder), context);
}

void appendNew(std::vector<std::string>& list, const std::string& text) {
  if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

}  // namespace

Evaluation evaluate(const fs::path& folder, const RunContext& context) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw InputError(folder.string() + ": " +
                     (fs::exists(folder, error) ? "expected a folder, found a file" : "no such folder"));
  }
  const fs::path metricsPath = folder / kMetricsFile;
  Json json = readJson(metricsPath);
  const auto schema = value<std::string>(json, "schema", metricsPath);
  if (schema != kMetricsSchema) {
    throw InputError(metricsPath.string() + ": expected the schema \"" + kMetricsSchema + "\", found \"" + schema +
                     "\"");
  }
  if (json.contains("dimension") && json["dimension"] == 2) {
    throw UsageError(folder.string() + ": holds cells of a region of the plane; evaluate measures those of solids");
  }
  const auto seed = value<std::uint64_t>(json, "seed", metricsPath);
  const auto sites = value<Index>(member(json, "counts", metricsPath), "sites", metricsPath);
  auto known = value<std::vector<std::string>>(json, "warnings", metricsPath);
  const auto digests = value<std::map<std::string, std::string>>(json, "sha256", metricsPath);
  checkOutputFolder(folder);

  Evaluation result;
  const RunContext recording = recordWarnings(context, result.warnings);
  std::vector<std::string> names;
  for (const auto& [name, digest] : member(json, "sha256", metricsPath).items()) {
    names.push_back(name);
    if (sha256OfFile(folder / name) != digests.at(name)) recording.warn(name + kChangedFile);
  }
  const Form form = formOfResults(folder, json, metricsPath, recording);
  result.complex = mesh::readCellsVtu(folder / kCellsFile);
  const Stopwatch watch;
  result.measurement = measure(result.complex, form, seed, recording);
  result.accuracy = measureAccuracy(result.complex, form, result.measurement, seed, recording);
  const double secondsMetrics = watch.seconds();
  result.hasCloud = form.record.points.has_value();

  json["threads"] = context.threads;
  json["counts"] = countsJson(result.complex, result.measurement, sites);
  json["validity"] = validityJson(result.measurement.certificate);
  setMeasuredFidelity(member(json, "fidelity", metricsPath), result.measurement.fidelity, result.hasCloud);
  json["regularity"] = regularityJson(result.measurement.regularity);
  json["accuracy"] = accuracyJson(result.accuracy);
  Json& seconds = member(json, "seconds", metricsPath);
  seconds["total"] =
      value<double>(seconds, "total", metricsPath) - value<double>(seconds, "metrics", metricsPath) + secondsMetrics;
  seconds["metrics"] = secondsMetrics;
  json["peak_memory_bytes"] = peakMemoryBytes();
  for (const std::string& warning : result.warnings) appendNew(known, warning);
  json["warnings"] = known;
  json["sha256"] = filesJson(folder, names);
  context.throwIfCancelled();
  ArtifactStore store(folder);
  store.put(kMetricsFile, [&](const fs::path& path) { writeJson(path, json); });
  store.commit();
  return result;
}

}  // namespace voroform::pipeline
