// The command-line program: parses the options, runs one command and maps what went wrong to an exit code.
#include <csignal>
#include <cstdio>
#include <functional>
#include <iostream>
#include <memory>
#include <new>
#include <optional>
#include <vector>

#include "captured_stream.hpp"
#include "commands.hpp"
#include "config_file.hpp"
#include "console.hpp"
#include "exit_codes.hpp"
#include "planar.hpp"
#include "signals.hpp"
#include "voroform/core/error.hpp"

namespace voroform::cli {
namespace {

using Run = int (*)(const Settings&, const CLI::App&, const RunContext&);

struct Command {
  CLI::App* app;
  Run run;
  bool takesRegions = false;  // of the plane, as inputs
};

constexpr const char* kPointsHelp = "A point cloud (.ply .xyz .xyzn .pwn .txt .pcd .off)";
constexpr const char* kInputHelp =
    "A point cloud (.ply .xyz .xyzn .pwn .txt .pcd .off), a closed mesh (.off .obj .ply .stl)";

CLI::App* addCommand(CLI::App& app, Settings& settings, const std::string& name, const std::string& description,
                     const std::string& input, const std::string& inputDescription) {
  CLI::App* command = app.add_subcommand(name, description);
  command->add_option(input, settings.input, inputDescription)->required();
  return command;
}

std::vector<Command> addCommands(CLI::App& app, Settings& settings) {
  std::vector<Command> commands;

  CLI::App* reconstruct = addCommand(app, settings, "reconstruct", "From points or a mesh to a measured tessellation",
                                     "INPUT", std::string(kInputHelp) + ", or shape:NAME");
  addOutputOption(*reconstruct, settings, "Folder for the results");
  addFormOptions(*reconstruct, settings);
  addTessellationOptions(*reconstruct, settings);
  commands.push_back({reconstruct, runReconstruct});

  CLI::App* points = addCommand(app, settings, "points", "Read, clean and orient a point cloud", "INPUT", kPointsHelp);
  addOutputOption(*points, settings, "The .ply file to write");
  addInputKindOption(*points, settings);
  commands.push_back({points, runPoints});

  CLI::App* implicit =
      addCommand(app, settings, "implicit", "Make an implicit form of points or a mesh", "INPUT", kInputHelp);
  addOutputOption(*implicit, settings, "Folder for the form's files");
  addFormOptions(*implicit, settings);
  commands.push_back({implicit, runImplicit});

  CLI::App* tessellate =
      addCommand(app, settings, "tessellate", "Cells from a form, points or a shape, measured", "INPUT",
                 "A form (form.vtu, form.ply), shape:NAME, or a cloud or mesh as for reconstruct; or a region of the "
                 "plane: shape2d:NAME, or a file of polygons (.wkt .xy)");
  addOutputOption(*tessellate, settings, "Folder for the results");
  addFormOptions(*tessellate, settings);
  addTessellationOptions(*tessellate, settings);
  commands.push_back({tessellate, runTessellate, true});

  CLI::App* evaluate = addCommand(app, settings, "evaluate", "Measure a results folder's cells anew", "DIR",
                                  "Folder that reconstruct or tessellate wrote");
  commands.push_back({evaluate, runEvaluate});

  CLI::App* compare = addCommand(app, settings, "compare",
                                 "Marching Cubes, Delaunay refinement and the CVTs on one input, measured alike",
                                 "INPUT", "As for tessellate");
  addOutputOption(*compare, settings, "Folder for the results");
  addFormOptions(*compare, settings);
  addCompareOptions(*compare, settings);
  addSingleComparisonOptions(*compare, settings);
  commands.push_back({compare, runCompare});

  CLI::App* rank = app.add_subcommand("rank", "Compare the methods on many inputs and rank them");
  addRankOptions(*rank, settings);
  commands.push_back({rank, runRank});

  CLI::App* reproduce = app.add_subcommand("reproduce", "One of the thesis's tables, its figures beside ours");
  addReproduceOptions(*reproduce, settings);
  commands.push_back({reproduce, runReproduce});

  CLI::App* info = addCommand(app, settings, "info", "What a file is, its size, its validity", "FILE",
                              "A point cloud, a mesh, a form (.vtu), cells (.vtu) or a region of the plane (.wkt .xy)");
  info->add_flag("--json", settings.json, "Print JSON");
  commands.push_back({info, runInfo, true});

  for (const Command& command : commands) addCommonOptions(*command.app, settings);
  return commands;
}

// Runs the work and gives its exit code; `report` receives the message of what went wrong.
int exitCodeOf(const std::function<int()>& work, const std::function<void(const std::string&)>& report) {
  try {
    return work();
  } catch (const UsageError& error) {
    report(error.what());
    return kExitUsage;
  } catch (const InputError& error) {
    report(error.what());
    return kExitInput;
  } catch (const MethodError& error) {
    report(error.what());
    return kExitMethod;
  } catch (const EnvironmentError& error) {
    report(error.what());
    return kExitEnvironment;
  } catch (const Cancelled&) {
    report("interrupted");
    return kExitInterrupted;
  } catch (const std::bad_alloc&) {
    report("not enough memory");
    return kExitEnvironment;
  } catch (const std::exception& error) {
    report(std::string("unexpected failure: ") + error.what());
    return kExitMethod;
  }
}

void printError(const std::string& message) { std::fprintf(stderr, "voroform: error: %s\n", message.c_str()); }

void flushOutput() {
  std::cout.flush();
  if (!std::cout) throw EnvironmentError("cannot write to the standard output");
}

// Help and the version are asked for; all else is a mistake in the arguments. Gives the exit code.
int answer(const CLI::App& app, const CLI::ParseError& problem) {
  if (problem.get_exit_code() == 0) {
    app.exit(problem);
    return exitCodeOf(
        [] {
          flushOutput();
          return kExitDone;
        },
        printError);
  }
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const std::vector<std::string> unknown = app.remaining();
  if (chosen.empty() && !unknown.empty()) {
    printError("unknown command or option: " + unknown.front() + "; see voroform --help for the commands");
  } else {
    const std::string command = chosen.empty() ? "" : " " + chosen.front()->get_name();
    printError(std::string(problem.what()) + "; see voroform" + command + " --help");
  }
  return kExitUsage;
}

int runCommand(const Command& command, Settings& settings, const SignalWatch& signals) {
  std::optional<Console> console;
  const auto report = [&console](const std::string& message) {
    if (console) {
      console->error(message);
    } else {
      printError(message);
    }
  };
  return exitCodeOf(
      [&] {
        if (!settings.configFile.empty()) applyConfigFile(*command.app, settings.configFile);
        if (command.app->get_option_no_throw("--output") != nullptr && settings.output.empty()) {
          throw UsageError("--output is required; see voroform " + command.app->get_name() + " --help");
        }
        if (!command.takesRegions) refuseRegions(settings, command.app->get_name());
        console.emplace(settings);
        const RunContext context = console->context(signals.cancelled(), effectiveThreads(settings));
        const CapturedStream libraries(std::cerr, [&context](std::string_view line) { context.debug(line); });
        const int code = command.run(settings, *command.app, context);
        flushOutput();
        console->closeLog();
        return code;
      },
      report);
}

int run(int argc, char** argv) {
  // A write beyond the file size limit shall fail like one to a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  const SignalWatch signals;

  Settings settings;
  CLI::App app("Turns oriented point clouds into clipped centroidal Voronoi tessellations", "voroform");
  app.set_version_flag("--version", std::string("voroform ") + VOROFORM_VERSION);
  app.require_subcommand(1);
  const std::vector<Command> commands = addCommands(app, settings);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& problem) {
    return answer(app, problem);
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) return runCommand(command, settings, signals);
  }
  return kExitUsage;
}

}  // namespace
}  // namespace voroform::cli

int main(int argc, char** argv) {
  try {
    return voroform::cli::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "voroform: error: %s\n", error.what());
    return voroform::cli::kExitEnvironment;
  }
}
