// The header of an OFF file (Geomview).
#pragma once

#include <cstdint>
#include <string_view>

#include "voroform/core/byte_source.hpp"

namespace voroform::mesh {

struct OffHeader {
  bool normals = false;  // a normal behind each position
  bool extras = false;   // colors or texture coordinates after position and normal
  std::uint64_t vertices = 0;
  std::uint64_t faces = 0;
};

// Reads the word [ST][C][N]OFF and the counts. Throws InputError at the first line that is not of the format.
OffHeader readOffHeader(ByteSource& source);

// The next line that holds more than blanks and a comment; false at the end of the file.
bool nextOffLine(ByteSource& source, std::string_view& line);

// Says through the context that there is such a line behind what the header declares, and where.
void warnOfExtraOffLines(ByteSource& source);

}  // namespace voroform::mesh
