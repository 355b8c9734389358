#include "voroform/pipeline/reproduce.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "embedded_files.hpp"
#include "rank_records.hpp"
#include "reproduce_cvt.hpp"
#include "voroform/baselines/cube_grid.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/pipeline/compare.hpp"
#include "voroform/pipeline/rank.hpp"

namespace voroform::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr Index kSmallestResolution = 4;
constexpr Index kLargestResolution = 1000;
// Of Marching Cubes in the thesis for all data sets but DANCER LOW (section 5.3.1.2); taken where the number of sites
// is not printed.
constexpr Index kThesisResolution = 100;
constexpr const char* kShapePrefix = "shape:";

// The data sets of the thesis are not public. In their place: the same kind of object, at the same number of sites.
struct Substitute {
  const char* dataSet;
  const char* input;
};
constexpr Substitute kSubstitutes[] = {
    {"DANCER LOW", "kitten.xyz"},  {"DANCER", "kitten.xyz"}, {"AQUARIUS", "hippo1.ply"},
    {"KNEELING LADY", "ball.ply"}, {"GARGOYLE", "oni.pwn"},  {"SKULL", "shape:torus"},
};

bool isShape(const std::string& input) { return input.starts_with(kShapePrefix); }

std::string inputFor(const std::string& dataSet, const fs::path& data) {
  for (const Substitute& substitute : kSubstitutes) {
    if (dataSet != substitute.dataSet) continue;
    return isShape(substitute.input) ? substitute.input : (data / substitute.input).string();
  }
  throw UsageError("unknown data set " + dataSet);
}

bool isWanted(const ReproduceOptions& options, const std::string& dataSet) {
  const auto& wanted = options.dataSets;
  return wanted.empty() || std::find(wanted.begin(), wanted.end(), dataSet) != wanted.end();
}

// In print order, each once.
std::vector<std::string> dataSetsOf(const std::vector<PublishedFigure>& figures) {
  std::vector<std::string> names;
  for (const PublishedFigure& figure : figures) {
    if (std::find(names.begin(), names.end(), figure.dataSet) == names.end()) names.push_back(figure.dataSet);
  }
  return names;
}

// Distances and G stand in table 5.1 times 100.
double scaleOf(const std::string& criterion) { return criterion.starts_with('N') ? 1 : 100; }

std::optional<double> qualityMean(const std::optional<metrics::QualityStatistics>& quality,
                                  const std::string& criterion) {
  if (!quality || quality->elements == 0) return std::nullopt;
  return quality->mean.at(static_cast<std::size_t>(criterion.back() - '1'));
}

// What a method achieved under a criterion's name in the tables.
std::optional<double> valueOf(const MethodOutcome& outcome, const std::string& criterion) {
  const auto accuracy = [&](double metrics::Accuracy::*member) -> std::optional<double> {
    if (!outcome.accuracy) return std::nullopt;
    return scaleOf(criterion) * ((*outcome.accuracy).*member);
  };
  if (criterion == "Dmean") return accuracy(&metrics::Accuracy::dmean);
  if (criterion == "Drmse") return accuracy(&metrics::Accuracy::drmse);
  if (criterion == "Nmean") return accuracy(&metrics::Accuracy::nmean);
  if (criterion == "Nrmse") return accuracy(&metrics::Accuracy::nrmse);
  if (criterion == "Gmax") return scaleOf(criterion) * outcome.measurement.regularity.all.max;
  if (criterion == "Gmean") return scaleOf(criterion) * outcome.measurement.regularity.all.mean;
  if (criterion == "seconds") return outcome.seconds;
  if (criterion.starts_with("VQ")) return qualityMean(outcome.tetrahedra, criterion);
  if (criterion.starts_with("SQ")) {
    // A CVT's triangles are those of its dual (thesis 5.3.4).
    return qualityMean(outcome.method == "delaunay" ? outcome.triangles : outcome.dualTriangles, criterion);
  }
  throw UsageError("unknown criterion " + criterion);
}

