// The options of sites by their names, and sites from files.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/cvt/optimized_sites.hpp"

namespace voroform::pipeline {

// Names as they stand on the command line and in metrics.json; "given" is the name of sites from a file.
std::vector<std::string> optimizerNames();
const char* toString(cvt::Optimizer optimizer);
// Throws UsageError for an unknown name.
cvt::Optimizer optimizerNamed(const std::string& name);

std::vector<std::string> initializationNames();  // without given
const char* toString(cvt::Initialization initialization);
std::optional<cvt::Initialization> initializationNamed(const std::string& name);

// Points of a file of any format that clouds have, as sites in the input's coordinates. Throws InputError, naming the
// file; of a site that is not finite or stands twice also the records.
std::vector<Vec3> readSites(const std::filesystem::path& path, const RunContext& context);

}  // namespace voroform::pipeline
