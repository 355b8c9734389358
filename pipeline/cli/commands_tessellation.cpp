#include <iostream>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "planar.hpp"
#include "summary.hpp"
#include "voroform/core/error.hpp"

namespace voroform::cli {

namespace {

constexpr const char* kInvalid =
    "the tessellation fails its certificate of validity; its files are for examination only; another number of sites "
    "or --method cvt2 may help";

// The sites of the file that --init names, in the form's coordinates.
std::vector<Vec3> givenSites(const Settings& settings, const pipeline::Form& form, const RunContext& context) {
  if (siteOptions(settings).initialization != cvt::Initialization::given) return {};
  std::vector<Vec3> sites = pipeline::readSites(settings.initialization, context);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    sites[i] -= form.record.frame.origin;
    if (!(form.function->value(sites[i]) < 0)) {
      throw InputError(settings.initialization + ": site " + std::to_string(i + 1) + " lies outside the solid");
    }
  }
  return sites;
}

int makeResults(const pipeline::Form& form, const Settings& settings, const RunContext& context) {
  pipeline::WriteOptions options = writeOptions(settings);
  options.tessellate.given = givenSites(settings, form, context);
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
  pipeline::checkOutputFolder(settings.output);
  cvt::requireMemory(writeOptions(settings).tessellate);
  const pipeline::Form form = pipeline::formFromInput(settings.input, formOptions(settings), context);
  requireMeaning(form, command);
  return makeResults(form, settings, context);
}

int runTessellate(const Settings& settings, const CLI::App& command, const RunContext& context) {
  if (pipeline::isPlanarInput(settings.input)) return tessellatePlanar(settings, command, context);
  requireFormOptions(settings, command);
  pipeline::checkOutputFolder(settings.output);
  cvt::requireMemory(writeOptions(settings).tessellate);
  const pipeline::Form form = pipeline::formFromInput(settings.input, formOptions(settings), context);
  requireMeaning(form, command);
  return makeResults(form, settings, context);
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
