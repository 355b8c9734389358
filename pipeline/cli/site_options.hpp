// The command line's options of sites: their number, where they come from, how they are moved, how dense they are.
#pragma once

#include <CLI/CLI.hpp>

#include "options.hpp"

namespace voroform::cli {

void addSiteOptions(CLI::App& command, Settings& settings);
// Throws UsageError if an option was given that has no meaning beside the others.
void requireSiteOptions(const Settings& settings, const CLI::App& command);

cvt::SiteOptions siteOptions(const Settings& settings);
cvt::DensityOptions densityOptions(const Settings& settings);

}  // namespace voroform::cli
