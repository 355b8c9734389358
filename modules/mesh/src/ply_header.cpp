#include "voroform/mesh/ply_header.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string_view>

#include "voroform/core/text_scanner.hpp"

namespace voroform::mesh {
namespace {

template <class T>
double decodeAs(const char* bytes, bool swapped) {
  std::array<char, sizeof(T)> copy;
  std::memcpy(copy.data(), bytes, sizeof(T));
  if (swapped) std::reverse(copy.begin(), copy.end());
  T value;
  std::memcpy(&value, copy.data(), sizeof(T));
  return static_cast<double>(value);
}

std::optional<ScalarType> scalarType(std::string_view name) {
  if (name == "char" || name == "int8") return ScalarType::int8;
  if (name == "uchar" || name == "uint8") return ScalarType::uint8;
  if (name == "short" || name == "int16") return ScalarType::int16;
  if (name == "ushort" || name == "uint16") return ScalarType::uint16;
  if (name == "int" || name == "int32") return ScalarType::int32;
  if (name == "uint" || name == "uint32") return ScalarType::uint32;
  if (name == "int64") return ScalarType::int64;
  if (name == "uint64") return ScalarType::uint64;
  if (name == "float" || name == "float32") return ScalarType::float32;
  if (name == "double" || name == "float64") return ScalarType::float64;
  return std::nullopt;
}

ScalarType expectType(LineScanner& scanner, const ByteSource& source) {
  const std::string_view word = scanner.word();
  const std::optional<ScalarType> type = scalarType(word);
  if (!type) source.failAtLine("a scalar type such as float or uchar", quotedToken(word));
  return *type;
}

PlyEncoding readFormat(LineScanner& scanner, const ByteSource& source) {
  const std::string_view word = scanner.word();
  PlyEncoding encoding = PlyEncoding::ascii;
  if (word == "binary_little_endian") {
    encoding = PlyEncoding::littleEndian;
  } else if (word == "binary_big_endian") {
    encoding = PlyEncoding::bigEndian;
  } else if (word != "ascii") {
    source.failAtLine("ascii, binary_little_endian or binary_big_endian", quotedToken(word));
  }
  const std::string_view version = scanner.word();
  if (version != "1.0") source.failAtLine("version 1.0", quotedToken(version));
  return encoding;
}

PlyProperty readProperty(LineScanner& scanner, const ByteSource& source) {
  PlyProperty property;
  LineScanner ahead = scanner;
  if (ahead.word() == "list") {
    scanner.word();
    property.isList = true;
    property.countType = expectType(scanner, source);
    if (property.countType == ScalarType::float32 || property.countType == ScalarType::float64) {
      source.failAtLine("an integer type for the length of a list", "a floating-point type");
    }
  }
  property.type = expectType(scanner, source);
  property.name = scanner.word();
  if (property.name.empty()) source.failAtLine("the name of the property", "the end of the line");
  return property;
}

PlyElement readElement(LineScanner& scanner, const ByteSource& source, const PlyHeader& header) {
  PlyElement element;
  element.name = scanner.word();
  element.count = scanner.count("the number of " + quotedToken(element.name) + " records");
  const bool isKnown = std::any_of(header.elements.begin(), header.elements.end(),
                                   [&](const PlyElement& other) { return other.name == element.name; });
  if (isKnown) source.failAtLine("every element once", "a second " + quotedToken(element.name));
  return element;
}

}  // namespace

std::size_t sizeOf(ScalarType type) {
  switch (type) {
    case ScalarType::int8:
    case ScalarType::uint8:
      return 1;
    case ScalarType::int16:
    case ScalarType::uint16:
      return 2;
    case ScalarType::int32:
    case ScalarType::uint32:
    case ScalarType::float32:
      return 4;
    case ScalarType::int64:
    case ScalarType::uint64:
    case ScalarType::float64:
      break;
  }
  return 8;
}

double decodeScalar(const char* bytes, ScalarType type, bool swapped) {
  switch (type) {
    case ScalarType::int8:
      return decodeAs<std::int8_t>(bytes, swapped);
    case ScalarType::uint8:
      return decodeAs<std::uint8_t>(bytes, swapped);
    case ScalarType::int16:
      return decodeAs<std::int16_t>(bytes, swapped);
    case ScalarType::uint16:
      return decodeAs<std::uint16_t>(bytes, swapped);
    case ScalarType::int32:
      return decodeAs<std::int32_t>(bytes, swapped);
    case ScalarType::uint32:
      return decodeAs<std::uint32_t>(bytes, swapped);
    case ScalarType::int64:
      return decodeAs<std::int64_t>(bytes, swapped);
    case ScalarType::uint64:
      return decodeAs<std::uint64_t>(bytes, swapped);
    case ScalarType::float32:
      return decodeAs<float>(bytes, swapped);
    case ScalarType::float64:
      break;
  }
  return decodeAs<double>(bytes, swapped);
}

bool PlyElement::hasList() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.isList; });
}

std::size_t PlyElement::stride() const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += sizeOf(property.type);
  return bytes;
}

PlyHeader readPlyHeader(ByteSource& source) {
  PlyHeader header;
  bool hasFormat = false;
  std::string_view line;
  if (!source.nextLine(line)) source.fail("the file is empty");
  if (line != "ply") source.failAtLine("\"ply\"", quotedToken(line));
  while (source.nextLine(line)) {
    LineScanner scanner(source, line);
    const std::string_view keyword = scanner.word();
    if (keyword.empty() || keyword == "comment" || keyword == "obj_info") continue;
    if (!hasFormat && keyword != "format") source.failAtLine("the line \"format …\"", quotedToken(line));
    if (keyword == "end_header") {
      scanner.expectEnd("end_header");
      return header;
    }
    if (keyword == "format") {
      if (hasFormat) source.failAtLine("one line \"format …\"", "a second one");
      header.encoding = readFormat(scanner, source);
      hasFormat = true;
    } else if (keyword == "element") {
      header.elements.push_back(readElement(scanner, source, header));
    } else if (keyword == "property") {
      if (header.elements.empty()) source.failAtLine("an element before its properties", quotedToken(line));
      header.elements.back().properties.push_back(readProperty(scanner, source));
    } else {
      source.failAtLine("element, property, comment or end_header", quotedToken(keyword));
    }
    scanner.expectEnd(keyword);
  }
  source.fail("file ends within the header (line " + std::to_string(source.line()) + ")");
}

}  // namespace voroform::mesh
