// What a reader makes of the bytes of a file.
#pragma once

#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "voroform/core/error.hpp"
#include "voroform/core/run_context.hpp"

namespace voroform::test {

template <class Result>
struct ReadOutcome {
  Result result;
  std::string error;  // the InputError's message; empty if there was none
  std::vector<std::string> warnings;
};

// Calls read(stream, context) with a stream of the bytes.
template <class Result, class Read>
ReadOutcome<Result> readOutcome(const std::string& bytes, const Read& read) {
  ReadOutcome<Result> outcome;
  RunContext context;
  context.log = [&](LogLevel level, std::string_view message) {
    if (level == LogLevel::warning) outcome.warnings.emplace_back(message);
  };
  std::istringstream stream(bytes);
  try {
    outcome.result = read(stream, context);
  } catch (const InputError& error) {
    outcome.error = error.what();
  }
  return outcome;
}

}  // namespace voroform::test
