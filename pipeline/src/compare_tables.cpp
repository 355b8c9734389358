// The comparison as tables: Markdown to read, comma-separated values to compute with.
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "comparing.hpp"
#include "text_files.hpp"

namespace voroform::pipeline {

namespace {

constexpr double kBytesPerMebibyte = 1 << 20;

// Four significant digits.
std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string number(std::int64_t value) { return std::to_string(value); }

// The shortest text that is read back as the same bits.
std::string exact(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

class MarkdownTable {
 public:
  explicit MarkdownTable(const std::vector<std::string>& header) : columns_(header.size()) {
    row(header);
    text_ += "|---|";
    for (std::size_t i = 1; i < columns_; ++i) text_ += "---:|";
    text_ += '\n';
  }

  // Cells that lack at the end are empty.
  void row(const std::vector<std::string>& cells) {
    text_ += '|';
    for (std::size_t i = 0; i < columns_; ++i) {
      text_ += ' ';
      if (i < cells.size()) text_ += cells[i] + ' ';
      text_ += '|';
    }
    text_ += '\n';
  }

  const std::string& text() const { return text_; }

 private:
  std::size_t columns_;
  std::string text_;
};

using Cells = std::vector<std::string>;

// A row for each method: its name, then what `cells` gives, or why there is none.
std::string methodTable(const std::vector<MethodOutcome>& methods, Cells header,
                        const std::function<Cells(const MethodOutcome&)>& cells) {
  header.insert(header.begin(), "method");
  MarkdownTable table(header);
  for (const MethodOutcome& outcome : methods) {
    Cells row = {outcome.method};
    if (!outcome.failure.empty()) {
      row.push_back(outcome.failure);
    } else {
      for (std::string& cell : cells(outcome)) row.push_back(std::move(cell));
    }
    table.row(row);
  }
  return table.text();
}

const MethodOutcome* find(const std::vector<MethodOutcome>& methods, const std::string& name) {
  const auto found =
      std::find_if(methods.begin(), methods.end(), [&](const MethodOutcome& m) { return m.method == name; });
  return found == methods.end() ? nullptr : &*found;
}

const metrics::Accuracy* accuracyOf(const std::vector<MethodOutcome>& methods, const std::string& name) {
  const MethodOutcome* outcome = find(methods, name);
  return outcome != nullptr && outcome->accuracy ? &*outcome->accuracy : nullptr;
}

// Of the four figures that methods are ranked by.
Cells ratios(const metrics::Accuracy& accuracy, const metrics::Accuracy* reference) {
  if (reference == nullptr) return {"", "", "", ""};
  return {number(accuracy.dmean / reference->dmean), number(accuracy.drmse / reference->drmse),
          number(accuracy.nmean / reference->nmean), number(accuracy.nrmse / reference->nrmse)};
}

std::string validText(const MethodOutcome& outcome) { return outcome.measurement.certificate.valid ? "yes" : "**no**"; }

std::string accuracyTable(const std::vector<MethodOutcome>& methods) {
  return methodTable(
      methods, {"Dmean", "Drmse", "Dmax", "Nmean", "Nrmse", "Gmax", "Gmean", "valid"},
      [](const MethodOutcome& outcome) {
        const auto& a = outcome.accuracy;
        Cells cells(5);
        if (a) cells = {number(a->dmean), number(a->drmse), number(a->dmax), number(a->nmean), number(a->nrmse)};
        cells.push_back(number(outcome.measurement.regularity.all.max));
        cells.push_back(number(outcome.measurement.regularity.all.mean));
        cells.push_back(validText(outcome));
        return cells;
      });
}

std::string ratioTable(const std::vector<MethodOutcome>& methods, const std::string& reference) {
  const metrics::Accuracy* baseline = accuracyOf(methods, reference);
  return methodTable(methods, {"Dmean", "Drmse", "Nmean", "Nrmse"}, [&](const MethodOutcome& outcome) {
    return outcome.accuracy ? ratios(*outcome.accuracy, baseline) : Cells();
  });
}

std::string unitsTable(const std::vector<MethodOutcome>& methods) {
  return methodTable(methods,
                     {"Dmean / h", "Dmean / diagonal", "mean S to B", "mean B to S", "samples on B", "unfound",
                      "Dmean along normals", "misses"},
                     [](const MethodOutcome& outcome) -> Cells {
                       if (!outcome.accuracy) return {};
                       const metrics::Accuracy& a = *outcome.accuracy;
                       return {number(a.dmean / a.cellSize),   number(a.dmean / a.diagonal),
                               number(a.fromForm.mean),        number(a.fromBoundary.mean),
                               number(a.fromBoundary.samples), number(a.fromForm.unfound + a.fromBoundary.unfound),
                               number(a.normalLine.mean),      number(a.normalLine.misses)};
                     });
}

Cells qualityCells(const metrics::QualityStatistics& quality) {
  Cells cells = {number(quality.elements)};
  for (const double mean : quality.mean) cells.push_back(number(mean));
  for (const double worst : quality.worst) cells.push_back(number(worst));
  return cells;
}

std::string rowName(const MethodOutcome& outcome, bool dual) { return outcome.method + (dual ? ", dual" : ""); }

std::string tetrahedraTable(const std::vector<MethodOutcome>& methods) {
  MarkdownTable table({"method", "tetrahedra", "VQ1", "VQ2", "VQ3", "VQ4", "worst VQ1", "worst VQ2", "worst VQ3",
                       "worst VQ4", "slivers"});
  for (const MethodOutcome& outcome : methods) {
    if (outcome.method.starts_with("delaunay") && !outcome.failure.empty())
      table.row({outcome.method, outcome.failure});
    if (!outcome.tetrahedra) continue;
    Cells row = {rowName(outcome, outcome.dual.has_value())};
    for (std::string& cell : qualityCells(*outcome.tetrahedra)) row.push_back(std::move(cell));
    row.push_back(number(outcome.tetrahedra->slivers));
    table.row(row);
  }
  return table.text();
}

std::string trianglesTable(const std::vector<MethodOutcome>& methods) {
  MarkdownTable table(
      {"method", "triangles", "SQ1", "SQ2", "SQ3", "SQ4", "worst SQ1", "worst SQ2", "worst SQ3", "worst SQ4"});
  const auto add = [&](const std::string& name, const metrics::QualityStatistics& quality) {
    Cells row = {name};
    for (std::string& cell : qualityCells(quality)) row.push_back(std::move(cell));
    table.row(row);
  };
  for (const MethodOutcome& outcome : methods) {
    if (!outcome.failure.empty()) table.row({outcome.method, outcome.failure});
    if (outcome.triangles) add(rowName(outcome, false), *outcome.triangles);
    if (outcome.dualTriangles) add(rowName(outcome, true), *outcome.dualTriangles);
  }
  return table.text();
}

std::string memoryText(std::uint64_t bytes) {
  return bytes > 0 ? number(static_cast<double>(bytes) / kBytesPerMebibyte) : "";
}

std::string costTable(const std::vector<MethodOutcome>& methods) {
  return methodTable(methods,
                     {"seconds", "memory (MiB)", "cells", "vertices", "boundary triangles", "components",
                      "Euler number", "volume error", "disconnected cells"},
                     [](const MethodOutcome& outcome) -> Cells {
                       const mesh::Certificate& certificate = outcome.measurement.certificate;
                       return {number(outcome.seconds),
                               memoryText(outcome.peakMemoryBytes),
                               number(std::int64_t{outcome.cells}),
                               number(std::int64_t{outcome.vertices}),
                               number(outcome.boundaryTriangles),
                               number(std::int64_t{certificate.components}),
                               number(certificate.eulerCharacteristic),
                               number(outcome.measurement.fidelity.volumeError),
                               number(std::int64_t{outcome.measurement.fidelity.disconnectedCells})};
                     });
}

// The CVT's row, then those of the baselines that have its number of triangles, with the CVT's figures as shares of
// theirs.
std::string equalTrianglesTable(const Comparison& comparison) {
  MarkdownTable table({"method", "boundary triangles", "cells", "cube edge", "Dmean", "Drmse", "Dmax", "Nmean", "Nrmse",
                       "valid", "CVT's Dmean / this", "Drmse", "Nmean", "Nrmse"});
  const auto cells = [](const std::string& name, const MethodOutcome& outcome) {
    Cells row = {name, number(outcome.boundaryTriangles), number(std::int64_t{outcome.cells}),
                 outcome.cubeEdge > 0 ? number(outcome.cubeEdge) : ""};
    Cells figures(5);
    if (outcome.accuracy) {
      const metrics::Accuracy& a = *outcome.accuracy;
      figures = {number(a.dmean), number(a.drmse), number(a.dmax), number(a.nmean), number(a.nrmse)};
    }
    row.insert(row.end(), figures.begin(), figures.end());
    row.push_back(validText(outcome));
    return row;
  };
  for (const MethodOutcome& cvt : comparison.methods) {
    bool first = true;
    for (const MethodOutcome& outcome : comparison.equalTriangles) {
      if (outcome.matched != cvt.method) continue;
      if (first) table.row(cells(cvt.method, cvt));
      first = false;
      if (!outcome.failure.empty()) {
        table.row({outcome.method, outcome.failure});
        continue;
      }
      Cells row = cells(outcome.method, outcome);
      if (cvt.accuracy && outcome.accuracy) {
        for (std::string& ratio : ratios(*cvt.accuracy, &*outcome.accuracy)) row.push_back(std::move(ratio));
      }
      table.row(row);
    }
  }
  return table.text();
}

std::string heading(const Form& form, const Comparison& comparison) {
  const CompareOptions& options = comparison.options;
  std::string text =
      "# " + form.record.input.name + " at resolution " + number(std::int64_t{options.resolution}) + "\n\n" +
      number(std::int64_t{comparison.sites}) + " sites, cubes with the edge " + number(comparison.grid.edge) +
      ", cell size h " + number(comparison.cellSize) + ", diagonal of the solid's bounding box " +
      number(comparison.diagonal) + "; " + number(comparison.samples) +
      " samples on the surface S, a third of h apart, with a variation of " + number(comparison.sampleVariation) +
      "; " + number(std::int64_t{options.iterations}) + " iterations of the CVT's optimization, " +
      number(std::int64_t{options.delaunay.lloydIterations}) + " Lloyd steps of Delaunay refinement; seed " +
      std::to_string(options.seed) + ".\n\n";
  text +=
      "Distances are in the input's units, angles in radians; B is the tessellation's boundary. `cvt1@0` has the "
      "initial random sites.\n";
  return text;
}

struct Column {
  const char* name;
  std::function<std::string(const MethodOutcome&)> cell;
};

template <class Get>
Column accuracyColumn(const char* name, Get get) {
  return {name, [get](const MethodOutcome& outcome) {
            return outcome.accuracy ? exact(static_cast<double>(get(*outcome.accuracy))) : std::string();
          }};
}

// A value of the certificate and the like: methods that failed have none.
template <class Get>
Column measuredColumn(const char* name, Get get) {
  return {name, [get](const MethodOutcome& outcome) {
            return outcome.failure.empty() ? exact(static_cast<double>(get(outcome))) : std::string();
          }};
}

void addQualityColumns(std::vector<Column>& columns, const std::array<const char*, 4>& names,
                       std::optional<metrics::QualityStatistics> MethodOutcome::*quality) {
  for (std::size_t i = 0; i < names.size(); ++i) {
    columns.push_back({names[i], [i, quality](const MethodOutcome& outcome) {
                         const auto& statistics = outcome.*quality;
                         return statistics ? exact(statistics->mean[i]) : std::string();
                       }});
  }
}

// Seconds and memory, which differ from run to run, stand last.
std::vector<Column> csvColumns() {
  using A = metrics::Accuracy;
  using M = MethodOutcome;
  std::vector<Column> columns = {
      {"method", [](const M& m) { return m.method; }},
      {"equal_triangles_to", [](const M& m) { return m.matched; }},
      {"failure", [](const M& m) { return m.failure; }},
      measuredColumn("cube_edge", [](const M& m) { return m.cubeEdge; }),
      measuredColumn("valid", [](const M& m) { return m.measurement.certificate.valid ? 1 : 0; }),
      measuredColumn("cells", [](const M& m) { return m.cells; }),
      measuredColumn("vertices", [](const M& m) { return m.vertices; }),
      measuredColumn("boundary_triangles", [](const M& m) { return m.boundaryTriangles; }),
      accuracyColumn("dmean", [](const A& a) { return a.dmean; }),
      accuracyColumn("drmse", [](const A& a) { return a.drmse; }),
      accuracyColumn("dmax", [](const A& a) { return a.dmax; }),
      accuracyColumn("nmean", [](const A& a) { return a.nmean; }),
      accuracyColumn("nrmse", [](const A& a) { return a.nrmse; }),
      accuracyColumn("dmean_form_to_boundary", [](const A& a) { return a.fromForm.mean; }),
      accuracyColumn("dmean_boundary_to_form", [](const A& a) { return a.fromBoundary.mean; }),
      accuracyColumn("dmean_normal_line", [](const A& a) { return a.normalLine.mean; }),
      accuracyColumn("unfound", [](const A& a) { return a.fromForm.unfound + a.fromBoundary.unfound; }),
      measuredColumn("gmax", [](const M& m) { return m.measurement.regularity.all.max; }),
      measuredColumn("gmean", [](const M& m) { return m.measurement.regularity.all.mean; }),
      measuredColumn("gmedian", [](const M& m) { return m.measurement.regularity.all.median; }),
      measuredColumn("volume_error", [](const M& m) { return m.measurement.fidelity.volumeError; }),
      measuredColumn("missed_share", [](const M& m) { return m.measurement.fidelity.missedShare; }),
      measuredColumn("components", [](const M& m) { return m.measurement.certificate.components; }),
      measuredColumn("euler_characteristic", [](const M& m) { return m.measurement.certificate.eulerCharacteristic; })};
  addQualityColumns(columns, {"vq1", "vq2", "vq3", "vq4"}, &M::tetrahedra);
  addQualityColumns(columns, {"sq1", "sq2", "sq3", "sq4"}, &M::triangles);
  addQualityColumns(columns, {"dual_sq1", "dual_sq2", "dual_sq3", "dual_sq4"}, &M::dualTriangles);
  columns.push_back(measuredColumn("seconds", [](const M& m) { return m.seconds; }));
  columns.push_back({"peak_memory_bytes", [](const M& m) {
                       return m.peakMemoryBytes > 0 ? std::to_string(m.peakMemoryBytes) : std::string();
                     }});
  return columns;
}

}  // namespace

std::string comparisonCsv(const std::vector<MethodOutcome>& outcomes) {
  const std::vector<Column> columns = csvColumns();
  std::string text;
  for (const Column& column : columns) text += (text.empty() ? "" : ",") + std::string(column.name);
  text += '\n';
  for (const MethodOutcome& outcome : outcomes) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) text += ',';
      text += quoted(columns[i].cell(outcome));
    }
    text += '\n';
  }
  return text;
}

