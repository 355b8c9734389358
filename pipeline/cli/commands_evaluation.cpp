// rank and reproduce.
#include <iostream>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "summary.hpp"
#include "validators.hpp"
#include "voroform/core/error.hpp"
#include "voroform/pipeline/rank.hpp"
#include "voroform/pipeline/reproduce.hpp"

namespace voroform::cli {

namespace {

bool isGiven(const CLI::App& command, const char* option) { return command.get_option(option)->count() > 0; }

// What the command line sets comes before the experiment's file.
pipeline::Experiment experimentOf(const Settings& settings, const CLI::App& command) {
  const bool fromFile = !settings.experiment.empty();
  if (fromFile && !settings.inputs.empty()) {
    throw UsageError(settings.inputs.front() + ": inputs stand in the experiment's file, or on the command line");
  }
  if (!fromFile && settings.inputs.empty()) throw UsageError("rank needs inputs, or an --experiment; see --help");
  if (!fromFile && isGiven(command, "--data")) throw UsageError("--data: has no meaning without --experiment");
  pipeline::Experiment experiment;
  if (fromFile) {
    experiment = pipeline::readExperiment(settings.experiment, settings.data);
  } else {
    for (const std::string& input : settings.inputs) experiment.inputs.push_back({input, "", "all"});
    pipeline::nameInputs(experiment.inputs);
    experiment.name = "inputs of the command line";
  }
  const auto comesFirst = [&](const char* option) { return !fromFile || isGiven(command, option); };
  const pipeline::CompareOptions compare = compareOptions(settings);
  if (comesFirst("--methods")) experiment.methods = compare.methods;
  if (comesFirst("--resolution")) experiment.resolutions = {compare.resolution};
  if (comesFirst("--seed")) experiment.seeds = {settings.seed};
  if (comesFirst("--iterations")) experiment.iterations = compare.iterations;
  if (comesFirst("--delaunay-time-limit")) experiment.delaunayTimeLimit = compare.delaunayTimeLimit;
  if (comesFirst("--no-equal-triangles")) experiment.equalTriangles = compare.equalTriangles;
  if (comesFirst("--no-rotation")) experiment.rotate = !settings.noRotation;
  if (comesFirst("--implicit")) experiment.implicit = settings.implicit == "poisson" ? "poisson" : "distance";
  return experiment;
}

// The mean ranks, best first, of each table.
void printRankings(std::ostream& out, const pipeline::Rankings& rankings) {
  for (const pipeline::RankingTable& table : rankings.tables) {
    out << "at " << table.rule << ", group " << table.group << ", resolution " << table.resolution << ", "
        << table.inputs.size() << " inputs:\n";
    for (const pipeline::CriterionRanking& ranking : table.criteria) {
      out << "  " << ranking.criterion << ":";
      for (std::size_t j = 0; j < ranking.methods.size(); ++j) {
        out << (j == 0 ? " " : ", ") << ranking.methods[j].method << " first on " << ranking.summary.counts[j].front()
            << " (mean rank " << ranking.summary.meanRanks[j] << ")";
      }
      out << '\n';
    }
  }
}

}  // namespace

int runRank(const Settings& settings, const CLI::App& command, const RunContext& context) {
  if (isGiven(command, "--rotation-seed")) {
    throw UsageError("--rotation-seed: rank turns by the seed itself; use --seed or --no-rotation");
  }
  pipeline::RankOptions options;
  options.experiment = experimentOf(settings, command);
  options.form = formOptions(settings);
  options.compare = compareOptions(settings);
  options.keepTessellations = settings.keepTessellations;
  const pipeline::Rankings rankings = pipeline::rank(options, settings.output, context);
  const std::vector<std::string> names = pipeline::writeRankings(rankings, settings.output);
  if (!settings.quiet) {
    printRankings(std::cout, rankings);
    printFiles(std::cout, settings.output, names);
  }
  if (const std::size_t failed = rankings.failedRuns(); failed > 0) {
    throw MethodError(settings.output + ": " + std::to_string(failed) + " of " + std::to_string(rankings.runs.size()) +
                      " runs failed and are left out of the rankings, which say why; another call of rank tries them "
                      "again");
  }
  if (const std::size_t invalid = rankings.invalidTessellations(); invalid > 0) {
    throw MethodError(settings.output + ": " + std::to_string(invalid) +
                      " tessellations fail their certificate of validity; rankings.md lists them; another --resolution "
                      "or --seed may help");
  }
  return kExitDone;
}

int runReproduce(const Settings& settings, const CLI::App&, const RunContext& context) {
  pipeline::ReproduceOptions options;
  options.table = settings.table == "5.7" ? "figure-5.7" : settings.table;
  options.data = settings.data;
  options.dataSets = split(settings.dataSets);
  options.iterations = settings.mostIterations;
  options.seeds = settings.seeds;
  options.delaunayTimeLimit = settings.delaunayTimeLimit;
  options.seed = settings.seed;
  options.ranking = settings.ranking;
  pipeline::checkOutputFolder(settings.output);
  const pipeline::Reproduction reproduction = pipeline::reproduce(options, settings.output, context);
  const std::vector<std::string> names = pipeline::writeReproduction(reproduction, settings.output);
  if (!settings.quiet) {
    std::cout << pipeline::reproductionMarkdown(reproduction) << '\n';
    printFiles(std::cout, settings.output, names);
  }
  return kExitDone;
}

}  // namespace voroform::cli
