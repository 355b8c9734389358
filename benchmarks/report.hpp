// What every benchmark prints: one JSON object a line.
#pragma once

#include <iostream>
#include <string>

#include <nlohmann/json.hpp>

namespace voroform::benchmarks {

// A figure measured; `bound` is the largest value that passes.
inline void report(const std::string& point, const std::string& figure, double value, double bound) {
  std::cout << nlohmann::json{{"point", point}, {"figure", figure}, {"value", value}, {"bound", bound}}.dump()
            << std::endl;
}

// A figure that has to lie between two bounds.
inline void report(const std::string& point, const std::string& figure, double value, double low, double high) {
  std::cout
      << nlohmann::json{{"point", point}, {"figure", figure}, {"value", value}, {"low", low}, {"bound", high}}.dump()
      << std::endl;
}

// A figure without a bound.
inline void report(const std::string& point, const std::string& figure, double value) {
  std::cout << nlohmann::json{{"point", point}, {"figure", figure}, {"value", value}}.dump() << std::endl;
}

}  // namespace voroform::benchmarks
