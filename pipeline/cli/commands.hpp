// The commands. Each reads its settings, does its work and returns the exit code.
#pragma once

#include "options.hpp"
#include "voroform/core/run_context.hpp"

namespace voroform::cli {

int runReconstruct(const Settings& settings, const CLI::App& command, const RunContext& context);
int runTessellate(const Settings& settings, const CLI::App& command, const RunContext& context);
int runEvaluate(const Settings& settings, const CLI::App& command, const RunContext& context);
int runCompare(const Settings& settings, const CLI::App& command, const RunContext& context);
int runRank(const Settings& settings, const CLI::App& command, const RunContext& context);
int runReproduce(const Settings& settings, const CLI::App& command, const RunContext& context);
int runPoints(const Settings& settings, const CLI::App& command, const RunContext& context);
int runImplicit(const Settings& settings, const CLI::App& command, const RunContext& context);
int runInfo(const Settings& settings, const CLI::App& command, const RunContext& context);

}  // namespace voroform::cli
