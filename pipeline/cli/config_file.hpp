#pragma once

#include <filesystem>

#include <CLI/CLI.hpp>

namespace voroform::cli {

// Hands the values of a TOML file to the command's options of the same long names, except to those that the command
// line has set. Throws UsageError naming the file and the line: unknown keys, wrong types, values out of range.
void applyConfigFile(CLI::App& command, const std::filesystem::path& path);

}  // namespace voroform::cli
