#include "planar.hpp"

#include <iostream>

#include "exit_codes.hpp"
#include "site_options.hpp"
#include "summary.hpp"
#include "voroform/core/error.hpp"
#include "voroform/pipeline/planar.hpp"

namespace voroform::cli {

namespace {

constexpr const char* kOptionsOfSolids[] = {"--as",          "--envelope",      "--margin",     "--implicit",
                                            "--samples",     "--rotation-seed", "--method",     "--fit",
                                            "--root-finder", "--formats",       "--no-accuracy"};

pipeline::PlanarOptions planarOptions(const Settings& settings, const mesh::PlanarRegion& region,
                                      const RunContext& context) {
  pipeline::PlanarOptions options;
  static_cast<cvt::SiteOptions&>(options) = siteOptions(settings);
  options.density = densityOptions(settings);
  options.memoryLimit = settings.memoryLimit;
  if (options.initialization == cvt::Initialization::given) {
    options.given = pipeline::readPlanarSites(settings.initialization, region, context);
    options.sites = static_cast<Index>(options.given.size());
  }
  return options;
}

}  // namespace

int tessellatePlanar(const Settings& settings, const CLI::App& command, const RunContext& context) {
  for (const char* name : kOptionsOfSolids) {
    if (command.get_option(name)->count() > 0) {
      throw UsageError(std::string(name) + ": has no meaning for " + settings.input + ", a region of the plane");
    }
  }
  requireSiteOptions(settings, command);
  pipeline::checkOutputFolder(settings.output);
  const pipeline::PlanarInput input = pipeline::planarFromInput(settings.input, context);
  pipeline::PlanarWriteOptions options;
  options.tessellate = planarOptions(settings, input.region, context);
  options.threads = effectiveThreads(settings);
  const pipeline::PlanarResult result = pipeline::tessellatePlanar(input, options.tessellate, context);
  const std::vector<std::string> names = pipeline::writePlanarResults(input, result, options, settings.output, context);
  if (!settings.quiet) {
    printPlanar(std::cout, input, result);
    printFiles(std::cout, settings.output, names);
  }
  if (!result.measurement.certificate.valid) {
    throw MethodError(settings.output +
                      ": the tessellation fails its certificate of validity; its files are for examination only; "
                      "another number of sites or --seed may help");
  }
  return kExitDone;
}

void refuseRegions(const Settings& settings, const std::string& command) {
  std::vector<std::string> inputs = settings.inputs;
  inputs.push_back(settings.input);
  for (const std::string& input : inputs) {
    if (pipeline::isPlanarInput(input)) {
      throw UsageError(input + ": is a region of the plane; " + command +
                       " is for solids, of regions only tessellate makes cells");
    }
  }
}

}  // namespace voroform::cli
