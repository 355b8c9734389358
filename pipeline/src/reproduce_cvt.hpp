// The thesis's tables on regular CVTs (chapters 3 and 4).
#pragma once

#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/pipeline/reproduce.hpp"

namespace voroform::pipeline {

// Whether the table is one of them.
bool isCvtTable(const std::string& table);

// Runs each method on each data set that the figures name, with as many seeds as asked for where they are medians.
// Throws InputError for a mesh that is missing.
void reproduceCvts(const std::vector<PublishedFigure>& published, Reproduction& result, const RunContext& context);

// The curves of a reproduction.
std::string curvesCsv(const std::vector<Curve>& curves);
std::string curvesSvg(const std::vector<Curve>& curves);

}  // namespace voroform::pipeline
