#include "rank_records.hpp"

#include <cmath>
#include <cstdio>
#include <limits>

#include "text_files.hpp"
#include "voroform/core/error.hpp"

namespace voroform::pipeline {

namespace {

// JSON has no NaN and no infinity: null stands for both.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double numberOf(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Json outcomeJson(const RankedOutcome& outcome) {
  Json json = {{"method", outcome.method}};
  if (!outcome.matched.empty()) json["matched"] = outcome.matched;
  if (!outcome.failure.empty()) {
    json["failure"] = outcome.failure;
    return json;
  }
  json["dmean"] = number(outcome.dmean);
  json["drmse"] = number(outcome.drmse);
  json["nmean"] = number(outcome.nmean);
  json["nrmse"] = number(outcome.nrmse);
  json["gmean"] = number(outcome.gmean);
  json["gmax"] = number(outcome.gmax);
  json["seconds"] = number(outcome.seconds);
  json["cells"] = outcome.cells;
  json["boundary_triangles"] = outcome.boundaryTriangles;
  json["valid"] = outcome.valid;
  return json;
}

RankedOutcome outcomeOf(const Json& json) {
  RankedOutcome outcome;
  outcome.method = json.at("method").get<std::string>();
  outcome.matched = json.value("matched", "");
  outcome.failure = json.value("failure", "");
  const auto read = [&](const char* key, double& target) {
    target = outcome.failure.empty() ? numberOf(json.at(key)) : std::numeric_limits<double>::quiet_NaN();
  };
  read("dmean", outcome.dmean);
  read("drmse", outcome.drmse);
  read("nmean", outcome.nmean);
  read("nrmse", outcome.nrmse);
  read("gmean", outcome.gmean);
  read("gmax", outcome.gmax);
  read("seconds", outcome.seconds);
  if (outcome.failure.empty()) {
    outcome.cells = json.at("cells").get<std::int64_t>();
    outcome.boundaryTriangles = json.at("boundary_triangles").get<std::int64_t>();
    outcome.valid = json.at("valid").get<bool>();
  }
  return outcome;
}

Json outcomesJson(const std::vector<RankedOutcome>& outcomes) {
  Json list = Json::array();
  for (const RankedOutcome& outcome : outcomes) list.push_back(outcomeJson(outcome));
  return list;
}

std::vector<RankedOutcome> outcomesOf(const Json& json) {
  std::vector<RankedOutcome> outcomes;
  for (const Json& element : json) outcomes.push_back(outcomeOf(element));
  return outcomes;
}

Json experimentJson(const Experiment& experiment) {
  return {{"name", experiment.name},
          {"methods", experiment.methods},
          {"resolutions", experiment.resolutions},
          {"seeds", experiment.seeds},
          {"iterations", experiment.iterations},
          {"equal_triangles", experiment.equalTriangles},
          {"delaunay_time_limit", experiment.delaunayTimeLimit},
          {"implicit", experiment.implicit},
          {"rotate", experiment.rotate}};
}

Json criterionJson(const CriterionRanking& ranking) {
  const RankSummary& summary = ranking.summary;
  Json methods = Json::array();
  for (std::size_t j = 0; j < ranking.methods.size(); ++j) {
    const PairedRatio& ratio = ranking.methods[j].ratio;
    Json values = Json::array();
    for (const std::vector<double>& row : ranking.values) values.push_back(number(row[j]));
    methods.push_back({{"method", ranking.methods[j].method},
                       {"places", summary.counts[j]},
                       {"mean_rank", summary.meanRanks[j]},
                       {"failures", summary.failures[j]},
                       {"ratio_to_mc",
                        {{"inputs", ratio.inputs},
                         {"mean", number(ratio.mean)},
                         {"lower_quartile", number(ratio.lowerQuartile)},
                         {"median", number(ratio.median)},
                         {"upper_quartile", number(ratio.upperQuartile)},
                         {"better", ratio.better},
                         {"equal", ratio.equal},
                         {"worse", ratio.worse}}},
                       {"values", std::move(values)}});
  }
  return {{"criterion", ranking.criterion},
          {"friedman",
           {{"chi_square", number(summary.friedman.chiSquare)},
            {"chi_square_p", number(summary.friedman.chiSquareP)},
            {"f", number(summary.friedman.f)},
            {"f_p", number(summary.friedman.fP)}}},
          {"critical_difference", {{"0.05", summary.criticalDifference05}, {"0.10", summary.criticalDifference10}}},
          {"methods", std::move(methods)}};
}

Json tableJson(const RankingTable& table) {
  Json criteria = Json::array();
  for (const CriterionRanking& ranking : table.criteria) criteria.push_back(criterionJson(ranking));
  return {{"rule", table.rule},
          {"group", table.group},
          {"resolution", table.resolution},
          {"inputs", table.inputs},
          {"criteria", std::move(criteria)}};
}

Experiment experimentOf(const Json& json) {
  Experiment experiment;
  experiment.name = json.at("name").get<std::string>();
  experiment.methods = json.at("methods").get<std::vector<std::string>>();
  experiment.resolutions = json.at("resolutions").get<std::vector<Index>>();
  experiment.seeds = json.at("seeds").get<std::vector<std::uint64_t>>();
  experiment.iterations = json.at("iterations").get<int>();
  experiment.equalTriangles = json.at("equal_triangles").get<bool>();
  experiment.delaunayTimeLimit = json.at("delaunay_time_limit").get<double>();
  experiment.implicit = json.at("implicit").get<std::string>();
  experiment.rotate = json.at("rotate").get<bool>();
  return experiment;
}

std::string csvNumber(double value) {
  if (!std::isfinite(value)) return "";
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

}  // namespace

Json runKeyJson(const RankOptions& options, const RankedRun& run) {
  const Experiment& experiment = options.experiment;
  const baselines::DelaunayOptions& delaunay = options.compare.delaunay;
  return {{"versions", versionsJson()},
          {"input", run.sha256.empty() ? run.input.input : run.sha256},
          {"resolution", run.resolution},
          {"seed", run.seed},
          {"methods", experiment.methods},
          {"iterations", experiment.iterations},
          {"equal_triangles", experiment.equalTriangles},
          {"dual_tetrahedra", options.compare.dualTetrahedra},
          {"implicit", experiment.implicit},
          {"rotate", experiment.rotate},
          {"envelope", toString(options.form.envelope)},
          {"margin", options.form.margin},
          {"samples", options.form.samples},
          {"as", options.form.inputKind == InputKind::points ? "points"
                 : options.form.inputKind == InputKind::mesh ? "mesh"
                                                             : "auto"},
          {"delaunay",
           {{"facet_angle", delaunay.facetAngle},
            {"radius_edge_ratio", delaunay.radiusEdgeRatio},
            {"facet_distance", delaunay.facetDistance},
            {"lloyd_iterations", delaunay.lloydIterations},
            {"odt_iterations", delaunay.odtIterations},
            {"perturb", delaunay.perturb},
            {"exude", delaunay.exude},
            {"time_limit", experiment.delaunayTimeLimit}}}};
}

Json rankedRunJson(const RankedRun& run) {
  Json json = {{"name", run.input.name},       {"input", run.input.input}, {"group", run.input.group},
               {"resolution", run.resolution}, {"seed", run.seed},         {"folder", run.folder},
               {"sha256", run.sha256}};
  if (!run.failure.empty()) {
    json["failure"] = run.failure;
    return json;
  }
  json["resumed"] = run.resumed;
  json["sites"] = run.sites;
  json["equal_resolution"] = outcomesJson(run.outcomes);
  json["equal_triangles"] = outcomesJson(run.equalTriangles);
  return json;
}

RankedRun rankedRun(const Json& json, const std::string& name) {
  try {
    RankedRun run;
    run.input = {json.at("input").get<std::string>(), json.at("name").get<std::string>(),
                 json.at("group").get<std::string>()};
    run.resolution = json.at("resolution").get<Index>();
    run.seed = json.at("seed").get<std::uint64_t>();
    run.folder = json.at("folder").get<std::string>();
    run.sha256 = json.at("sha256").get<std::string>();
    run.failure = json.value("failure", "");
    if (!run.failure.empty()) return run;
    run.resumed = json.value("resumed", false);
    run.sites = json.at("sites").get<Index>();
    run.outcomes = outcomesOf(json.at("equal_resolution"));
    run.equalTriangles = outcomesOf(json.at("equal_triangles"));
    return run;
  } catch (const Json::exception& error) {
    throw InputError(name + ": is no record of a ranked run: " + error.what());
  }
}

Json rankingsJson(const Rankings& rankings) {
  Json runs = Json::array();
  for (const RankedRun& run : rankings.runs) runs.push_back(rankedRunJson(run));
  Json tables = Json::array();
  for (const RankingTable& table : rankings.tables) tables.push_back(tableJson(table));
  return {{"schema", kRankingsSchema},
          {"versions", versionsJson()},
          {"experiment", experimentJson(rankings.experiment)},
          {"tables", std::move(tables)},
          {"runs", std::move(runs)}};
}

Rankings readRankings(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "rankings.json";
  const Json json = readJson(path);
  Rankings rankings;
  try {
    if (json.at("schema").get<std::string>() != kRankingsSchema) {
      throw InputError(path.string() + ": expected the schema \"" + kRankingsSchema + "\", found " +
                       json.at("schema").dump());
    }
    rankings.experiment = experimentOf(json.at("experiment"));
    for (const Json& element : json.at("runs")) {
      rankings.runs.push_back(rankedRun(element, path.string()));
      const RankedRun& run = rankings.runs.back();
      if (run.resolution == rankings.experiment.resolutions.front() && run.seed == rankings.experiment.seeds.front()) {
        rankings.experiment.inputs.push_back(run.input);
      }
    }
  } catch (const Json::exception& error) {
    throw InputError(path.string() + ": is no result of rank: " + error.what());
  }
  rankings.tables = rankingTables(rankings.experiment, rankings.runs);
  return rankings;
}

std::string rankingsCsv(const Rankings& rankings) {
  const std::size_t most = rankings.experiment.methods.size();
  std::string csv =
      "rule,group,resolution,criterion,method,inputs,failures,mean_rank,ratio_inputs,ratio_mean,ratio_lower_quartile,"
      "ratio_median,ratio_upper_quartile,better_than_mc,equal_to_mc,worse_than_mc,chi_square,chi_square_p,f,f_p,"
      "critical_difference_05,critical_difference_10";
  for (std::size_t place = 1; place <= most; ++place) csv += ",place_" + std::to_string(place);
  csv += '\n';
  for (const RankingTable& table : rankings.tables) {
    for (const CriterionRanking& ranking : table.criteria) {
      const RankSummary& summary = ranking.summary;
      for (std::size_t j = 0; j < ranking.methods.size(); ++j) {
        const PairedRatio& ratio = ranking.methods[j].ratio;
        csv += quoted(table.rule) + ',' + quoted(table.group) + ',' + std::to_string(table.resolution) + ',' +
               ranking.criterion + ',' + ranking.methods[j].method + ',' + std::to_string(summary.inputs) + ',' +
               std::to_string(summary.failures[j]);
        csv += ',' + csvNumber(summary.meanRanks[j]) + ',' + std::to_string(ratio.inputs);
        for (const double value : {ratio.mean, ratio.lowerQuartile, ratio.median, ratio.upperQuartile}) {
          csv += ',' + csvNumber(value);
        }
        for (const std::size_t count : {ratio.better, ratio.equal, ratio.worse}) csv += ',' + std::to_string(count);
        for (const double value : {summary.friedman.chiSquare, summary.friedman.chiSquareP, summary.friedman.f,
                                   summary.friedman.fP, summary.criticalDifference05, summary.criticalDifference10}) {
          csv += ',' + csvNumber(value);
        }
        for (std::size_t place = 0; place < most; ++place) {
          csv += ',' + (place < summary.counts[j].size() ? std::to_string(summary.counts[j][place]) : std::string());
        }
        csv += '\n';
      }
    }
  }
  return csv;
}

std::vector<std::string> writeRankings(const Rankings& rankings, const std::filesystem::path& folder) {
  ArtifactStore store(folder);
  putText(store, "rankings.csv", rankingsCsv(rankings));
  putText(store, "rankings.md", rankingsMarkdown(rankings));
  putText(store, "rankings.svg", rankingsSvg(rankings));
  store.put("rankings.json", [&](const std::filesystem::path& path) { writeJson(path, rankingsJson(rankings)); });
  store.commit();
  return store.names();
}

std::string shortNumber(double value, int digits) {
  if (std::isnan(value)) return "–";
  if (std::isinf(value)) return "∞";
  char text[32];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace voroform::pipeline