void fill(ReproducedFigure& figure, const Comparison& comparison) {
  for (const MethodOutcome& outcome : comparison.methods) {
    if (outcome.method != figure.published.method) continue;
    if (!outcome.failure.empty()) {
      figure.failure = outcome.failure;
    } else if (const auto value = valueOf(outcome, figure.published.criterion)) {
      figure.ours = *value;
    } else {
      figure.failure = "not measured";
    }
    return;
  }
  figure.failure = "not run";
}

// Ratios to Marching Cubes on the same data set, of the criteria that depend on its units.
void fillRatios(std::vector<ReproducedFigure>& figures) {
  for (ReproducedFigure& figure : figures) {
    for (const ReproducedFigure& reference : figures) {
      if (reference.published.method != "mc" || reference.published.dataSet != figure.published.dataSet ||
          reference.published.criterion != figure.published.criterion || &reference == &figure) {
        continue;
      }
      figure.publishedRatio = figure.published.value / reference.published.value;
      figure.ourRatio = figure.ours / reference.ours;
    }
  }
}

CompareOptions compareOptions(const ReproduceOptions& options, const std::vector<PublishedFigure>& figures) {
  CompareOptions compare;
  compare.methods.clear();
  for (const std::string& method : methodNames()) {
    const bool published = std::any_of(figures.begin(), figures.end(),
                                       [&](const PublishedFigure& figure) { return figure.method == method; });
    if (published) compare.methods.push_back(method);
  }
  compare.iterations = options.iterations.value_or(compare.iterations);
  compare.delaunayTimeLimit = options.delaunayTimeLimit;
  compare.equalTriangles = false;
  compare.dualTetrahedra = options.table == "5.2" || options.table == "5.3";
  compare.seed = options.seed;
  return compare;
}

void reproduceDataSet(const std::string& dataSet, const std::vector<PublishedFigure>& published, Reproduction& result,
                      const RunContext& context) {
  const ReproduceOptions& options = result.options;
  StandIn standIn;
  standIn.dataSet = dataSet;
  standIn.input = inputFor(dataSet, options.data);
  standIn.publishedSites = published.front().sites;
  FormOptions formOptions;
  if (isShape(standIn.input)) formOptions.rotationSeed = options.seed;
  const Form form = formFromInput(standIn.input, formOptions, context);
  standIn.resolution =
      standIn.publishedSites ? resolutionFor(*form.function, *standIn.publishedSites, context) : kThesisResolution;
  CompareOptions compareWith = compareOptions(options, published);
  compareWith.resolution = standIn.resolution;
  compareWith.threads = context.threads;
  context.info(dataSet + ": " + standIn.input + " stands in, at resolution " + std::to_string(standIn.resolution));
  const Comparison comparison = compare(form, compareWith, context);
  standIn.sites = comparison.sites;
  for (const MethodOutcome& outcome : comparison.methods) {
    if (!outcome.failure.empty() || outcome.measurement.certificate.valid) continue;
    result.remarks.push_back(dataSet + ", " + outcome.method + ": the tessellation fails its certificate of validity.");
  }
  for (const PublishedFigure& figure : published) {
    ReproducedFigure reproduced;
    reproduced.published = figure;
    fill(reproduced, comparison);
    result.figures.push_back(std::move(reproduced));
  }
  result.standIns.push_back(std::move(standIn));
}

void reproduceComparisons(const std::vector<PublishedFigure>& published, Reproduction& result,
                          const RunContext& context) {
  // What is missing is found before the first run.
  for (const std::string& dataSet : dataSetsOf(published)) {
    const std::string input = inputFor(dataSet, result.options.data);
    if (!isWanted(result.options, dataSet) || isShape(input)) continue;
    std::error_code ignored;
    if (!fs::exists(input, ignored)) {
      throw InputError(input + ": does not exist; datasets-scripts/fetch-scans gets it, --data names its folder");
    }
  }
  for (const std::string& dataSet : dataSetsOf(published)) {
    if (!isWanted(result.options, dataSet)) continue;
    std::vector<PublishedFigure> figures;
    std::copy_if(published.begin(), published.end(), std::back_inserter(figures),
                 [&](const PublishedFigure& figure) { return figure.dataSet == dataSet; });
    reproduceDataSet(dataSet, figures, result, context);
  }
  fillRatios(result.figures);
  result.remarks.emplace_back(
      "The thesis's data sets are not public: others stand in, so that distances, which are in each data set's own "
      "units, compare only as ratios to mc. The thesis's distances are nearly equal for all methods: something other "
      "than the discretization dominates them. Expect the same order of the methods, and larger gaps.");
  if (result.options.table == "5.4") {
    result.remarks.emplace_back("Published times: Intel Xeon E5-2643 at 3.30 GHz. Ours: this machine, " +
                                std::to_string(context.threads) + " threads at most.");
  }
}

