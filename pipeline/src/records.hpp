// The records that stand in form.json and metrics.json. Keys keep a fixed order; numbers are written with all digits
// that they need to be read back as the same bits.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "voroform/core/error.hpp"
#include "voroform/pipeline/form.hpp"
#include "voroform/pipeline/tessellation.hpp"

namespace voroform::pipeline {

using Json = nlohmann::ordered_json;

inline constexpr const char* kFormSchema = "voroform.form/1";
inline constexpr const char* kMetricsSchema = "voroform.metrics/1";
inline constexpr const char* kMetricsFile = "metrics.json";
inline constexpr const char* kCellsFile = "cells.vtu";

Json versionsJson();
Json inputJson(const InputRecord& input);
// The seed of the rotation that stands in the JSON of an input, if there is one. Throws InputError.
std::optional<std::uint64_t> rotationSeed(const Json& input, const std::string& name);

// form.json.
Json formJson(const FormRecord& record);
// `name` stands in messages. Throws InputError naming the key that lacks or has a wrong type.
FormRecord formRecord(const Json& json, const std::string& name);

// Parts of metrics.json that evaluate() replaces, and those that it keeps.
Json countsJson(const mesh::PolyhedralComplex& complex, const Measurement& measurement, Index sites);
Json validityJson(const mesh::Certificate& certificate);
// The part of fidelity that is measured on the complex; the rest is what only the making run knew.
void setMeasuredFidelity(Json& fidelity, const metrics::Fidelity& measured, bool hasCloud);
Json regularityJson(const metrics::Regularity& regularity);
Json siteOptionsJson(const cvt::SiteOptions& options);
Json densityJson(const cvt::DensityOptions& options);
Json energyJson(const cvt::OptimizeSummary& summary);
// The coarser levels of hierarchical sites, but for their seconds.
Json hierarchyJson(const std::vector<cvt::HierarchyLevel>& levels);
Json clippingJson(const cvt::TessellateSummary& summary);
// null if there is none.
Json accuracyJson(const std::optional<metrics::Accuracy>& accuracy);
Json metricsJson(const Form& form, const Tessellation& tessellation, const WriteOptions& options);
// Triangles of the boundary, polygons cut into fans.
std::int64_t boundaryTriangles(const mesh::PolyhedralComplex& complex);
std::uint64_t peakMemoryBytes();

// The value of a key. Throws InputError that starts with `name` and names the key if the value is of another type, or a
// whole number that a T cannot hold: the conversion of the JSON library would make a large number of -1.
template <class T>
T valueAs(const Json& value, const char* key, const std::string& name) {
  const auto error = [&](const char* fault) {
    return InputError(name + ": the key \"" + key + "\" " + fault + ": " + value.dump());
  };
  if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    if (!value.is_number_integer()) throw error("has a wrong type");
    const bool isHeld = value.is_number_unsigned() ? std::in_range<T>(value.get<std::uint64_t>())
                                                   : std::in_range<T>(value.get<std::int64_t>());
    if (!isHeld) throw error("is out of range");
  }
  try {
    return value.get<T>();
  } catch (const Json::exception&) {
    throw error("has a wrong type");
  }
}

Json readJson(const std::filesystem::path& path);  // throws InputError
void writeJson(const std::filesystem::path& path, const Json& json);

}  // namespace voroform::pipeline
