// PCD, the file format of the Point Cloud Library, version 0.7.
#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
#include <utility>

#include "lzf.hpp"
#include "readers.hpp"
#include "records.hpp"
#include "voroform/core/text_scanner.hpp"

namespace voroform::points {
namespace {

struct PcdField {
  std::string name;
  std::uint64_t size = 4;
  char type = 'F';
  std::uint64_t count = 1;
  std::size_t offset = 0;  // bytes from the start of a record
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
  std::string encoding;
  std::size_t stride = 0;  // bytes of a record
};

ScalarType scalarType(const PcdField& field, const ByteSource& source) {
  if (field.type == 'F' && field.size == 4) return ScalarType::float32;
  if (field.type == 'F' && field.size == 8) return ScalarType::float64;
  static constexpr std::array<ScalarType, 4> kSigned{ScalarType::int8, ScalarType::int16, ScalarType::int32,
                                                     ScalarType::int64};
  static constexpr std::array<ScalarType, 4> kUnsigned{ScalarType::uint8, ScalarType::uint16, ScalarType::uint32,
                                                       ScalarType::uint64};
  if ((field.type == 'I' || field.type == 'U') && std::has_single_bit(field.size) && field.size <= 8) {
    const auto index = static_cast<std::size_t>(std::countr_zero(field.size));
    return field.type == 'I' ? kSigned[index] : kUnsigned[index];
  }
  source.fail("the header gives field " + quotedToken(field.name) + " the type " + std::string(1, field.type) +
              std::to_string(field.size) + ", which PCD does not know");
}

class PcdHeaderReader {
 public:
  explicit PcdHeaderReader(ByteSource& source) : source_(source) {}

  PcdHeader read() {
    std::string_view line;
    while (header_.encoding.empty()) {
      if (!source_.nextLine(line)) {
        source_.fail(source_.line() == 0 ? "the file is empty"
                                         : "file ends within the header (line " + std::to_string(source_.line()) + ")");
      }
      LineScanner scanner(source_, line);
      const std::string_view keyword = scanner.word();
      if (!keyword.empty() && keyword.front() != '#') readLine(keyword, scanner);
    }
    finish();
    return std::move(header_);
  }

 private:
  void readLine(std::string_view keyword, LineScanner& scanner) {
    if (keyword == "VERSION" || keyword == "VIEWPOINT") return;
    if (keyword == "FIELDS" || keyword == "COLUMNS") {
      if (!header_.fields.empty()) source_.failAtLine("one line FIELDS", "a second one");
      while (!scanner.atEnd()) header_.fields.push_back({std::string(scanner.word()), 4, 'F', 1, 0});
    } else if (keyword == "SIZE") {
      for (PcdField& field : header_.fields) field.size = scanner.count("the size of " + quotedToken(field.name));
    } else if (keyword == "TYPE") {
      for (PcdField& field : header_.fields) {
        const std::string_view type = scanner.word();
        if (type != "F" && type != "I" && type != "U") source_.failAtLine("the type F, I or U", quotedToken(type));
        field.type = type.front();
      }
    } else if (keyword == "COUNT") {
      for (PcdField& field : header_.fields) field.count = scanner.count("the count of " + quotedToken(field.name));
    } else if (keyword == "WIDTH") {
      width_ = scanner.count("the width");
    } else if (keyword == "HEIGHT") {
      height_ = scanner.count("the height");
    } else if (keyword == "POINTS") {
      points_ = scanner.count("the number of points");
    } else if (keyword == "DATA") {
      header_.encoding = scanner.word();
      if (header_.encoding != "ascii" && header_.encoding != "binary" && header_.encoding != "binary_compressed") {
        source_.failAtLine("ascii, binary or binary_compressed", quotedToken(header_.encoding));
      }
    } else {
      source_.failAtLine("a line of a PCD header (FIELDS, SIZE, TYPE, …)", quotedToken(keyword));
    }
    scanner.expectEnd(keyword);
  }

  void finish() {
    if (header_.fields.empty()) source_.fail("the header has no line FIELDS");
    if (!points_ && !width_) source_.fail("the header has neither POINTS nor WIDTH");
    if (width_) {
      const std::uint64_t height = height_.value_or(1);
      const bool overflows = height != 0 && *width_ > std::numeric_limits<std::uint64_t>::max() / height;
      if (overflows || (points_ && *points_ != *width_ * height)) {
        source_.fail("the header declares WIDTH " + std::to_string(*width_) + " × HEIGHT " + std::to_string(height) +
                     (points_ ? ", but POINTS " + std::to_string(*points_) : std::string(": too many points")));
      }
      points_ = *width_ * height;
    }
    header_.points = *points_;
    for (PcdField& field : header_.fields) {
      const std::size_t size = sizeOf(scalarType(field, source_));
      field.offset = header_.stride;
      if (field.count > ByteSource::kBlockBytes || header_.stride + size * field.count > ByteSource::kBlockBytes) {
        source_.fail("the header declares records of more than " + std::to_string(ByteSource::kBlockBytes) + " bytes");
      }
      header_.stride += size * static_cast<std::size_t>(field.count);
    }
  }