void reproduceBodies(const std::vector<PublishedFigure>& published, Reproduction& result) {
  for (const PublishedFigure& figure : published) {
    if (!isWanted(result.options, figure.dataSet)) continue;
    ReproducedFigure reproduced;
    reproduced.published = figure;
    reproduced.ours = regularityOfBody(figure.dataSet);
    result.figures.push_back(std::move(reproduced));
  }
  result.remarks.emplace_back("Published to seven decimals.");
}

// 1 if the statement holds in the ranking, else 0; nothing if it cannot be told.
std::optional<double> holds(const PublishedFigure& statement, const RankingTable& table) {
  const std::size_t space = statement.criterion.find(' ');
  std::string criterion = statement.criterion.substr(0, space);
  criterion.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(criterion.front())));
  const std::string other = statement.criterion.substr(statement.criterion.rfind(' ') + 1);
  const bool before = statement.criterion.find("significantly before") != std::string::npos;
  for (const CriterionRanking& ranking : table.criteria) {
    if (ranking.criterion != criterion) continue;
    std::optional<double> rankOfMethod;
    std::optional<double> rankOfOther;
    for (std::size_t j = 0; j < ranking.methods.size(); ++j) {
      if (ranking.methods[j].method == statement.method) rankOfMethod = ranking.summary.meanRanks[j];
      if (ranking.methods[j].method == other) rankOfOther = ranking.summary.meanRanks[j];
    }
    if (!rankOfMethod || !rankOfOther) return std::nullopt;
    const double lead = before ? *rankOfOther - *rankOfMethod : *rankOfMethod - *rankOfOther;
    return lead >= ranking.summary.criticalDifference05 ? 1 : 0;
  }
  return std::nullopt;
}

Rankings rankingFor(Reproduction& result, const fs::path& folder, const RunContext& context) {
  const ReproduceOptions& options = result.options;
  if (!options.ranking.empty()) {
    result.remarks.push_back("From the ranking in " + options.ranking.string() + ".");
    return readRankings(options.ranking);
  }
  RankOptions rankOptions;
  rankOptions.experiment =
      parseExperiment(embeddedFile("experiments/meshes.toml"), "eval/experiments/meshes.toml", options.data);
  rankOptions.experiment.iterations = options.iterations.value_or(rankOptions.experiment.iterations);
  rankOptions.experiment.delaunayTimeLimit = options.delaunayTimeLimit;
  rankOptions.compare.threads = context.threads;
  for (const ExperimentInput& input : rankOptions.experiment.inputs) {
    std::error_code ignored;
    if (!fs::exists(input.input, ignored)) {
      throw InputError(input.input +
                       ": does not exist; datasets-scripts/fetch-meshes gets it, --data names its folder");
    }
  }
  const fs::path rankFolder = folder / "ranking";
  Rankings rankings = rank(rankOptions, rankFolder, context);
  writeRankings(rankings, rankFolder);
  return rankings;
}

