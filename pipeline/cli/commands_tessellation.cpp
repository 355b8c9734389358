#include <iostream>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "planar.hpp"
#include "site_options.hpp"
#include "summary.hpp"
#include "voroform/core/error.hpp"

namespace voroform::cli {

namespace {

constexpr const char* kInvalid =
    "the tessellation fails its certificate of validity; its files are for examination only; another number of sites "
    "or --method cvt2 may help";

// Checks the options before the input is read and its form is made, which may take long. The sites of the file that
// --init names are read for the same reason; they are in the input's coordinates.
pipeline::WriteOptions checkedOptions(const Settings& settings, const CLI::App& command, const RunContext& context) {
  requireSiteOptions(settings, command);
  pipeline::checkOutputFolder(settings.output);
  pipeline::WriteOptions options = writeOptions(settings);
  cvt::TessellateOptions& tessellate = options.tessellate;
  if (tessellate.initialization == cvt::Initialization::given) {
    tessellate.given = pipeline::readSites(settings.initialization, context);
    tessellate.sites = static_cast<Index>(tessellate.given.size());
  }
  cvt::requireMemory(tessellate);
  return options;
}

// Takes the sites to the form's coordinates.
void placeSites(std::vector<Vec3>& sites, const pipeline::Form& form, const std::string& file) {
  for (std::size_t i = 0; i < sites.size(); ++i) {
    sites[i] -= form.record.frame.origin;
    if (!(form.function->value(sites[i]) < 0)) {
      throw InputError(file + ": site " + std::to_string(i + 1) + " lies outside the solid");
    }
  }
}

int makeResults(const Settings& settings, const CLI::App& command, const RunContext& context) {
  pipeline::WriteOptions options = checkedOptions(settings, command, context);
  const pipeline::Form form = pipeline::formFromInput(settings.input, formOptions(settings), context);
  requireMeaning(form, command);
  placeSites(options.tessellate.given, form, settings.initialization);
  const pipeline::Tessellation tessellation =
      pipeline::tessellate(form, options.tessellate, context, !settings.noAccuracy);
  const std::vector<std::string> names = pipeline::writeResults(form, tessellation, options, settings.output, context);
  if (!settings.quiet) {
    printForm(std::cout, form.record);
    printOptimization(std::cout, tessellation.summary);
    printMeasurement(std::cout, tessellation.complex, tessellation.measurement, form.record.points.has_value());
    printAccuracy(std::cout, tessellation.accuracy);
    printFiles(std::cout, settings.output, names);
  }
  if (!tessellation.measurement.certificate.valid) throw MethodError(settings.output + ": " + kInvalid);
  return kExitDone;
}

}  // namespace

int runReconstruct(const Settings& settings, const CLI::App& command, const RunContext& context) {
  if (isForm(settings.input)) {
    throw UsageError(settings.input + ": reconstruct starts from points or a mesh; use tessellate for a form");
  }
  return makeResults(settings, command, context);
}

int runTessellate(const Settings& settings, const CLI::App& command, const RunContext& context) {
  if (pipeline::isPlanarInput(settings.input)) return tessellatePlanar(settings, command, context);
  requireFormOptions(settings, command);
  return makeResults(settings, command, context);
}

int runEvaluate(const Settings& settings, const CLI::App&, const RunContext& context) {
  const pipeline::Evaluation evaluation = pipeline::evaluate(settings.input, context);
  if (!settings.quiet) {
    printMeasurement(std::cout, evaluation.complex, evaluation.measurement, evaluation.hasCloud);
    printAccuracy(std::cout, evaluation.accuracy);
    printFiles(std::cout, settings.input, {"metrics.json"});
  }
  if (!evaluation.measurement.certificate.valid) throw MethodError(settings.input + ": " + kInvalid);
  return kExitDone;
}

}  // namespace voroform::cli
