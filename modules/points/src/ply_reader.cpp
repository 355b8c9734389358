#include <algorithm>
#include <bit>
#include <limits>

#include "readers.hpp"
#include "records.hpp"
#include "voroform/core/text_scanner.hpp"
#include "voroform/mesh/ply_header.hpp"

namespace voroform::points {

using mesh::PlyElement;
using mesh::PlyEncoding;
using mesh::PlyHeader;
using mesh::PlyProperty;

namespace {

// Receives the value of a property that is no list.
struct Ignore {
  void operator()(std::size_t, double) const {}
};

std::string thingsOf(const PlyElement& element) {
  return element.name == "vertex" ? "points" : element.name + " records";
}

// One record of an ASCII file: a line.
template <class Receive>
void readAsciiRecord(ByteSource& source, const PlyElement& element, std::uint64_t record, const Receive& receive) {
  std::string_view line;
  do {
    if (!source.nextLine(line)) {
      source.failTruncated(element.count, thingsOf(element), record);
    }
  } while (LineScanner(source, line).atEnd());
  LineScanner scanner(source, line);
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (!property.isList) {
      receive(i, scanner.number(property.name));
      continue;
    }
    const std::uint64_t length = scanner.count("the length of a list");
    for (std::uint64_t k = 0; k < length; ++k) scanner.number(property.name);
  }
  scanner.expectEnd("the record");
}

// One record of a binary file whose size lists make vary. Returns false if the file ends before it is complete.
template <class Receive>
bool readBinaryRecord(ByteSource& source, const PlyElement& element, bool swapped, std::uint64_t record,
                      const Receive& receive) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (!property.isList) {
      const char* const bytes = source.take(sizeOf(property.type));
      if (bytes == nullptr) return false;
      receive(i, decodeScalar(bytes, property.type, swapped));
      continue;
    }
    const char* const bytes = source.take(sizeOf(property.countType));
    if (bytes == nullptr) return false;
    const double length = decodeScalar(bytes, property.countType, swapped);
    if (length < 0) {
      source.fail("record " + std::to_string(record + 1) + " of element " + element.name +
                  ": expected the length of a list, found a negative number");
    }
    // Lengths beyond 2^53 cannot be exact here and cannot be in a file either: the skip runs into its end.
    const double bytesToSkip = length * static_cast<double>(sizeOf(property.type));
    constexpr double kMost = 9.0e18;
    if (!source.skip(static_cast<std::uint64_t>(std::min(bytesToSkip, kMost)))) return false;
  }
  return true;
}

void skipElement(ByteSource& source, const PlyHeader& header, const PlyElement& element, bool swapped) {
  if (element.properties.empty()) return;
  if (header.encoding == PlyEncoding::ascii) {
    for (std::uint64_t i = 0; i < element.count; ++i) readAsciiRecord(source, element, i, Ignore());
  } else if (element.hasList()) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (!readBinaryRecord(source, element, swapped, i, Ignore())) {
        source.failTruncated(element.count, thingsOf(element), i);
      }
    }
  } else {
    const std::size_t stride = element.stride();
    for (std::uint64_t i = 0; i < element.count; ++i) {
      if (!source.skip(stride)) source.failTruncated(element.count, thingsOf(element), i);
    }
  }
}

// For each property the role it plays, or -1.
std::vector<int> rolesByProperty(const FieldRoles& roles, std::size_t properties) {
  std::vector<int> result(properties, -1);
  for (std::size_t role = 0; role < 6; ++role) {
    if (roles.field[role] >= 0) result[static_cast<std::size_t>(roles.field[role])] = static_cast<int>(role);
  }
  return result;
}

void readVertices(ByteSource& source, const PlyHeader& header, const PlyElement& element, const FieldRoles& roles,
                  bool swapped, CloudBuilder& builder) {
  if (header.encoding != PlyEncoding::ascii && !element.hasList()) {
    std::array<RecordField, 6> fields;
    for (std::size_t role = 0; role < 6; ++role) {
      for (int i = 0; i < roles.field[role]; ++i) {
        fields[role].offset += sizeOf(element.properties[static_cast<std::size_t>(i)].type);
      }
      if (roles.field[role] >= 0) {
        fields[role].type = element.properties[static_cast<std::size_t>(roles.field[role])].type;
      }
    }
    readFixedRecords(source, element.count, element.stride(), fields, roles.hasNormals(), swapped, builder);
    return;
  }
  const std::vector<int> role = rolesByProperty(roles, element.properties.size());
  std::array<double, 6> values{};
  const auto receive = [&](std::size_t property, double value) {
    if (role[property] >= 0) values[static_cast<std::size_t>(role[property])] = value;
  };
  for (std::uint64_t i = 0; i < element.count; ++i) {
    if (header.encoding == PlyEncoding::ascii) {
      readAsciiRecord(source, element, i, receive);
    } else if (!readBinaryRecord(source, element, swapped, i, receive)) {
      source.failTruncated(element.count, thingsOf(element), i);
    }
    builder.add(values);
  }
}

FieldRoles rolesOf(const PlyElement& vertex, const ByteSource& source) {
  std::vector<std::string> names;
  for (const PlyProperty& property : vertex.properties) names.push_back(property.name);
  const FieldRoles roles = findRoles(names, source);
  for (std::size_t role = 0; role < 6; ++role) {
    if (roles.field[role] >= 0 && vertex.properties[static_cast<std::size_t>(roles.field[role])].isList) {
      source.fail("the header makes " + std::string(roleName(role)) + " a list");
    }
  }
  if (vertex.stride() > ByteSource::kBlockBytes) {
    source.fail("the header declares records of " + std::to_string(vertex.stride()) + " bytes, at most " +
                std::to_string(ByteSource::kBlockBytes) + " are supported");
  }
  return roles;
}

}  // namespace

ReadResult readPly(ByteSource& source) {
  const PlyHeader header = mesh::readPlyHeader(source);
  const auto vertex = std::find_if(header.elements.begin(), header.elements.end(),
                                   [](const PlyElement& element) { return element.name == "vertex"; });
  if (vertex == header.elements.end()) source.fail("the header declares no element vertex");
  const FieldRoles roles = rolesOf(*vertex, source);
  const bool isAscii = header.encoding == PlyEncoding::ascii;
  const bool isBigMachine = std::endian::native == std::endian::big;
  const bool swapped = !isAscii && (header.encoding == PlyEncoding::bigEndian) != isBigMachine;

  ReadResult result;
  CloudBuilder builder(source, roles.hasNormals());
  for (const PlyElement& element : header.elements) {
    if (element.name == "face" || element.name == "tristrips") result.summary.faces += element.count;
    if (&element == &*vertex) {
      readVertices(source, header, element, roles, swapped, builder);
    } else {
      skipElement(source, header, element, swapped);
    }
  }
  if (isAscii) {
    warnOfExtraLines(source);
  } else {
    warnOfExtraData(source);
  }
  result.summary.format = isAscii                                        ? "PLY ascii"
                          : header.encoding == PlyEncoding::littleEndian ? "PLY binary_little_endian"
                                                                         : "PLY binary_big_endian";
  result.summary.records = builder.size();
  result.summary.normals = roles.hasNormals();
  result.cloud = std::move(builder.cloud());
  return result;
}

}  // namespace voroform::points
