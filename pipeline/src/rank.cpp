#include "voroform/pipeline/rank.hpp"

#include <limits>
#include <system_error>

#include "rank_records.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/mesh/read_mesh.hpp"
#include "voroform/pipeline/sha256.hpp"

namespace voroform::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

bool isShape(const std::string& input) { return input.starts_with("shape:"); }

// A form comes as it is: fitted, closed and turned already.
bool isStoredForm(const std::string& input) {
  return fs::path(input).extension() == ".vtu" || (!isShape(input) && isStoredMeshForm(input));
}

RankedOutcome outcomeOf(const MethodOutcome& made) {
  RankedOutcome outcome;
  outcome.method = made.method;
  outcome.failure = made.failure;
  outcome.matched = made.matched;
  outcome.dmean = outcome.drmse = outcome.nmean = outcome.nrmse = kUndefined;
  outcome.gmean = outcome.gmax = outcome.seconds = kUndefined;
  if (!made.failure.empty()) return outcome;
  if (made.accuracy) {
    outcome.dmean = made.accuracy->dmean;
    outcome.drmse = made.accuracy->drmse;
    outcome.nmean = made.accuracy->nmean;
    outcome.nrmse = made.accuracy->nrmse;
  }
  // Tetrahedra are not compact by construction (thesis 5.3.4).
  if (made.method != "delaunay" && made.measurement.regularity.all.cells > 0) {
    outcome.gmean = made.measurement.regularity.all.mean;
    outcome.gmax = made.measurement.regularity.all.max;
  }
  outcome.seconds = made.seconds;
  outcome.cells = made.cells;
  outcome.boundaryTriangles = made.boundaryTriangles;
  outcome.valid = made.measurement.certificate.valid;
  return outcome;
}

// The runs to do, in order, with their folders.
std::vector<RankedRun> plannedRuns(const Experiment& experiment) {
  const bool several = experiment.resolutions.size() * experiment.seeds.size() > 1;
  std::vector<RankedRun> runs;
  for (const Index resolution : experiment.resolutions) {
    for (const std::uint64_t seed : experiment.seeds) {
      for (const ExperimentInput& input : experiment.inputs) {
        RankedRun run;
        run.input = input;
        run.resolution = resolution;
        run.seed = seed;
        run.folder = input.name;
        if (several) run.folder += "/r" + std::to_string(resolution) + "-s" + std::to_string(seed);
        runs.push_back(std::move(run));
      }
    }
  }
  return runs;
}

// Clouds are left as they stand: their envelope is parallel to the axes.
bool isTurned(const RankOptions& options, const std::string& input, const RunContext& context) {
  if (!options.experiment.rotate || isStoredForm(input)) return false;
  if (isShape(input)) return true;
  switch (options.form.inputKind) {
    case InputKind::points:
      return false;
    case InputKind::mesh:
      return true;
    case InputKind::automatic:
      break;
  }
  return mesh::holdsFaces(input, context);
}

FormOptions formOptions(const RankOptions& options, const RankedRun& run, const RunContext& context) {
  const std::string& input = run.input.input;
  FormOptions form;
  if (isStoredForm(input)) return form;
  if (!isShape(input)) {
    form = options.form;
    form.seed = run.seed;
    // Automatic is the distance for meshes and Poisson for clouds.
    form.implicitKind = options.experiment.implicit == "poisson" ? ImplicitKind::poisson : ImplicitKind::automatic;
  }
  if (isTurned(options, input, context)) form.rotationSeed = run.seed;
  return form;
}

CompareOptions compareOptions(const RankOptions& options, const RankedRun& run) {
  CompareOptions compare = options.compare;
  compare.methods = options.experiment.methods;
  compare.resolution = run.resolution;
  compare.iterations = options.experiment.iterations;
  compare.equalTriangles = options.experiment.equalTriangles;
  compare.delaunayTimeLimit = options.experiment.delaunayTimeLimit;
  compare.seed = run.seed;
  return compare;
}

// The figures of an earlier run, if its files are there and it was made from the same.
std::optional<RankedRun> earlierRun(const fs::path& folder, const Json& key, const RankOptions& options,
                                    const RankedRun& planned, const RunContext& context) {
  const fs::path record = folder / kRankedRunFile;
  const fs::path comparison = folder / kComparisonFile;
  std::error_code ignored;
  if (!fs::is_regular_file(record, ignored) || !fs::is_regular_file(comparison, ignored)) return std::nullopt;
  try {
    const Json json = readJson(record);
    if (json.value("schema", "") != kRankedRunSchema || !json.contains("key") || json.at("key") != key) {
      context.info(planned.folder + ": made with other options; run again");
      return std::nullopt;
    }
    if (options.keepTessellations && !json.value("tessellations", false)) return std::nullopt;
    if (json.value("comparison_sha256", "") != sha256OfFile(comparison)) {
      context.warn(planned.folder + ": " + kComparisonFile + " was changed after it was made; run again");
      return std::nullopt;
    }
    RankedRun run = rankedRun(json.at("run"), record.string());
    run.input = planned.input;  // its name, path and group may have changed without changing a figure
    run.folder = planned.folder;
    run.resumed = true;
    return run;
  } catch (const InputError& error) {
    context.warn(std::string(error.what()) + "; run again");
  } catch (const Json::exception&) {
    context.warn(record.string() + ": is damaged; run again");
  }
  return std::nullopt;
}

