#include <cstdio>
#include <iostream>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "summary.hpp"
#include "voroform/core/error.hpp"
#include "voroform/mesh/read_mesh.hpp"
#include "voroform/pipeline/compare.hpp"

namespace voroform::cli {

namespace {

// Marching Cubes is exact on planes along its grid, and shapes and meshes often lie along the axes; scans do not.
pipeline::FormOptions comparedFormOptions(const Settings& settings, const RunContext& context) {
  pipeline::FormOptions options = formOptions(settings);
  if (options.rotationSeed && settings.noRotation) {
    throw UsageError("--no-rotation contradicts --rotation-seed");
  }
  if (settings.noRotation || options.rotationSeed || isForm(settings.input)) return options;
  const bool isMesh = !isShape(settings.input) && options.inputKind != pipeline::InputKind::points &&
                      (options.inputKind == pipeline::InputKind::mesh || mesh::holdsFaces(settings.input, context));
  if (isMesh || isShape(settings.input)) options.rotationSeed = settings.seed;
  return options;
}

template <class... Values>
void printLine(const char* format, Values... values) {
  char line[512];
  std::snprintf(line, sizeof line, format, values...);
  std::cout << line << '\n';
}

void printOutcome(const pipeline::MethodOutcome& outcome, const metrics::Accuracy* reference) {
  if (!outcome.failure.empty()) {
    std::cout << outcome.method << ": " << outcome.failure << '\n';
    return;
  }
  const metrics::Accuracy accuracy = outcome.accuracy.value_or(metrics::Accuracy());
  const metrics::RegularityStatistics& regularity = outcome.measurement.regularity.all;
  printLine("%-9s %10.4g %8.4g %10.4g %8.4g %8.4g %8.4g %8.4g %8lld %9lld %8.3g  %s", outcome.method.c_str(),
            accuracy.dmean, reference != nullptr ? accuracy.dmean / reference->dmean : 0.0, accuracy.drmse,
            accuracy.nmean, accuracy.nrmse, regularity.mean, regularity.max, static_cast<long long>(outcome.cells),
            static_cast<long long>(outcome.boundaryTriangles), outcome.seconds,
            outcome.measurement.certificate.valid ? "valid" : "INVALID");
}

void printComparison(const pipeline::Comparison& comparison) {
  printLine("resolution: %lld sites, cube edge %.4g, cell size h %.4g; %lld samples on the surface",
            static_cast<long long>(comparison.sites), comparison.grid.edge, comparison.cellSize,
            static_cast<long long>(comparison.samples));
  printLine("%-9s %10s %8s %10s %8s %8s %8s %8s %8s %9s %8s", "method", "Dmean", "/ mc", "Drmse", "Nmean", "Nrmse",
            "Gmean", "Gmax", "cells", "triangles", "seconds");
  const metrics::Accuracy* reference = nullptr;
  for (const pipeline::MethodOutcome& outcome : comparison.methods) {
    if (outcome.method == "mc" && outcome.accuracy) reference = &*outcome.accuracy;
  }
  for (const pipeline::MethodOutcome& outcome : comparison.methods) printOutcome(outcome, reference);
  printLine("seconds: evaluation %.3g, all %.3g", comparison.secondsEvaluation, comparison.secondsTotal);
}

}  // namespace

int runCompare(const Settings& settings, const CLI::App& command, const RunContext& context) {
  const pipeline::CompareOptions options = compareOptions(settings);
  if (const auto violations = pipeline::validate(options); !violations.empty()) throw UsageError(violations.front());
  requireFormOptions(settings, command);
  pipeline::checkOutputFolder(settings.output);
  const pipeline::Form form = pipeline::formFromInput(settings.input, comparedFormOptions(settings, context), context);
  requireMeaning(form, command);
  const pipeline::Comparison comparison = pipeline::compare(form, options, context);
  const std::vector<std::string> names = pipeline::writeComparison(form, comparison, settings.output, context);
  if (!settings.quiet) {
    printForm(std::cout, form.record);
    printComparison(comparison);
    printFiles(std::cout, settings.output, names);
  }
  // A baseline that fails its certificate is a finding; a tessellation of ours is a fault.
  for (const pipeline::MethodOutcome& outcome : comparison.methods) {
    if (outcome.method.starts_with("cvt") && outcome.failure.empty() && !outcome.measurement.certificate.valid) {
      throw MethodError(
          settings.output + "/" + outcome.method +
          ": the tessellation fails its certificate of validity; another --resolution or --seed may help");
    }
  }
  return kExitDone;
}

}  // namespace voroform::cli
