// The command line's options: one list, from which flags, help and the keys of configuration files come.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

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

  std::string method = "cvt3";
  Index sites = 15000;
  int iterations = 10;
  std::string optimizer = "lbfgs";
  std::string rootFinder = "itp";
  double relativeError = 0;
  std::string formats;
  std::uint64_t memoryLimit = 0;

  bool json = false;
};

void addCommonOptions(CLI::App& command, Settings& settings);
void addOutputOption(CLI::App& command, Settings& settings, const std::string& description);
void addInputKindOption(CLI::App& command, Settings& settings);
void addFormOptions(CLI::App& command, Settings& settings);
void addTessellationOptions(CLI::App& command, Settings& settings);

// Threads that a run will use: the number asked for, or the machine's.
int effectiveThreads(const Settings& settings);
pipeline::FormOptions formOptions(const Settings& settings);
pipeline::WriteOptions writeOptions(const Settings& settings);

}  // namespace voroform::cli
