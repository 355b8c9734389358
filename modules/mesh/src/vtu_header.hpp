// The XML part of a cells.vtu.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace voroform::mesh::vtu {

struct DataArray {
  std::string section;  // FieldData, Points, Cells, PointData, CellData
  std::string name;
  std::string type;
  std::uint64_t components = 1;
  std::uint64_t offset = 0;
};

struct Header {
  std::uint64_t points = 0;
  std::uint64_t cells = 0;
  std::vector<DataArray> arrays;
};

// Parses the text before the appended blocks. Throws InputError, its message starting with `file`.
Header parseHeader(std::string_view xml, const std::string& file);

}  // namespace voroform::mesh::vtu
