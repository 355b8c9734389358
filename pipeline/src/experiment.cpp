#include "voroform/pipeline/experiment.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <system_error>

#include <toml++/toml.h>

#include "voroform/core/error.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/pipeline/compare.hpp"

namespace voroform::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kShapePrefix = "shape:";

// Access to a table that names the file, the line and the key in its messages, and knows which keys were asked for.
class TableReader {
 public:
  TableReader(const toml::table& table, std::string file, std::string section)
      : table_(table), file_(std::move(file)), section_(std::move(section)) {}

  [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& problem) const {
    throw UsageError(place(node) + section_ + key + ": " + problem);
  }
  [[noreturn]] void fail(const std::string& problem) const { throw UsageError(place(table_) + section_ + problem); }

  template <class T>
  T value(const toml::node& node, const std::string& key, const char* expected) const {
    if constexpr (std::is_same_v<T, double>) {
      if (const auto whole = node.as_integer()) return static_cast<double>(whole->get());
    }
    const auto* typed = node.as<T>();
    if (typed == nullptr) fail(node, key, std::string("expected ") + expected);
    return typed->get();
  }

  template <class T>
  void read(const std::string& key, T& target, const char* expected) {
    if (const toml::node* node = find(key)) target = value<T>(*node, key, expected);
  }

  void readList(const std::string& key, std::vector<std::string>& target) {
    readEach(key, "a list of texts", target,
             [&](const toml::node& element) { return value<std::string>(element, key, "a list of texts"); });
  }

  template <class T>
  void readIntegers(const std::string& key, std::int64_t low, std::int64_t high, std::vector<T>& target) {
    readEach(key, "a list of whole numbers", target,
             [&](const toml::node& element) { return static_cast<T>(integer(element, key, low, high)); });
  }

  void readInteger(const std::string& key, std::int64_t low, std::int64_t high, int& target) {
    if (const toml::node* node = find(key)) target = static_cast<int>(integer(*node, key, low, high));
  }

  const toml::node* find(const std::string& key) {
    known_.insert(key);
    return table_.get(key);
  }

  void refuseUnknownKeys() const {
    for (const auto& [key, node] : table_) {
      if (known_.contains(std::string(key.str()))) continue;
      std::string list;
      for (const std::string& name : known_) list += (list.empty() ? "" : ", ") + name;
      throw UsageError(place(node) + section_ + "unknown key \"" + std::string(key.str()) + "\"; expected one of " +
                       list);
    }
  }

 private:
  std::string place(const toml::node& node) const {
    return file_ + ":" + std::to_string(node.source().begin.line) + ": ";
  }

  std::int64_t integer(const toml::node& node, const std::string& key, std::int64_t low, std::int64_t high) const {
    const auto number = value<std::int64_t>(node, key, "a whole number");
    if (number < low || number > high) {
      fail(node, key,
           std::to_string(number) + " is not in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
    }
    return number;
  }

  template <class T, class Convert>
  void readEach(const std::string& key, const char* expected, std::vector<T>& target, const Convert& convert) {
    const toml::node* node = find(key);
    if (node == nullptr) return;
    const toml::array* list = node->as_array();
    if (list == nullptr) fail(*node, key, std::string("expected ") + expected);
    if (list->empty()) fail(*node, key, "the list is empty");
    target.clear();
    for (const toml::node& element : *list) {
      target.push_back(convert(element));
      if (std::count(target.begin(), target.end(), target.back()) > 1) fail(element, key, "a value stands there twice");
    }
  }

  const toml::table& table_;
  std::string file_;
  std::string section_;
  std::set<std::string> known_;
};

void requireOneOf(const TableReader& reader, const toml::node& node, const std::string& key, const std::string& value,
                  const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), value) != names.end()) return;
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  reader.fail(node, key, "unknown value \"" + value + "\"; expected one of " + list);
}

ExperimentInput inputOf(const toml::table& table, const std::string& fileName, const fs::path& data) {
  TableReader reader(table, fileName, "input, ");
  ExperimentInput input;
  std::string file;
  std::string shape;
  reader.read("file", file, "a text");
  reader.read("shape", shape, "a text");
  reader.read("name", input.name, "a text");
  reader.read("group", input.group, "a text");
  reader.refuseUnknownKeys();
  if (file.empty() == shape.empty()) reader.fail("expected either file or shape");
  if (!shape.empty()) {
    requireOneOf(reader, *reader.find("shape"), "shape", shape, implicit::shapeNames());
    input.input = std::string(kShapePrefix) + shape;
  } else {
    input.input = (data / file).lexically_normal().string();
  }
  if (input.group.empty()) reader.fail(*reader.find("group"), "group", "is empty");
  if (input.name.find('/') != std::string::npos || input.name.starts_with('.')) {
    reader.fail(*reader.find("name"), "name", "\"" + input.name + "\" cannot name a folder");
  }
  return input;
}

