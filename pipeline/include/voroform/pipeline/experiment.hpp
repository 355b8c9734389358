// Experiments as files: inputs, methods, resolutions and seeds that `rank` runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "voroform/core/types.hpp"

namespace voroform::pipeline {

struct ExperimentInput {
  std::string input;          // a path, or shape:NAME
  std::string name;           // names its results folder; unique in the experiment
  std::string group = "all";  // inputs are ranked by group
};

struct Experiment {
  std::string name = "experiment";
  std::vector<ExperimentInput> inputs;
  std::vector<std::string> methods;        // of methodNames()
  std::vector<Index> resolutions = {50};   // ranked apart
  std::vector<std::uint64_t> seeds = {0};  // of an input the median over the seeds is ranked
  int iterations = 10;                     // of the CVT's optimization
  bool equalTriangles = true;              // also compare at equal numbers of boundary triangles
  double delaunayTimeLimit = 0;            // seconds; 0: none
  // How meshes become functions, "distance" or "poisson". Clouds are always fitted by Poisson.
  std::string implicit = "distance";
  bool rotate = true;  // shapes and meshes, by a rotation drawn from the seed
};

// Every violation, as sentences naming field, value and rule; empty if there is none.
std::vector<std::string> validate(const Experiment& experiment);

// Gives inputs without a name one: the shape's name, or the file's without its extension; with it where two files
// differ in nothing else. Throws UsageError if two inputs end up with the same name.
void nameInputs(std::vector<ExperimentInput>& inputs);

// A TOML file with the keys name, methods, resolutions, seeds, iterations, equal-triangles, delaunay-time-limit,
// implicit, rotate, and one [[input]] an input with either file (relative to the folder `data`) or shape, and
// optionally name and group. Throws UsageError naming the file, the line and the key that is unknown or has a bad
// value.
Experiment parseExperiment(std::string_view text, const std::string& fileName, const std::filesystem::path& data);
Experiment readExperiment(const std::filesystem::path& path, const std::filesystem::path& data);

}  // namespace voroform::pipeline
