#include "records.hpp"

#include <limits>

#include "voroform/core/types.hpp"

namespace voroform::points {

std::string_view roleName(std::size_t role) {
  static constexpr std::array<std::string_view, 6> kNames{"x", "y", "z", "nx", "ny", "nz"};
  return kNames[role];
}

FieldRoles findRoles(const std::vector<std::string>& names, const ByteSource& source) {
  static constexpr std::array<std::string_view, 6> kLongNames{"x", "y", "z", "normal_x", "normal_y", "normal_z"};
  FieldRoles roles;
  for (std::size_t i = 0; i < names.size(); ++i) {
    for (std::size_t role = 0; role < 6; ++role) {
      if (names[i] != roleName(role) && names[i] != kLongNames[role]) continue;
      if (roles.field[role] >= 0) source.fail("the header names " + std::string(roleName(role)) + " twice");
      roles.field[role] = static_cast<int>(i);
    }
  }
  const bool anyNormal = roles.field[3] >= 0 || roles.field[4] >= 0 || roles.field[5] >= 0;
  for (std::size_t role = 0; role < (anyNormal ? 6U : 3U); ++role) {
    if (roles.field[role] < 0) {
      source.fail("the header does not name " + std::string(roleName(role)) +
                  (role < 3 ? " among the fields of a point" : ", though it names other components of a normal"));
    }
  }
  return roles;
}

void requireRoom(std::size_t points, const ByteSource& source) {
  if (points == static_cast<std::size_t>(std::numeric_limits<Index>::max())) {
    source.fail("holds more than " + std::to_string(points) + " points, the most that can be numbered");
  }
}

void CloudBuilder::add(const std::array<double, 6>& values) {
  requireRoom(size(), source_);
  cloud_.positions.emplace_back(values[0], values[1], values[2]);
  if (normals_) cloud_.normals.emplace_back(values[3], values[4], values[5]);
}

void readFixedRecords(ByteSource& source, std::uint64_t declared, std::size_t stride,
                      const std::array<RecordField, 6>& fields, bool normals, bool swapped, CloudBuilder& builder) {
  const std::size_t used = normals ? 6 : 3;
  std::array<double, 6> values{};
  for (std::uint64_t record = 0; record < declared; ++record) {
    const char* const bytes = source.take(stride);
    if (bytes == nullptr) source.failTruncated(declared, "points", record);
    for (std::size_t i = 0; i < used; ++i) {
      values[i] = decodeScalar(bytes + fields[i].offset, fields[i].type, swapped);
    }
    builder.add(values);
  }
}

}  // namespace voroform::points
