// The files of a reproduction.
#include <cmath>

#include "rank_records.hpp"
#include "reproduce_cvt.hpp"
#include "text_files.hpp"
#include "voroform/pipeline/artifact_store.hpp"
#include "voroform/pipeline/reproduce.hpp"

namespace voroform::pipeline {

namespace {

constexpr const char* kSchema = "voroform.reproduction/1";

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double difference(const ReproducedFigure& figure) { return figure.ours - figure.published.value; }

Json figureJson(const ReproducedFigure& figure) {
  const PublishedFigure& published = figure.published;
  Json json = {{"data_set", published.dataSet},
               {"sites", published.sites ? Json(*published.sites) : Json(nullptr)},
               {"page", published.page},
               {"method", published.method},
               {"criterion", published.criterion},
               {"published", published.value},
               {"ours", number(figure.ours)},
               {"difference", number(difference(figure))},
               {"lowest", number(figure.lowest)},
               {"highest", number(figure.highest)},
               {"published_ratio_to_mc", number(figure.publishedRatio)},
               {"our_ratio_to_mc", number(figure.ourRatio)}};
  if (!figure.failure.empty()) json["failure"] = figure.failure;
  if (!published.note.empty()) json["note"] = published.note;
  return json;
}

Json reproductionJson(const Reproduction& reproduction) {
  Json standIns = Json::array();
  for (const StandIn& standIn : reproduction.standIns) {
    standIns.push_back({{"data_set", standIn.dataSet},
                        {"input", standIn.input},
                        {"published_sites", standIn.publishedSites ? Json(*standIn.publishedSites) : Json(nullptr)},
                        {"resolution", standIn.resolution},
                        {"sites", standIn.sites}});
  }
  Json figures = Json::array();
  for (const ReproducedFigure& figure : reproduction.figures) figures.push_back(figureJson(figure));
  return {{"schema", kSchema},
          {"table", reproduction.options.table},
          {"versions", versionsJson()},
          {"seed", reproduction.options.seed},
          {"iterations", reproduction.options.iterations ? Json(*reproduction.options.iterations) : Json(nullptr)},
          {"seeds", reproduction.options.seeds},
          {"delaunay_time_limit", reproduction.options.delaunayTimeLimit},
          {"stand_ins", std::move(standIns)},
          {"figures", std::move(figures)},
          {"remarks", reproduction.remarks},
          {"seconds", reproduction.seconds}};
}

std::string csvNumber(double value) { return std::isfinite(value) ? shortNumber(value, 10) : std::string(); }

std::string reproductionCsv(const Reproduction& reproduction) {
  std::string csv =
      "table,page,data_set,sites,method,criterion,published,ours,difference,lowest,highest,published_ratio_to_mc,"
      "our_ratio_to_mc,failure,note\n";
  for (const ReproducedFigure& figure : reproduction.figures) {
    const PublishedFigure& published = figure.published;
    csv += published.table + ',' + std::to_string(published.page) + ',' + quoted(published.dataSet) + ',' +
           (published.sites ? std::to_string(*published.sites) : std::string()) + ',' + published.method + ',' +
           quoted(published.criterion);
    for (const double value : {published.value, figure.ours, difference(figure), figure.lowest, figure.highest,
                               figure.publishedRatio, figure.ourRatio}) {
      csv += ',' + csvNumber(value);
    }
    csv += ',' + quoted(figure.failure) + ',' + quoted(published.note) + '\n';
  }
  return csv;
}

}  // namespace

std::string reproductionMarkdown(const Reproduction& reproduction) {
  const std::string& table = reproduction.options.table;
  const bool isFigure = table.starts_with("figure");
  std::string text = isFigure ? "# Figure " + table.substr(7) : "# Table " + table;
  text += " of the thesis, reproduced\n\n";
  for (const StandIn& standIn : reproduction.standIns) {
    text += "- For " + standIn.dataSet + " (" +
            (standIn.publishedSites ? std::to_string(*standIn.publishedSites) + " sites"
                                    : std::string("number of sites not printed")) +
            ") stands " + standIn.input + ": resolution " + std::to_string(standIn.resolution) + ", " +
            std::to_string(standIn.sites) + " sites\n";
  }
  if (!reproduction.standIns.empty()) text += '\n';
  for (const std::string& remark : reproduction.remarks) text += remark + "\n\n";
  const bool isCvt = isCvtTable(table);
  text += std::string("| data | ") + (isCvt ? "sites | " : "") +
          "method | criterion | published | ours | difference | " +
          (isCvt ? "lowest | highest |\n|---" : "published/mc | ours/mc |\n") + "|---|---|---|---|---|---|---|---|\n";
  const int digits = table == "3.1" ? 7 : 4;
  for (const ReproducedFigure& figure : reproduction.figures) {
    const PublishedFigure& published = figure.published;
    const std::string ours = figure.failure.empty() ? shortNumber(figure.ours, digits) : figure.failure;
    text += "| " + published.dataSet + " | " +
            (isCvt && published.sites ? std::to_string(*published.sites) + " | " : std::string()) + published.method +
            " | " + published.criterion + " | " + shortNumber(published.value, digits) + " | " + ours + " | " +
            shortNumber(difference(figure), 2) + " | " +
            shortNumber(isCvt ? figure.lowest : figure.publishedRatio, digits) + " | " +
            shortNumber(isCvt ? figure.highest : figure.ourRatio, digits) + " |\n";
  }
  return text;
}

std::vector<std::string> writeReproduction(const Reproduction& reproduction, const std::filesystem::path& folder) {
  ArtifactStore store(folder);
  putText(store, "reproduce.csv", reproductionCsv(reproduction));
  putText(store, "reproduce.md", reproductionMarkdown(reproduction));
  if (!reproduction.curves.empty()) {
    putText(store, "curves.csv", curvesCsv(reproduction.curves));
    putText(store, "curves.svg", curvesSvg(reproduction.curves));
  }
  store.put("reproduce.json",
            [&](const std::filesystem::path& path) { writeJson(path, reproductionJson(reproduction)); });
  store.commit();
  return store.names();
}

}  // namespace voroform::pipeline
