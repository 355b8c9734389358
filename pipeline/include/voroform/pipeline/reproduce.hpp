// The papers' tables, run anew: their figures beside ours.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/cvt/optimize.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::pipeline {

// A figure as the thesis prints it (eval/published/).
struct PublishedFigure {
  std::string table;
  int page = 0;
  std::string dataSet;  // of table 3.1 the polyhedron
  std::optional<Index> sites;
  std::string method;
  std::string criterion;
  double value = 0;
  std::string note;  // what had to be repaired
};

// The tables that can be reproduced: 3.1, 3.2, 4.1 to 4.7, 5.1 to 5.4 and the figures 3.8, 3.9, 4.10 and 5.7.
const std::vector<std::string>& reproducibleTables();
// All figures of a table, in print order. Throws UsageError for an unknown one.
std::vector<PublishedFigure> publishedFigures(const std::string& table);

struct ReproduceOptions {
  std::string table;
  std::filesystem::path data = "data";  // where datasets-scripts/ put the scans and meshes
  std::vector<std::string> dataSets;    // the thesis's names; empty: all of the table
  // At most; 10 if not given, in the tables of chapters 3 and 4 kCvtIterations.
  std::optional<int> iterations;
  // Of the tables of chapters 3 and 4: seeds from the first on, of which the median is taken where the initial sites
  // are random (thesis, section 4.1.4).
  int seeds = 10;
  double delaunayTimeLimit = 600;  // seconds; 0: none
  std::uint64_t seed = 0;
  // Figure 5.7 only: a folder that rank wrote; empty: the experiment eval/experiments/meshes.toml is run.
  std::filesystem::path ranking;
};
std::vector<std::string> validate(const ReproduceOptions& options);
inline constexpr int kCvtIterations = 1000;

struct ReproducedFigure {
  PublishedFigure published;
  double ours = std::numeric_limits<double>::quiet_NaN();  // in the published figure's units
  std::string failure;                                     // why there is none
  // Of the seeds whose median ours is; NaN where there is one.
  double lowest = std::numeric_limits<double>::quiet_NaN();
  double highest = std::numeric_limits<double>::quiet_NaN();
  // Relative to Marching Cubes on the same data; NaN where there is nothing to compare with.
  double publishedRatio = std::numeric_limits<double>::quiet_NaN();
  double ourRatio = std::numeric_limits<double>::quiet_NaN();
};

// What was run in place of a data set of the thesis that cannot be had.
struct StandIn {
  std::string dataSet;
  std::string input;
  std::optional<Index> publishedSites;
  Index resolution = 0;
  Index sites = 0;
};

// How energy and regularity fell in one run.
struct Curve {
  std::string name;
  double optimalRegularity = 0;  // G_m
  double optimalEnergy = 0;      // E_m
  std::vector<cvt::IterationRecord> iterations;
};

struct Reproduction {
  ReproduceOptions options;
  std::vector<StandIn> standIns;
  std::vector<Curve> curves;  // of the first seed
  std::vector<ReproducedFigure> figures;
  std::vector<std::string> remarks;
  double seconds = 0;
};

// Runs what the table needs. Files of the run, if there are any, go to the folder. Throws UsageError, InputError (data
// that is missing), MethodError, EnvironmentError, Cancelled.
Reproduction reproduce(const ReproduceOptions& options, const std::filesystem::path& folder, const RunContext& context);

// Writes reproduce.json, .csv and .md, and the curves if there are any (curves.csv, curves.svg): all of them or none.
// Returns their names.
std::vector<std::string> writeReproduction(const Reproduction& reproduction, const std::filesystem::path& folder);
std::string reproductionMarkdown(const Reproduction& reproduction);

// The resolution in [4, 1000] at which the number of cubes with an inside center is nearest to `sites`. Takes the
// form's box once and counts a few times.
Index resolutionFor(const implicit::ImplicitFunction& f, Index sites, const RunContext& context);

// G of a body of table 3.1 by its name, from the moments of its cell; the sphere is a fine geodesic polyhedron. Throws
// UsageError for an unknown name.
double regularityOfBody(const std::string& name);

}  // namespace voroform::pipeline
