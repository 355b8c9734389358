// The command line's options: one list, from which flags, help and the keys of configuration files come.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "voroform/pipeline/compare.hpp"
#include "voroform/pipeline/form.hpp"
#include "voroform/pipeline/tessellation.hpp"

namespace voroform::cli {

// What the options set; the defaults stand in the help.
struct Settings {
  // Common to all commands.
  int threads = 0;
  std::uint64_t seed = 0;
  bool quiet = false;
  bool verbose = false;
  std::string logFile;
  std::string configFile;

  std::string input;
  std::string output;
  std::string as = "auto";
  std::string envelope = "box";
  double margin = 0.02;
  std::string implicit = "auto";
  Index samples = 100000;
  std::optional<std::uint64_t> rotationSeed;

  std::string method = "cvt4";
  bool fit = false;
  bool fitBaselines = false;
  bool accuracySamples = false;
  Index sites = 15000;
  int iterations = 10;
  std::string initialization = "random";  // or a file of sites
  std::optional<int> subdivisions;
  std::string subdivisionRule = "matched";
  std::string optimizer = "lbfgs";
  int perturbations = 200;
  double convergence = 5e-4;
  double gradientTolerance = 0;
  std::string density = "constant";
  double densityRatio = cvt::DensityOptions().ratio;
  double densityWidth = 0;
  std::string rootFinder = "itp";
  double relativeError = 0;
  std::string formats;
  std::uint64_t memoryLimit = 0;
  bool noAccuracy = false;

  Index resolution = 50;
  std::string methods;  // empty: all
  int lloydIterations = 10;
  int odtIterations = 0;
  bool perturb = false;
  bool exude = false;
  double delaunayTimeLimit = 0;
  bool noEqualTriangles = false;
  bool noDual = false;
  bool noRotation = false;

  std::vector<std::string> inputs;
  std::string experiment;
  std::string data = "data";
  bool keepTessellations = false;
  std::string table;
  std::string dataSets;
  std::string ranking;
  std::optional<int> mostIterations;  // of reproduce: each table has its own default
  int seeds = 10;

  bool json = false;
};

void addCommonOptions(CLI::App& command, Settings& settings);
void addOutputOption(CLI::App& command, Settings& settings, const std::string& description);
void addInputKindOption(CLI::App& command, Settings& settings);
void addFormOptions(CLI::App& command, Settings& settings);
void addTessellationOptions(CLI::App& command, Settings& settings);
// Of commands that run several methods.
void addCompareOptions(CLI::App& command, Settings& settings);
// What compare has and rank has not.
void addSingleComparisonOptions(CLI::App& command, Settings& settings);
void addRankOptions(CLI::App& command, Settings& settings);
void addReproduceOptions(CLI::App& command, Settings& settings);

// Threads that a run will use: the number asked for, or the machine's.
int effectiveThreads(const Settings& settings);
pipeline::FormOptions formOptions(const Settings& settings);
// Whether the input is a form on disk, or a named shape.
bool isForm(const std::string& input);
bool isShape(const std::string& input);
// Throws UsageError if an option was given that the input, a form or a shape, leaves no choice of.
void requireFormOptions(const Settings& settings, const CLI::App& command);
// Throws UsageError if an option was given that has no meaning for the form that was made: an envelope for the signed
// distance to a mesh, which is closed; a number of samples for anything but a mesh's Poisson form.
void requireMeaning(const pipeline::Form& form, const CLI::App& command);
pipeline::WriteOptions writeOptions(const Settings& settings);
pipeline::CompareOptions compareOptions(const Settings& settings);

}  // namespace voroform::cli
