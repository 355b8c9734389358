#include "validators.hpp"

#include <algorithm>

namespace voroform::cli {

CLI::Validator notNegative() {
  CLI::Validator validator;
  validator.name("not negative").operation([](std::string& input) {
    return input.find('-') == std::string::npos ? std::string() : input + " is not a size";
  });
  return validator;
}

CLI::Validator oneOf(const std::vector<std::string>& names) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  CLI::Validator validator;
  validator.name("choice").description("one of " + list).operation([names, list](std::string& input) {
    for (const std::string& name : names) {
      if (input == name) return std::string();
    }
    return "unknown value " + input + "; expected one of " + list;
  });
  return validator;
}

CLI::Validator someOf(const std::string& thing, const std::vector<std::string>& names, bool orNone) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ",") + name;
  CLI::Validator validator;
  validator.name(thing + "s").description("of " + all).operation([thing, names, all, orNone](std::string& input) {
    if (!orNone && split(input).empty()) return "no " + thing + "; expected some of " + all;
    for (const std::string& part : split(input)) {
      if (std::find(names.begin(), names.end(), part) == names.end()) {
        return "unknown " + thing + " " + part + "; expected some of " + all;
      }
    }
    return std::string();
  });
  return validator;
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  std::stringstream stream(list);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(CLI::detail::trim_copy(part));
  return parts;
}

}  // namespace voroform::cli
