#include <filesystem>
#include <iostream>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "summary.hpp"
#include "voroform/core/error.hpp"
#include "voroform/points/read.hpp"

namespace voroform::cli {

int runPoints(const Settings& settings, const CLI::App&, const RunContext& context) {
  const std::filesystem::path output = settings.output;
  if (output.extension() != ".ply") throw UsageError("--output: " + settings.output + " does not end in .ply");
  const std::filesystem::path folder = output.has_parent_path() ? output.parent_path() : ".";
  pipeline::checkOutputFolder(folder);
  const pipeline::PreparedPoints loaded = pipeline::loadPoints(settings.input, formOptions(settings), context);
  pipeline::ArtifactStore store(folder);
  store.put(output.filename().string(),
            [&](const std::filesystem::path& path) { points::writePointsPly(path, loaded.prepared.cloud); });
  context.throwIfCancelled();
  store.commit();
  if (!settings.quiet) {
    std::cout << "input: " << loaded.input.format << '\n';
    printPoints(std::cout, loaded.prepared.summary);
    printFiles(std::cout, folder, store.names());
  }
  return kExitDone;
}

int runImplicit(const Settings& settings, const CLI::App& command, const RunContext& context) {
  if (settings.input.starts_with("shape:")) {
    throw UsageError(settings.input +
                     ": implicit makes a form of points or a mesh; tessellate takes the shape as it is");
  }
  if (std::filesystem::path(settings.input).extension() == ".vtu" || pipeline::isStoredMeshForm(settings.input)) {
    throw UsageError(settings.input + ": is a form already");
  }
  pipeline::checkOutputFolder(settings.output);
  const pipeline::Form form = pipeline::formFromInput(settings.input, formOptions(settings), context);
  requireMeaning(form, command);
  context.report("writing", 0);
  pipeline::ArtifactStore store(settings.output);
  pipeline::writeForm(form, store);
  context.throwIfCancelled();
  store.commit();
  context.report("writing", 1);
  if (!settings.quiet) {
    printForm(std::cout, form.record);
    printFiles(std::cout, settings.output, store.names());
  }
  return kExitDone;
}

}  // namespace voroform::cli
