// Checks of options' values for CLI11, whose messages name the value and what is expected.
#pragma once

#include <charconv>
#include <sstream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace voroform::cli {

// The number that the text is, as a whole; CLI11 alone would take -1 for the largest unsigned number.
template <class T>
bool parse(const std::string& text, T& value) {
  const char* const end = text.data() + text.size();
  const auto parsed = std::from_chars(text.data(), end, value);
  return parsed.ec == std::errc() && parsed.ptr == end;
}

// Accepts numbers in [low, high]; the message names the value and the range.
template <class T>
CLI::Validator inRange(T low, T high) {
  std::ostringstream range;
  range << '[' << low << ", " << high << ']';
  CLI::Validator validator;
  validator.name("range")
      .description("in " + range.str())
      .operation([low, high, text = range.str()](std::string& input) {
        T value{};
        if (parse(input, value) && value >= low && value <= high) return std::string();
        return input + " is not in " + text;
      });
  return validator;
}

// That it is not negative; to stand before CLI::AsSizeValue.
CLI::Validator notNegative();

CLI::Validator oneOf(const std::vector<std::string>& names);

// A list of these names, separated by commas; `thing` is what one of them is.
CLI::Validator someOf(const std::string& thing, const std::vector<std::string>& names, bool orNone = false);

// The parts of a list separated by commas, without spaces around them.
std::vector<std::string> split(const std::string& list);

}  // namespace voroform::cli
