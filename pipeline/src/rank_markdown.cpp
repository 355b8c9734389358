// rankings.md.
#include <algorithm>
#include <cmath>

#include "rank_records.hpp"

namespace voroform::pipeline {

namespace {

std::string ordinal(std::size_t place) {
  const char* const suffix = place == 1 ? "st" : place == 2 ? "nd" : place == 3 ? "rd" : "th";
  return std::to_string(place) + suffix;
}

std::string titleOf(const std::string& criterion) {
  if (criterion == "dmean") return "Dmean, mean distance";
  if (criterion == "drmse") return "Drmse, root mean square distance";
  if (criterion == "nmean") return "Nmean, mean angle of normals";
  if (criterion == "nrmse") return "Nrmse, root mean square angle";
  if (criterion == "gmean") return "Gmean, mean regularity of cells";
  if (criterion == "gmax") return "Gmax, worst regularity of cells";
  return "Seconds";
}

// "a, b" of the methods whose mean ranks differ from `method`'s by at least the critical difference and are larger.
std::string significantlyBehind(const CriterionRanking& ranking, std::size_t method) {
  std::string list;
  for (std::size_t j = 0; j < ranking.methods.size(); ++j) {
    if (ranking.summary.meanRanks[j] - ranking.summary.meanRanks[method] < ranking.summary.criticalDifference05)
      continue;
    list += (list.empty() ? "" : ", ") + ranking.methods[j].method;
  }
  return list.empty() ? "–" : list;
}

std::string criterionMarkdown(const CriterionRanking& ranking) {
  const RankSummary& summary = ranking.summary;
  const std::size_t methods = ranking.methods.size();
  std::string text = "### " + titleOf(ranking.criterion) + "\n\n| method |";
  for (std::size_t place = 1; place <= methods; ++place) text += " " + ordinal(place) + " |";
  text +=
      " failed | mean rank | significantly before | ratio to mc: median | quartiles | mean | better/equal/worse "
      "|\n|---|";
  for (std::size_t place = 0; place < methods + 7; ++place) text += "---|";
  text += '\n';
  for (std::size_t j = 0; j < methods; ++j) {
    const PairedRatio& ratio = ranking.methods[j].ratio;
    text += "| " + ranking.methods[j].method + " |";
    for (const std::size_t count : summary.counts[j]) text += " " + std::to_string(count) + " |";
    text += " " + std::to_string(summary.failures[j]) + " | " + shortNumber(summary.meanRanks[j], 3) + " | " +
            significantlyBehind(ranking, j) + " | " + shortNumber(ratio.median) + " | " +
            shortNumber(ratio.lowerQuartile) + " to " + shortNumber(ratio.upperQuartile) + " | " +
            shortNumber(ratio.mean) + " | " + std::to_string(ratio.better) + "/" + std::to_string(ratio.equal) + "/" +
            std::to_string(ratio.worse) + " |\n";
  }
  const FriedmanTest& friedman = summary.friedman;
  text += "\nFriedman χ² " + shortNumber(friedman.chiSquare) + " (p " + shortNumber(friedman.chiSquareP, 3) +
          "), Iman–Davenport F " + shortNumber(friedman.f) + " (p " + shortNumber(friedman.fP, 3) +
          "); Nemenyi's critical difference of mean ranks " + shortNumber(summary.criticalDifference05, 3) +
          " at 0.05, " + shortNumber(summary.criticalDifference10, 3) + " at 0.10.\n\n";
  return text;
}

std::string failuresMarkdown(const Rankings& rankings) {
  std::string text;
  for (const RankedRun& run : rankings.runs) {
    if (!run.failure.empty()) text += "- " + run.folder + ": no comparison: " + run.failure + "\n";
    const auto list = [&](const std::vector<RankedOutcome>& outcomes) {
      for (const RankedOutcome& outcome : outcomes) {
        const std::string method =
            outcome.method + (outcome.matched.empty() ? "" : " at the triangles of " + outcome.matched);
        if (!outcome.failure.empty()) {
          text += "- " + run.folder + ", " + method + ": " + outcome.failure + "\n";
        } else if (!outcome.valid) {
          text += "- " + run.folder + ", " + method + ": fails its certificate of validity\n";
        }
      }
    };
    list(run.outcomes);
    list(run.equalTriangles);
  }
  return text.empty() ? "" : "## Failures\n\n" + text + "\n";
}

std::string valuesMarkdown(const RankingTable& table) {
  std::string text = "### Values\n\n";
  for (const CriterionRanking& ranking : table.criteria) {
    if (ranking.criterion != "dmean") continue;
    text += "Dmean by input, in its units:\n\n| input |";
    for (const RankedMethod& method : ranking.methods) text += " " + method.method + " |";
    text += "\n|---|";
    for (std::size_t j = 0; j < ranking.methods.size(); ++j) text += "---|";
    text += '\n';
    for (std::size_t i = 0; i < table.inputs.size(); ++i) {
      text += "| " + table.inputs[i] + " |";
      for (const double value : ranking.values[i]) {
        text += " " + (std::isfinite(value) ? shortNumber(value) : std::string("failed")) + " |";
      }
      text += '\n';
    }
    text += '\n';
  }
  return text;
}

}  // namespace

std::string rankingsMarkdown(const Rankings& rankings) {
  const Experiment& experiment = rankings.experiment;
  std::string text = "# Rankings: " + experiment.name + "\n\n";
  text += std::to_string(experiment.inputs.size()) + " inputs, " + std::to_string(rankings.runs.size()) + " runs, " +
          std::to_string(rankings.failedRuns()) + " without a comparison; " + std::to_string(experiment.iterations) +
          " iterations. Smaller values are better. Equal values share the better place and the mean of their ranks; a "
          "method that failed on an input has the last place there. Ratios are to mc on the same input, where both "
          "finished.\n\n";
  for (const RankingTable& table : rankings.tables) {
    text += "## At " + table.rule + "; group " + table.group + "; resolution " + std::to_string(table.resolution) +
            "; " + std::to_string(table.inputs.size()) + " inputs\n\n";
    for (const CriterionRanking& ranking : table.criteria) text += criterionMarkdown(ranking);
    text += valuesMarkdown(table);
  }
  return text + failuresMarkdown(rankings);
}

}  // namespace voroform::pipeline
