// The files of a ranking.
#pragma once

#include <optional>
#include <string>

#include "records.hpp"
#include "voroform/pipeline/rank.hpp"

namespace voroform::pipeline {

inline constexpr const char* kRankingsSchema = "voroform.rankings/1";
inline constexpr const char* kRankedRunSchema = "voroform.ranked-run/1";
// Stands beside a comparison of a ranking and says what it was made from; written last.
inline constexpr const char* kRankedRunFile = "ranked.json";

// Everything that a run's figures depend on.
Json runKeyJson(const RankOptions& options, const RankedRun& run);

Json rankedRunJson(const RankedRun& run);
// `name` stands in messages. Throws InputError.
RankedRun rankedRun(const Json& json, const std::string& name);

Json rankingsJson(const Rankings& rankings);
std::string rankingsCsv(const Rankings& rankings);
std::string rankingsMarkdown(const Rankings& rankings);
// Stacked bars as in figure 5.7 of the thesis, and a critical-difference diagram below each (Demšar 2006).
std::string rankingsSvg(const Rankings& rankings);

// "12.3", with so many significant digits; "–" for NaN.
std::string shortNumber(double value, int digits = 4);

}  // namespace voroform::pipeline
