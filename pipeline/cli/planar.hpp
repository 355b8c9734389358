// Regions of the plane on the command line.
#pragma once

#include <string>

#include "options.hpp"
#include "voroform/core/run_context.hpp"

namespace voroform::cli {

// The command tessellate for an input that is a region. Throws UsageError for options that only solids know.
int tessellatePlanar(const Settings& settings, const CLI::App& command, const RunContext& context);

// Throws UsageError if an input is a region: for commands that are for solids only.
void refuseRegions(const Settings& settings, const std::string& command);

}  // namespace voroform::cli
