// The header and the scalars of a PLY file (G. Turk, The PLY Polygon File Format, 1994).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "voroform/core/byte_source.hpp"

namespace voroform::mesh {

enum class ScalarType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

std::size_t sizeOf(ScalarType type);
// The scalar stored at `bytes`; `swapped` if its byte order is not the machine's.
double decodeScalar(const char* bytes, ScalarType type, bool swapped);

enum class PlyEncoding { ascii, littleEndian, bigEndian };

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::float32;
  bool isList = false;
  ScalarType countType = ScalarType::uint8;  // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool hasList() const;
  // Bytes of a binary record without lists.
  std::size_t stride() const;
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
};

// Reads up to and with the line "end_header". Throws InputError at the first line that is not of the format.
PlyHeader readPlyHeader(ByteSource& source);

}  // namespace voroform::mesh