// Removes the files but for the comparison's tables, and folders that thereby become empty.
void removeTessellations(const fs::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (name.starts_with("comparison")) continue;
    std::error_code error;
    fs::remove(folder / name, error);
    if (error) throw EnvironmentError((folder / name).string() + ": cannot be removed: " + error.message());
    const fs::path parent = (folder / name).parent_path();
    if (parent != folder && fs::is_empty(parent, error)) fs::remove(parent, error);
  }
}

// Messages of a run say whose they are.
RunContext named(const RunContext& context, const std::string& name) {
  RunContext result = context;
  if (!context.log) return result;
  result.log = [log = context.log, name](LogLevel level, std::string_view message) {
    log(level, name + ": " + std::string(message));
  };
  return result;
}

void compareInput(const RankOptions& options, const fs::path& folder, const Json& key, RankedRun& run,
                  const RunContext& context) {
  // An earlier record would vouch for files that are about to change.
  std::error_code ignored;
  fs::remove(folder / kRankedRunFile, ignored);
  const Form form = formFromInput(run.input.input, formOptions(options, run, context), context);
  const Comparison comparison = compare(form, compareOptions(options, run), context);
  run.sites = comparison.sites;
  for (const MethodOutcome& outcome : comparison.methods) run.outcomes.push_back(outcomeOf(outcome));
  for (const MethodOutcome& outcome : comparison.equalTriangles) run.equalTriangles.push_back(outcomeOf(outcome));
  const std::vector<std::string> names = writeComparison(form, comparison, folder, context);
  if (!options.keepTessellations) removeTessellations(folder, names);
  ArtifactStore store(folder);
  const Json record = {{"schema", kRankedRunSchema},
                       {"key", key},
                       {"tessellations", options.keepTessellations},
                       {"comparison_sha256", sha256OfFile(folder / kComparisonFile)},
                       {"run", rankedRunJson(run)}};
  store.put(kRankedRunFile, [&](const fs::path& path) { writeJson(path, record); });
  store.commit();
}

// A wrong path is found before hours of work.
void requireInputs(const Experiment& experiment) {
  for (const ExperimentInput& input : experiment.inputs) {
    if (!isShape(input.input)) requireRegularFile(input.input);
  }
}

void throwIfInvalid(const RankOptions& options, const std::vector<RankedRun>& runs) {
  std::vector<std::string> problems = validate(options.experiment);
  if (problems.empty()) problems = validate(compareOptions(options, runs.front()));
  if (problems.empty()) problems = validate(options.form);
  if (!problems.empty()) throw UsageError(problems.front());
}

}  // namespace

Rankings rank(const RankOptions& options, const fs::path& folder, const RunContext& context) {
  std::vector<RankedRun> runs = plannedRuns(options.experiment);
  throwIfInvalid(options, runs);
  requireInputs(options.experiment);
  checkOutputFolder(folder);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    context.throwIfCancelled();
    RankedRun& run = runs[i];
    const std::string counter = std::to_string(i + 1) + " of " + std::to_string(runs.size()) + ", " + run.folder;
    try {
      if (!isShape(run.input.input)) run.sha256 = sha256OfFile(run.input.input);
      const Json key = runKeyJson(options, run);
      if (auto earlier = earlierRun(folder / run.folder, key, options, run, context)) {
        run = std::move(*earlier);
        context.info(counter + ": taken from an earlier run");
        continue;
      }
      context.info(counter + ": comparing");
      compareInput(options, folder / run.folder, key, run, named(context, run.folder));
    } catch (const Cancelled&) {
      throw;
    } catch (const EnvironmentError&) {
      throw;  // a full disk would fail all that follow
    } catch (const Error& error) {
      run.failure = error.what();
      run.outcomes.clear();
      run.equalTriangles.clear();
      context.warn(counter + ": failed: " + run.failure);
    }
  }
  Rankings rankings;
  rankings.experiment = options.experiment;
  rankings.runs = std::move(runs);
  rankings.tables = rankingTables(options.experiment, rankings.runs);
  return rankings;
}

}  // namespace voroform::pipeline
