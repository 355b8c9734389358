#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "records.hpp"

namespace voroform::pipeline {

// SHA-256 of each of the files, by name.
Json filesJson(const std::filesystem::path& folder, const std::vector<std::string>& names);

// cells.vtu with volume, regularity and boundary flag of each cell.
void writeCells(const std::filesystem::path& path, const mesh::PolyhedralComplex& complex,
                const Measurement& measurement);

}  // namespace voroform::pipeline
