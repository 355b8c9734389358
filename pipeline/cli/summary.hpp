// The summaries that commands print on the standard output stream.
#pragma once

#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "voroform/pipeline/form.hpp"
#include "voroform/pipeline/planar.hpp"
#include "voroform/pipeline/tessellation.hpp"

namespace voroform::cli {

void printPoints(std::ostream& out, const points::PrepareSummary& summary);
void printForm(std::ostream& out, const pipeline::FormRecord& record);
void printOptimization(std::ostream& out, const cvt::OptimizeSummary& summary);
void printMeasurement(std::ostream& out, const mesh::PolyhedralComplex& complex,
                      const pipeline::Measurement& measurement, bool hasCloud);
void printPlanar(std::ostream& out, const pipeline::PlanarInput& input, const pipeline::PlanarResult& result);
// Nothing if there is none.
void printAccuracy(std::ostream& out, const std::optional<metrics::Accuracy>& accuracy);
void printFiles(std::ostream& out, const std::filesystem::path& folder, const std::vector<std::string>& names);

}  // namespace voroform::cli
