// What the formats with named fields (PLY, PCD) share: scalar types, the fields that matter, records of a fixed size.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "voroform/core/byte_source.hpp"
#include "voroform/mesh/ply_header.hpp"
#include "voroform/points/point_cloud.hpp"

namespace voroform::points {

using mesh::decodeScalar;
using mesh::ScalarType;
using mesh::sizeOf;

// For x, y, z, nx, ny, nz the index of the field that holds it, or -1.
struct FieldRoles {
  std::array<int, 6> field{-1, -1, -1, -1, -1, -1};
  bool hasNormals() const { return field[3] >= 0; }
};

// Finds the roles among the names (nx or normal_x, and so on). Throws InputError if x, y or z is missing, a role occurs
// twice or only some of the normal's components are there.
FieldRoles findRoles(const std::vector<std::string>& names, const ByteSource& source);

// Name of a role for messages.
std::string_view roleName(std::size_t role);

// Throws InputError if a cloud that holds `points` cannot take one more, since an Index could not number it.
void requireRoom(std::size_t points, const ByteSource& source);

// Appends points to a cloud.
class CloudBuilder {
 public:
  CloudBuilder(const ByteSource& source, bool normals) : source_(source), normals_(normals) {}
  // x y z and, with normals, nx ny nz.
  void add(const std::array<double, 6>& values);
  std::size_t size() const { return cloud_.positions.size(); }
  PointCloud& cloud() { return cloud_; }

 private:
  const ByteSource& source_;
  bool normals_;
  PointCloud cloud_;
};

struct RecordField {
  std::size_t offset = 0;
  ScalarType type = ScalarType::float32;
};

// Reads `declared` records of `stride` bytes, with the fields of x, y, z, nx, ny, nz (the first three without normals).
void readFixedRecords(ByteSource& source, std::uint64_t declared, std::size_t stride,
                      const std::array<RecordField, 6>& fields, bool normals, bool swapped, CloudBuilder& builder);

}  // namespace voroform::points