std::vector<ExperimentInput> inputsOf(TableReader& reader, const std::string& fileName, const fs::path& data) {
  const toml::node* node = reader.find("input");
  if (node == nullptr) reader.fail("input: expected at least one [[input]]");
  const toml::array* list = node->as_array();
  if (list == nullptr) reader.fail(*node, "input", "expected [[input]], a list of tables");
  std::vector<ExperimentInput> inputs;
  for (const toml::node& element : *list) {
    const toml::table* table = element.as_table();
    if (table == nullptr) reader.fail(element, "input", "expected [[input]], a list of tables");
    inputs.push_back(inputOf(*table, fileName, data));
  }
  try {
    nameInputs(inputs);
  } catch (const UsageError& error) {
    reader.fail(*node, "input", error.what());
  }
  return inputs;
}

// What a file's results are called: the stem, or the whole name.
std::string defaultName(const std::string& input, bool withExtension) {
  if (input.starts_with(kShapePrefix)) return input.substr(kShapePrefix.size());
  const fs::path path(input);
  return (withExtension ? path.filename() : path.stem()).string();
}

}  // namespace

std::vector<std::string> validate(const Experiment& experiment) {
  std::vector<std::string> problems;
  if (experiment.inputs.empty()) problems.emplace_back("inputs: there is none");
  if (experiment.methods.size() < 2) problems.emplace_back("methods: at least two are needed to rank them");
  for (const std::string& method : experiment.methods) {
    const auto& names = methodNames();
    if (std::find(names.begin(), names.end(), method) == names.end()) {
      problems.push_back("methods: unknown method \"" + method + "\"");
    }
  }
  if (experiment.resolutions.empty()) problems.emplace_back("resolutions: there is none");
  if (experiment.seeds.empty()) problems.emplace_back("seeds: there is none");
  if (experiment.iterations < 0) {
    problems.push_back("iterations: " + std::to_string(experiment.iterations) + " is negative");
  }
  if (!(experiment.delaunayTimeLimit >= 0) || !std::isfinite(experiment.delaunayTimeLimit)) {
    problems.emplace_back("delaunay-time-limit: expected a number of seconds, 0 or more");
  }
  if (experiment.implicit != "distance" && experiment.implicit != "poisson") {
    problems.push_back("implicit: unknown value \"" + experiment.implicit + "\"; expected distance or poisson");
  }
  return problems;
}

void nameInputs(std::vector<ExperimentInput>& inputs) {
  std::map<std::string, int> uses;
  const auto proposed = [](const ExperimentInput& input, bool withExtension) {
    return input.name.empty() ? defaultName(input.input, withExtension) : input.name;
  };
  for (const ExperimentInput& input : inputs) ++uses[proposed(input, false)];
  std::map<std::string, std::string> owners;
  for (ExperimentInput& input : inputs) {
    input.name = proposed(input, uses[proposed(input, false)] > 1);
    const auto [known, added] = owners.emplace(input.name, input.input);
    if (!added) {
      throw UsageError(input.input + " and " + known->second + " would both be called \"" + input.name +
                       "\"; their results need different names");
    }
  }
}

Experiment parseExperiment(std::string_view text, const std::string& fileName, const fs::path& data) {
  toml::table table;
  try {
    table = toml::parse(text, fileName);
  } catch (const toml::parse_error& error) {
    throw UsageError(fileName + ":" + std::to_string(error.source().begin.line) + ": " +
                     std::string(error.description()));
  }
  constexpr std::int64_t kLargest = std::numeric_limits<std::int64_t>::max();
  TableReader reader(table, fileName, "");
  Experiment experiment;
  experiment.methods = defaultMethods();
  reader.read("name", experiment.name, "a text");
  reader.readList("methods", experiment.methods);
  for (const std::string& method : experiment.methods) {
    requireOneOf(reader, *reader.find("methods"), "methods", method, methodNames());
  }
  reader.readIntegers("resolutions", 4, 1000, experiment.resolutions);
  reader.readIntegers("seeds", 0, kLargest, experiment.seeds);
  reader.readInteger("iterations", 0, 1'000'000, experiment.iterations);
  reader.read("equal-triangles", experiment.equalTriangles, "true or false");
  reader.read("delaunay-time-limit", experiment.delaunayTimeLimit, "a number of seconds");
  reader.read("implicit", experiment.implicit, "a text");
  reader.read("rotate", experiment.rotate, "true or false");
  experiment.inputs = inputsOf(reader, fileName, data);
  reader.refuseUnknownKeys();
  const std::vector<std::string> problems = validate(experiment);
  if (!problems.empty()) throw UsageError(fileName + ": " + problems.front());
  return experiment;
}

Experiment readExperiment(const fs::path& path, const fs::path& data) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw UsageError(path.string() + ": expected a file, found a folder");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw UsageError(path.string() + ": cannot be opened");
  const std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  return parseExperiment(text, path.string(), data);
}

}  // namespace voroform::pipeline
