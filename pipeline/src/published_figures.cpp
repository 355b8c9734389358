// The papers' figures, read from the tables that are built in.
#include <algorithm>
#include <charconv>
#include <string>

#include "embedded_files.hpp"
#include "voroform/core/error.hpp"
#include "voroform/pipeline/reproduce.hpp"

namespace voroform::pipeline {

namespace {

constexpr std::string_view kHeader = "table,page,data_set,sites,method,criterion,value,note";
constexpr std::size_t kColumns = 8;

// Fields of one line; quoted ones may hold commas, and quotes doubled (RFC 4180).
std::vector<std::string> fieldsOf(std::string_view line) {
  std::vector<std::string> fields(1);
  bool inQuotes = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && inQuotes && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += c;
      ++i;
    } else if (c == '"') {
      inQuotes = !inQuotes;
    } else if (c == ',' && !inQuotes) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

template <class T>
T numberOf(const std::string& text, const std::string& where) {
  T value{};
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end) {
    throw InputError(where + "expected a number, found \"" + text + "\"");
  }
  return value;
}

std::string fileOf(const std::string& table) {
  return "published/" + (table.starts_with("figure") ? table : "table-" + table) + ".csv";
}

}  // namespace

const std::vector<std::string>& reproducibleTables() {
  static const std::vector<std::string> tables = {"3.1", "3.2",        "4.1",        "4.2",         "4.3",       "4.4",
                                                  "4.5", "4.6",        "4.7",        "5.1",         "5.2",       "5.3",
                                                  "5.4", "figure-3.8", "figure-3.9", "figure-4.10", "figure-5.7"};
  return tables;
}

std::vector<PublishedFigure> publishedFigures(const std::string& table) {
  const auto& tables = reproducibleTables();
  if (std::find(tables.begin(), tables.end(), table) == tables.end()) {
    throw UsageError("unknown table " + table);
  }
  const std::string file = fileOf(table);
  std::string_view rest = embeddedFile(file);
  std::vector<PublishedFigure> figures;
  for (int line = 1; !rest.empty(); ++line) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view text = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::string where = "eval/" + file + ":" + std::to_string(line) + ": ";
    if (line == 1) {
      if (text != kHeader) throw InputError(where + "expected the header " + std::string(kHeader));
      continue;
    }
    const std::vector<std::string> fields = fieldsOf(text);
    if (fields.size() != kColumns) {
      throw InputError(where + "expected " + std::to_string(kColumns) + " columns, found " +
                       std::to_string(fields.size()));
    }
    PublishedFigure figure;
    figure.table = fields[0];
    figure.page = numberOf<int>(fields[1], where);
    figure.dataSet = fields[2];
    if (!fields[3].empty()) figure.sites = numberOf<Index>(fields[3], where);
    figure.method = fields[4];
    figure.criterion = fields[5];
    figure.value = numberOf<double>(fields[6], where);
    figure.note = fields[7];
    figures.push_back(std::move(figure));
  }
  return figures;
}

}  // namespace voroform::pipeline
