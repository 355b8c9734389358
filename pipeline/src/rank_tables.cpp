// From runs to tables of ranks.
#include <algorithm>
#include <limits>
#include <optional>

#include "voroform/core/error.hpp"
#include "voroform/pipeline/rank.hpp"

namespace voroform::pipeline {

namespace {

constexpr double kFailed = std::numeric_limits<double>::infinity();
constexpr const char* kReference = "mc";

double valueOf(const RankedOutcome& outcome, const std::string& criterion) {
  if (criterion == "dmean") return outcome.dmean;
  if (criterion == "drmse") return outcome.drmse;
  if (criterion == "nmean") return outcome.nmean;
  if (criterion == "nrmse") return outcome.nrmse;
  if (criterion == "gmean") return outcome.gmean;
  if (criterion == "gmax") return outcome.gmax;
  if (criterion == "seconds") return outcome.seconds;
  throw UsageError("unknown criterion " + criterion);
}

// A method as a table has it: its name, and whether its outcome stands in the comparison at equal triangles.
struct Column {
  std::string method;
  std::string matched;  // empty: at equal resolution
};

// The value of a column, infinite if the method failed.
double valueOf(const RankedRun& run, const Column& column, const std::string& criterion) {
  const auto& outcomes = column.matched.empty() ? run.outcomes : run.equalTriangles;
  for (const RankedOutcome& outcome : outcomes) {
    if (outcome.method != column.method || outcome.matched != column.matched) continue;
    const double value = outcome.failure.empty() ? valueOf(outcome, criterion) : kFailed;
    return value < kFailed ? value : kFailed;  // NaN as well
  }
  return kFailed;
}

// The runs of one input at one resolution: one a seed.
struct Block {
  std::string name;
  std::vector<const RankedRun*> runs;
};

CriterionRanking rankingOf(const std::vector<Block>& blocks, const std::vector<Column>& columns,
                           const std::string& criterion) {
  CriterionRanking ranking;
  ranking.criterion = criterion;
  for (const Block& block : blocks) {
    std::vector<double>& row = ranking.values.emplace_back();
    for (const Column& column : columns) {
      std::vector<double> values;
      for (const RankedRun* run : block.runs) values.push_back(valueOf(*run, column, criterion));
      std::sort(values.begin(), values.end());
      // The median, whose failures are the largest values; of an even number the mean of the middle two.
      const std::size_t half = values.size() / 2;
      row.push_back(values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]));
    }
  }
  ranking.summary = rankSummary(ranking.values);
  std::vector<std::vector<double>> byMethod(columns.size());
  std::optional<std::size_t> reference;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    if (columns[j].method == kReference) reference = j;
    for (const std::vector<double>& row : ranking.values) byMethod[j].push_back(row[j]);
  }
  for (std::size_t j = 0; j < columns.size(); ++j) {
    RankedMethod& method = ranking.methods.emplace_back();
    method.method = columns[j].method;
    method.ratio = reference ? pairedRatio(byMethod[j], byMethod[*reference]) : pairedRatio({}, {});
  }
  return ranking;
}

bool isRegularity(const std::string& criterion) { return criterion == "gmean" || criterion == "gmax"; }

RankingTable tableOf(const std::vector<Block>& blocks, const std::vector<Column>& columns,
                     const std::vector<std::string>& criteria) {
  RankingTable table;
  for (const Block& block : blocks) table.inputs.push_back(block.name);
  for (const std::string& criterion : criteria) {
    std::vector<Column> chosen = columns;
    if (isRegularity(criterion)) {
      std::erase_if(chosen, [](const Column& column) { return column.method == "delaunay"; });
    }
    if (chosen.size() >= 2) table.criteria.push_back(rankingOf(blocks, chosen, criterion));
  }
  return table;
}

std::vector<Block> blocksOf(const std::vector<RankedRun>& runs, const std::string& group, Index resolution) {
  std::vector<Block> blocks;
  for (const RankedRun& run : runs) {
    if (run.input.group != group || run.resolution != resolution || !run.failure.empty()) continue;
    auto block = std::find_if(blocks.begin(), blocks.end(), [&](const Block& b) { return b.name == run.input.name; });
    if (block == blocks.end()) block = blocks.insert(blocks.end(), {run.input.name, {}});
    block->runs.push_back(&run);
  }
  return blocks;
}

// What is compared with a CVT at its number of triangles, in any of the runs.
std::vector<Column> matchedColumns(const Experiment& experiment, const std::vector<Block>& blocks,
                                   const std::string& cvt) {
  std::vector<Column> columns;
  for (const std::string& method : experiment.methods) {
    const bool there = std::any_of(blocks.begin(), blocks.end(), [&](const Block& block) {
      return std::any_of(block.runs.begin(), block.runs.end(), [&](const RankedRun* run) {
        return std::any_of(run->equalTriangles.begin(), run->equalTriangles.end(), [&](const RankedOutcome& outcome) {
          return outcome.method == method && outcome.matched == cvt;
        });
      });
    });
    if (there) columns.push_back({method, cvt});
  }
  if (!columns.empty()) columns.push_back({cvt, ""});
  return columns;
}

}  // namespace

std::size_t Rankings::failedRuns() const {
  return static_cast<std::size_t>(
      std::count_if(runs.begin(), runs.end(), [](const RankedRun& run) { return !run.failure.empty(); }));
}

std::size_t Rankings::invalidTessellations() const {
  std::size_t count = 0;
  for (const RankedRun& run : runs) {
    count += static_cast<std::size_t>(std::count_if(run.outcomes.begin(), run.outcomes.end(), [](const auto& outcome) {
      return outcome.method.starts_with("cvt") && outcome.failure.empty() && !outcome.valid;
    }));
  }
  return count;
}

const std::vector<std::string>& rankedCriteria() {
  static const std::vector<std::string> criteria = {"dmean", "drmse", "nmean", "nrmse", "gmean", "gmax", "seconds"};
  return criteria;
}

std::vector<RankingTable> rankingTables(const Experiment& experiment, const std::vector<RankedRun>& runs) {
  std::vector<std::string> groups;
  for (const ExperimentInput& input : experiment.inputs) {
    if (std::find(groups.begin(), groups.end(), input.group) == groups.end()) groups.push_back(input.group);
  }
  std::vector<RankingTable> tables;
  const auto add = [&tables](RankingTable table, const std::string& rule, const std::string& group, Index resolution) {
    if (table.criteria.empty()) return;
    table.rule = rule;
    table.group = group;
    table.resolution = resolution;
    tables.push_back(std::move(table));
  };
  for (const Index resolution : experiment.resolutions) {
    for (const std::string& group : groups) {
      const std::vector<Block> blocks = blocksOf(runs, group, resolution);
      if (blocks.empty()) continue;
      std::vector<Column> columns;
      for (const std::string& method : experiment.methods) columns.push_back({method, ""});
      add(tableOf(blocks, columns, rankedCriteria()), kEqualResolution, group, resolution);
      for (const std::string& method : experiment.methods) {
        const std::vector<Column> matched = matchedColumns(experiment, blocks, method);
        add(tableOf(blocks, matched, {"dmean", "drmse", "nmean", "nrmse"}), "equal triangles, " + method, group,
            resolution);
      }
    }
  }
  return tables;
}

}  // namespace voroform::pipeline