void reproduceRanking(const std::vector<PublishedFigure>& published, Reproduction& result, const fs::path& folder,
                      const RunContext& context) {
  const Rankings rankings = rankingFor(result, folder, context);
  const auto table = std::find_if(rankings.tables.begin(), rankings.tables.end(),
                                  [](const RankingTable& t) { return t.rule == kEqualResolution; });
  if (table == rankings.tables.end()) throw MethodError("the ranking has no table at equal resolution");
  for (const PublishedFigure& statement : published) {
    ReproducedFigure reproduced;
    reproduced.published = statement;
    if (const auto value = holds(statement, *table)) {
      reproduced.ours = *value;
    } else {
      reproduced.failure = "the ranking lacks the criterion or a method";
    }
    result.figures.push_back(std::move(reproduced));
  }
  result.remarks.push_back(
      "The bars of figure 5.7 are not in the text of the thesis; what it says of them is: 1 where a "
      "statement holds, 0 where not (Nemenyi, 0.05). " +
      std::to_string(table->inputs.size()) +
      " meshes of libcgal-demo by signed distance stand in for 97 of the Princeton benchmark by "
      "Poisson reconstruction.");
}

}  // namespace

std::vector<std::string> validate(const ReproduceOptions& options) {
  std::vector<std::string> problems;
  const auto& tables = reproducibleTables();
  if (std::find(tables.begin(), tables.end(), options.table) == tables.end()) {
    std::string list;
    for (const std::string& table : tables) list += (list.empty() ? "" : ", ") + table;
    problems.push_back("table: unknown table \"" + options.table + "\"; expected one of " + list);
    return problems;
  }
  const std::vector<std::string> known = dataSetsOf(publishedFigures(options.table));
  for (const std::string& dataSet : options.dataSets) {
    if (std::find(known.begin(), known.end(), dataSet) != known.end()) continue;
    std::string list;
    for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
    problems.push_back("data-sets: table " + options.table + " has no \"" + dataSet + "\"; it has " + list);
  }
  if (options.iterations.value_or(0) < 0) {
    problems.push_back("iterations: " + std::to_string(*options.iterations) + " is negative");
  }
  if (options.seeds < 1) problems.push_back("seeds: " + std::to_string(options.seeds) + ", but must be at least 1");
  if (!(options.delaunayTimeLimit >= 0)) problems.emplace_back("delaunay-time-limit: expected 0 or more seconds");
  if (!options.ranking.empty() && options.table != "figure-5.7") {
    problems.push_back("ranking: has no meaning for table " + options.table);
  }
  return problems;
}

Index resolutionFor(const implicit::ImplicitFunction& f, Index sites, const RunContext& context) {
  const Box3 box = baselines::solidBox(f, context);
  std::map<Index, Index> counts;
  const auto count = [&](Index resolution) {
    const auto [place, added] = counts.emplace(resolution, 0);
    if (added) place->second = baselines::insideCubes(f, baselines::gridOf(box, resolution), context);
    return place->second;
  };
  const auto clamped = [](double resolution) {
    return static_cast<Index>(std::lround(
        std::clamp(resolution, static_cast<double>(kSmallestResolution), static_cast<double>(kLargestResolution))));
  };
  // The count grows as the cube of the resolution; two corrections come within a step or two.
  Index at = 50;
  for (int step = 0; step < 3; ++step) {
    at = clamped(at * std::cbrt(static_cast<double>(sites) / static_cast<double>(std::max<Index>(count(at), 1))));
  }
  // Down until there are too few, then up until there are enough: the nearest is among those counted.
  Index low = at;
  while (low > kSmallestResolution && count(low) > sites) --low;
  for (Index high = low; high < kLargestResolution && count(high) < sites;) count(++high);
  return std::min_element(
             counts.begin(), counts.end(),
             [&](const auto& a, const auto& b) { return std::abs(a.second - sites) < std::abs(b.second - sites); })
      ->first;
}

Reproduction reproduce(const ReproduceOptions& options, const fs::path& folder, const RunContext& context) {
  const std::vector<std::string> problems = validate(options);
  if (!problems.empty()) throw UsageError(problems.front());
  const Stopwatch watch;
  Reproduction result;
  result.options = options;
  const std::vector<PublishedFigure> published = publishedFigures(options.table);
  if (options.table == "3.1") {
    reproduceBodies(published, result);
  } else if (options.table == "figure-5.7") {
    reproduceRanking(published, result, folder, context);
  } else if (isCvtTable(options.table)) {
    reproduceCvts(published, result, context);
  } else {
    reproduceComparisons(published, result, context);
  }
  result.seconds = watch.seconds();
  return result;
}

}  // namespace voroform::pipeline