  ByteSource& source_;
  PcdHeader header_;
  std::optional<std::uint64_t> width_;
  std::optional<std::uint64_t> height_;
  std::optional<std::uint64_t> points_;
};

FieldRoles rolesOf(const PcdHeader& header, const ByteSource& source) {
  std::vector<std::string> names;
  for (const PcdField& field : header.fields) names.push_back(field.name);
  const FieldRoles roles = findRoles(names, source);
  for (std::size_t role = 0; role < 6; ++role) {
    if (roles.field[role] >= 0 && header.fields[static_cast<std::size_t>(roles.field[role])].count != 1) {
      source.fail("the header gives field " + std::string(roleName(role)) + " a count other than 1");
    }
  }
  return roles;
}

void readAscii(ByteSource& source, const PcdHeader& header, const FieldRoles& roles, CloudBuilder& builder) {
  std::array<double, 6> values{};
  std::string_view line;
  for (std::uint64_t record = 0; record < header.points; ++record) {
    do {
      if (!source.nextLine(line)) source.failTruncated(header.points, "points", record);
    } while (LineScanner(source, line).atEnd());
    LineScanner scanner(source, line);
    for (std::size_t i = 0; i < header.fields.size(); ++i) {
      const PcdField& field = header.fields[i];
      double value = 0;
      for (std::uint64_t k = 0; k < field.count; ++k) value = scanner.number(field.name);
      for (std::size_t role = 0; role < 6; ++role) {
        if (roles.field[role] == static_cast<int>(i)) values[role] = value;
      }
    }
    scanner.expectEnd("the record");
    builder.add(values);
  }
}

std::array<RecordField, 6> recordFields(const PcdHeader& header, const FieldRoles& roles, const ByteSource& source) {
  std::array<RecordField, 6> fields;
  for (std::size_t role = 0; role < 6; ++role) {
    if (roles.field[role] < 0) continue;
    const PcdField& field = header.fields[static_cast<std::size_t>(roles.field[role])];
    fields[role] = {field.offset, scalarType(field, source)};
  }
  return fields;
}

std::size_t readSize(ByteSource& source, std::string_view what, bool swapped) {
  const char* const bytes = source.take(4);
  if (bytes == nullptr) source.fail("file ends before the " + std::string(what) + " size");
  return static_cast<std::size_t>(decodeScalar(bytes, ScalarType::uint32, swapped));
}

// Field after field, each for all points, in one LZF block.
void readCompressed(ByteSource& source, const PcdHeader& header, const FieldRoles& roles, bool swapped,
                    CloudBuilder& builder) {
  const std::size_t compressedSize = readSize(source, "compressed", swapped);
  const std::size_t size = readSize(source, "uncompressed", swapped);
  if (header.points > size || header.points * header.stride != size) {
    source.fail("declares " + std::to_string(header.points) + " points of " + std::to_string(header.stride) +
                " bytes, but " + std::to_string(size) + " bytes of uncompressed data");
  }
  std::vector<char> compressed;
  while (compressed.size() < compressedSize) {
    const std::size_t piece = std::min(compressedSize - compressed.size(), ByteSource::kBlockBytes);
    const char* const bytes = source.take(piece);
    if (bytes == nullptr) {
      source.fail("declares " + std::to_string(compressedSize) + " bytes of compressed data, file ends before");
    }
    compressed.insert(compressed.end(), bytes, bytes + piece);
  }
  std::vector<char> data;
  if (!decodeLzf({compressed.data(), compressed.size()}, size, data)) {
    source.fail("the compressed data are damaged or not of the declared size of " + std::to_string(size) + " bytes");
  }
  const auto points = static_cast<std::size_t>(header.points);
  const std::array<RecordField, 6> fields = recordFields(header, roles, source);
  std::array<double, 6> values{};
  for (std::size_t i = 0; i < points; ++i) {
    for (std::size_t role = 0; role < (roles.hasNormals() ? 6U : 3U); ++role) {
      const RecordField& field = fields[role];
      values[role] = decodeScalar(data.data() + field.offset * points + i * sizeOf(field.type), field.type, swapped);
    }
    builder.add(values);
  }
}

}  // namespace

ReadResult readPcd(ByteSource& source) {
  const PcdHeader header = PcdHeaderReader(source).read();
  const FieldRoles roles = rolesOf(header, source);
  const bool swapped = std::endian::native == std::endian::big;  // the format stores little endian
  CloudBuilder builder(source, roles.hasNormals());
  if (header.encoding == "ascii") {
    readAscii(source, header, roles, builder);
    warnOfExtraLines(source);
  } else if (header.encoding == "binary") {
    readFixedRecords(source, header.points, header.stride, recordFields(header, roles, source), roles.hasNormals(),
                     swapped, builder);
    warnOfExtraData(source);
  } else {
    readCompressed(source, header, roles, swapped, builder);
    warnOfExtraData(source);
  }
  ReadResult result;
  result.summary.format = "PCD " + header.encoding;
  result.summary.records = builder.size();
  result.summary.normals = roles.hasNormals();
  result.cloud = std::move(builder.cloud());
  return result;
}

}  // namespace voroform::points
