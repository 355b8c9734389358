#include "config_file.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include <toml++/toml.h>

#include "voroform/core/error.hpp"

namespace voroform::cli {

namespace {

std::string place(const std::filesystem::path& path, const toml::source_region& source) {
  return path.string() + ":" + std::to_string(source.begin.line) + ": ";
}

// The value as it would stand on the command line.
std::string valueText(const toml::node& node, const std::string& where, const std::string& key) {
  if (const auto text = node.as_string()) return text->get();
  if (const auto number = node.as_integer()) return std::to_string(number->get());
  if (const auto flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (const auto number = node.as_floating_point()) {
    std::array<char, 32> digits;
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), number->get()).ptr;
    return {digits.data(), end};
  }
  if (const auto list = node.as_array()) {
    std::string joined;
    for (const toml::node& element : *list) joined += (joined.empty() ? "" : ",") + valueText(element, where, key);
    return joined;
  }
  throw UsageError(where + key + ": expected a text, a number, a truth value or a list");
}

}  // namespace

void applyConfigFile(CLI::App& command, const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw UsageError(path.string() + ": expected a file, found a folder");
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw UsageError(path.string() + ": cannot be opened: " + std::strerror(errno));
  toml::table table;
  try {
    table = toml::parse(stream, path.string());
  } catch (const toml::parse_error& error) {
    throw UsageError(place(path, error.source()) + std::string(error.description()));
  }
  for (const auto& [tomlKey, node] : table) {
    const std::string key(tomlKey.str());
    const std::string where = place(path, node.source());
    CLI::Option* option = command.get_option_no_throw("--" + key);
    if (option == nullptr || key == "config" || key == "help") {
      throw UsageError(where + "unknown key \"" + key + "\" for the command " + command.get_name());
    }
    const std::string value = valueText(node, where, key);
    if (option->get_items_expected_max() == 0 && !node.is_boolean()) {
      throw UsageError(where + key + ": expected true or false, found " + value);
    }
    if (option->count() > 0) continue;
    try {
      option->add_result(value);
      option->run_callback();
    } catch (const CLI::ParseError& error) {
      throw UsageError(where + error.what());
    }
  }
}

}  // namespace voroform::cli
