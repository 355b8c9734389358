// Comparisons of many inputs, and the methods' ranks in them (thesis figure 5.7).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/pipeline/compare.hpp"
#include "voroform/pipeline/experiment.hpp"
#include "voroform/pipeline/form.hpp"
#include "voroform/pipeline/rank_statistics.hpp"

namespace voroform::pipeline {

struct RankOptions {
  Experiment experiment;
  FormOptions form;        // but for the implicit kind of meshes and the rotation, which the experiment gives
  CompareOptions compare;  // but for methods, resolution, iterations, equal triangles, time limit and seed, likewise
  // Keep every method's cells and surface, and the form; else only the comparisons' tables.
  bool keepTessellations = false;
};

// What one method achieved on one input; NaN where there is nothing to tell.
struct RankedOutcome {
  std::string method;
  std::string failure;  // empty if the method finished
  std::string matched;  // in the comparison at equal triangles: the CVT whose number of triangles was aimed at
  double dmean = 0;
  double drmse = 0;
  double nmean = 0;
  double nrmse = 0;
  double gmean = 0;  // of methods with compact cells: not of Delaunay refinement
  double gmax = 0;
  double seconds = 0;
  std::int64_t cells = 0;
  std::int64_t boundaryTriangles = 0;
  bool valid = false;  // its certificate
};

// One input at one resolution with one seed.
struct RankedRun {
  ExperimentInput input;
  Index resolution = 0;
  std::uint64_t seed = 0;
  std::string folder;    // of its comparison, relative to the output folder
  std::string sha256;    // of the input's file; empty for a shape
  std::string failure;   // why there is no comparison; empty if there is one
  bool resumed = false;  // taken from an earlier run
  Index sites = 0;
  std::vector<RankedOutcome> outcomes;        // at the thesis's rule
  std::vector<RankedOutcome> equalTriangles;  // Marching Cubes and Delaunay refinement run finer
};

struct RankedMethod {
  std::string method;
  PairedRatio ratio;  // to mc
};

struct CriterionRanking {
  std::string criterion;  // one of rankedCriteria()
  std::vector<RankedMethod> methods;
  CriterionTable values;  // [input][method]: the median over the seeds
  RankSummary summary;
};

// The ranks of a group's inputs at one resolution, under one rule of comparison.
struct RankingTable {
  std::string rule;  // kEqualResolution, or "equal triangles, cvt2" and so on
  std::string group;
  Index resolution = 0;
  std::vector<std::string> inputs;  // names; those that failed altogether are left out
  std::vector<CriterionRanking> criteria;
};
inline constexpr const char* kEqualResolution = "equal resolution";

struct Rankings {
  Experiment experiment;
  std::vector<RankedRun> runs;
  std::vector<RankingTable> tables;
  std::size_t failedRuns() const;
  // Tessellations by a CVT that fail their certificate: a fault of ours, where a baseline's is a finding.
  std::size_t invalidTessellations() const;
};

// dmean, drmse, nmean, nrmse, gmean, gmax, seconds.
const std::vector<std::string>& rankedCriteria();

// The tables of runs: for each resolution and group one at equal resolution, and one for each CVT that was compared at
// equal triangles. Tables without at least one input and two methods are left out.
std::vector<RankingTable> rankingTables(const Experiment& experiment, const std::vector<RankedRun>& runs);

// Compares all inputs, each in folder/<name> (below it r<resolution>-s<seed> if the experiment has several), and ranks.
// A run that an earlier call finished with the same input, options and version is taken as it is. What fails is
// recorded, and the others go on. Inputs that do not exist are found before the first run: InputError. Throws
// UsageError, EnvironmentError and Cancelled.
Rankings rank(const RankOptions& options, const std::filesystem::path& folder, const RunContext& context);

// Writes rankings.json, .csv, .md and .svg: all of them or none. Returns their names.
std::vector<std::string> writeRankings(const Rankings& rankings, const std::filesystem::path& folder);
// Reads rankings.json, the runs of it; the tables are made anew. Throws InputError.
Rankings readRankings(const std::filesystem::path& folder);

}  // namespace voroform::pipeline