std::string comparisonMarkdown(const Form& form, const Comparison& comparison) {
  const std::vector<MethodOutcome>& methods = comparison.methods;
  std::string text = heading(form, comparison);
  text += "\n## At equal resolution\n\n### Accuracy and regularity (thesis, table 5.1)\n\n" + accuracyTable(methods);
  for (const char* baseline : {"mc", "delaunay"}) {
    if (accuracyOf(methods, baseline) == nullptr) continue;
    text += "\n### Accuracy relative to " + std::string(baseline) + "\n\n" + ratioTable(methods, baseline);
  }
  text += "\n### Accuracy in other units, by direction, and along the facets' normals\n\n" + unitsTable(methods);
  text +=
      "\n### Tetrahedra (thesis, table 5.2)\n\nMeans and worst values. VQ1 and VQ2: smallest and largest dihedral "
      "angle in degrees; VQ3: radius ratio; VQ4: meshing quality.\n\n" +
      tetrahedraTable(methods);
  text +=
      "\n### Boundary triangles (thesis, table 5.3)\n\nMeans and worst values. SQ1 and SQ2: smallest and largest "
      "angle in degrees; SQ3: radius ratio; SQ4: meshing quality.\n\n" +
      trianglesTable(methods);
  text += "\n### Cost (thesis, table 5.4) and size\n\n" + costTable(methods);
  if (!comparison.equalTriangles.empty()) {
    text +=
        "\n## At equal numbers of boundary triangles\n\nMarching Cubes and Delaunay refinement with cubes of another "
        "edge, until they have as many boundary triangles as the CVT.\n\n" +
        equalTrianglesTable(comparison);
  }
  if (!comparison.warnings.empty()) {
    text += "\n## Warnings\n\n";
    for (const std::string& warning : comparison.warnings) text += "- " + warning + '\n';
  }
  return text;
}

}  // namespace voroform::pipeline
