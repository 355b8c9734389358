// Reading and writing point clouds. Formats by extension: .ply (ascii, binary both ways), .xyz .xyzn .pwn .txt (text),
// .pcd (ascii, binary, binary_compressed), .off (vertices). Described in docs/formats-input.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <string>

#include "voroform/core/run_context.hpp"
#include "voroform/points/point_cloud.hpp"

namespace voroform::points {

// What a file held before cleaning.
struct ReadSummary {
  std::string format;         // e.g. "PLY binary_little_endian"
  std::uint64_t records = 0;  // points the file holds
  std::uint64_t faces = 0;    // faces the file declares (a file with faces is a mesh)
  bool normals = false;
};

struct ReadResult {
  PointCloud cloud;  // raw: frame at 0, coordinates as in the file, NaN and duplicates included
  ReadSummary summary;
};

// Throws InputError naming the file and the line or record, what was expected and what was found. Never allocates for
// a declared size before the bytes are there.
ReadResult readPoints(const std::filesystem::path& path, const RunContext& context);

// The same from a stream; `format` is the lower-case extension with its dot, `name` stands in messages.
ReadResult readPoints(std::istream& stream, const std::string& format, const std::string& name,
                      const RunContext& context);

// Binary little-endian PLY with Float64 x y z and, if there are any, nx ny nz; world coordinates.
void writePointsPly(const std::filesystem::path& path, const PointCloud& cloud);

}  // namespace voroform::points
