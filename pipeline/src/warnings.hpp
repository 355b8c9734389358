// Collects the warnings of a stage on their way to the caller's log.
#pragma once

#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"

namespace voroform::pipeline {

// A context that logs as `context` does and appends the warnings to `warnings`, which must outlive it.
inline RunContext recordWarnings(const RunContext& context, std::vector<std::string>& warnings) {
  RunContext recording = context;
  recording.log = [log = context.log, &warnings](LogLevel level, std::string_view message) {
    if (level == LogLevel::warning) warnings.emplace_back(message);
    if (log) log(level, message);
  };
  return recording;
}

}  // namespace voroform::pipeline
