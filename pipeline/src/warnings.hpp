// Collects the warnings of a stage on their way to the caller's log.
#pragma once

#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"

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

// Warns of sites without a cell; `body` is what they filled.
inline void warnOfEmptySites(Index sites, const std::string& body, const RunContext& context) {
  if (sites == 0) return;
  context.warn(std::to_string(sites) +
               (sites == 1 ? " site ended without a cell and was" : " sites ended without a cell and were") +
               " dropped: some parts of the " + body + " are thinner than the cell size; more sites help");
}

// Warns of a certificate of validity that failed.
inline void warnOfProblems(const std::vector<std::string>& problems, const RunContext& context) {
  std::string list;
  for (const std::string& problem : problems) list += "; " + problem;
  context.warn("the certificate of validity failed" + list);
}

}  // namespace voroform::pipeline
