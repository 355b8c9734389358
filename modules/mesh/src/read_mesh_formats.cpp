// One reader a format. Each reads from the start of the source to its end.
#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cstring>
#include <limits>
#include <string_view>
#include <unordered_map>

#include "read_mesh.hpp"
#include "voroform/core/text_scanner.hpp"
#include "voroform/mesh/off_header.hpp"
#include "voroform/mesh/ply_header.hpp"

namespace voroform::mesh {
namespace {

constexpr auto kMostElements = static_cast<std::size_t>(std::numeric_limits<Index>::max());

constexpr std::array<std::string_view, 3> kAxes = {"x", "y", "z"};

Vec3 readPosition(LineScanner& scanner) {
  Vec3 position;
  for (std::size_t i = 0; i < 3; ++i) position[static_cast<Eigen::Index>(i)] = scanner.number(kAxes[i]);
  return position;
}

void requireCorners(std::size_t corners, const ByteSource& source) {
  if (corners < 3) source.failAtLine("a face of at least 3 corners", std::to_string(corners));
}

}  // namespace

void MeshBuilder::addVertex(const Vec3& position) {
  if (vertices() == kMostElements) source_.fail("holds more vertices than can be numbered");
  raw_.mesh.vertices.push_back(position);
}

void MeshBuilder::addFace(std::span<const Index> corners) {
  const auto face = static_cast<Index>(raw_.summary.faces++);
  if (raw_.summary.faces > kMostElements || raw_.mesh.triangles.size() + corners.size() > kMostElements) {
    source_.fail("holds more faces than can be numbered");
  }
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const std::array<Index, 3> triangle = {corners[0], corners[i - 1], corners[i]};
    if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
      ++raw_.summary.degenerate;
      continue;
    }
    raw_.mesh.triangles.push_back(triangle);
    raw_.faces.push_back(face);
  }
}

RawMesh readOffMesh(ByteSource& source) {
  const OffHeader header = readOffHeader(source);
  RawMesh raw;
  raw.summary.format = "OFF";
  raw.summary.vertices = header.vertices;
  MeshBuilder builder(source, raw);
  std::string_view line;
  for (std::uint64_t record = 0; record < header.vertices; ++record) {
    if (!nextOffLine(source, line)) source.failTruncated(header.vertices, "vertices", record);
    LineScanner scanner(source, line);
    builder.addVertex(readPosition(scanner));
    for (int i = 0; header.normals && i < 3; ++i) scanner.number("a component of the normal");
    while (header.extras && !scanner.atEnd()) scanner.number("a color or texture coordinate");
    scanner.expectEnd("the record");
  }
  std::vector<Index> corners;
  for (std::uint64_t face = 0; face < header.faces; ++face) {
    if (!nextOffLine(source, line)) source.failTruncated(header.faces, "faces", face);
    LineScanner scanner(source, line);
    const std::uint64_t count = scanner.count("the number of corners of the face");
    corners.clear();
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::uint64_t vertex = scanner.count("the index of a vertex");
      if (vertex >= header.vertices) {
        source.failAtLine("an index below " + std::to_string(header.vertices), std::to_string(vertex));
      }
      corners.push_back(static_cast<Index>(vertex));
    }
    requireCorners(corners.size(), source);
    builder.addFace(corners);  // a color may follow
  }
  warnOfExtraOffLines(source);
  return raw;
}

namespace {

// The vertex of one corner of an OBJ face: v, v/vt, v//vn or v/vt/vn; negative counts back from the last vertex.
Index objCorner(std::string_view word, std::size_t vertices, const ByteSource& source) {
  const std::string_view number = word.substr(0, word.find('/'));
  const bool isRelative = number.starts_with('-');
  const std::optional<std::uint64_t> value = toCount(isRelative ? number.substr(1) : number);
  if (!value) source.failAtLine("the index of a vertex", quotedToken(word));
  if (*value == 0 || *value > vertices) {
    source.failAtLine("the index of one of the " + std::to_string(vertices) + " vertices before", quotedToken(word));
  }
  return static_cast<Index>(isRelative ? vertices - *value : *value - 1);
}

constexpr std::array<std::string_view, 13> kObjWithoutShape = {"vt",     "vn", "vp", "g",      "o",      "s", "usemtl",
                                                               "mtllib", "l",  "p",  "usemap", "maplib", "mg"};

}  // namespace

RawMesh readObjMesh(ByteSource& source) {
  RawMesh raw;
  raw.summary.format = "OBJ";
  raw.firstNumber = 1;
  MeshBuilder builder(source, raw);
  std::string_view line;
  std::vector<Index> corners;
  bool isEmpty = true;
  while (source.nextLine(line)) {
    LineScanner scanner(source, line.substr(0, line.find('#')));
    const std::string_view keyword = scanner.word();
    if (keyword.empty()) continue;
    isEmpty = false;
    if (keyword == "v") {
      builder.addVertex(readPosition(scanner));
      while (!scanner.atEnd()) scanner.number("a weight or color");
    } else if (keyword == "f") {
      corners.clear();
      while (!scanner.atEnd()) corners.push_back(objCorner(scanner.word(), builder.vertices(), source));
      requireCorners(corners.size(), source);
      builder.addFace(corners);
    } else if (std::find(kObjWithoutShape.begin(), kObjWithoutShape.end(), keyword) == kObjWithoutShape.end()) {
      source.failAtLine("a statement of polygonal OBJ such as v or f", quotedToken(keyword));
    }
  }
  if (isEmpty) source.fail("the file is empty");
  raw.summary.vertices = builder.vertices();
  return raw;
}

namespace {

// Reads the records of one element, in text or in bytes, property by property.
class PlyRecords {
 public:
  PlyRecords(ByteSource& source, const PlyHeader& header, const PlyElement& element)
      : source_(source),
        element_(element),
        isAscii_(header.encoding == PlyEncoding::ascii),
        swapped_(!isAscii_ &&
                 (header.encoding == PlyEncoding::bigEndian) != (std::endian::native == std::endian::big)) {}

  // Calls receive(property, value) for each scalar and each entry of a list.
  template <class Receive>
  void read(std::uint64_t record, const Receive& receive) {
    record_ = record;
    std::string_view line;
    if (isAscii_) {
      do {
        if (!source_.nextLine(line)) source_.failTruncated(element_.count, things(), record);
      } while (LineScanner(source_, line).atEnd());
    }
    LineScanner scanner(source_, line);
    for (std::size_t i = 0; i < element_.properties.size(); ++i) {
      const PlyProperty& property = element_.properties[i];
      const std::uint64_t count = property.isList ? length(scanner, property) : 1;
      for (std::uint64_t k = 0; k < count; ++k) {
        receive(i, isAscii_ ? scanner.number(property.name) : scalar(property.type));
      }
    }
    if (isAscii_) scanner.expectEnd("the record");
  }

  // "name:line" or "name: record K of element E" with what was expected.
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    if (isAscii_) source_.failAtLine(expected, found);
    source_.fail("record " + std::to_string(record_ + 1) + " of element " + element_.name + ": expected " + expected +
                 ", found " + found);
  }

 private:
  std::string things() const {
    return element_.name == "vertex" ? "vertices" : element_.name == "face" ? "faces" : element_.name + " records";
  }
  std::uint64_t length(LineScanner& scanner, const PlyProperty& property) {
    if (isAscii_) return scanner.count("the length of a list");
    const double value = scalar(property.countType);
    if (value < 0) fail("the length of a list", "a negative number");
    return static_cast<std::uint64_t>(std::min(value, 9e18));
  }
  double scalar(ScalarType type) {
    const char* const bytes = source_.take(sizeOf(type));
    if (bytes == nullptr) source_.failTruncated(element_.count, things(), record_);
    return decodeScalar(bytes, type, swapped_);
  }

  ByteSource& source_;
  const PlyElement& element_;
  bool isAscii_;
  bool swapped_;
  std::uint64_t record_ = 0;
};

std::size_t propertyOf(const PlyElement& element, std::string_view name, std::string_view otherName, bool isList,
                       const ByteSource& source) {
  std::size_t found = element.properties.size();
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (property.name != name && property.name != otherName) continue;
    if (found != element.properties.size()) source.fail("the header names " + property.name + " twice");
    if (property.isList != isList) {
      source.fail("the header makes " + property.name + (isList ? " a scalar" : " a list"));
    }
    found = i;
  }
  if (found == element.properties.size()) {
    source.fail("the header declares no property " + std::string(name) + " of the element " + element.name);
  }
  return found;
}

void readPlyVertices(ByteSource& source, const PlyHeader& header, const PlyElement& element, MeshBuilder& builder) {
  std::vector<int> axisOf(element.properties.size(), -1);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    axisOf[propertyOf(element, kAxes[axis], kAxes[axis], false, source)] = static_cast<int>(axis);
  }
  PlyRecords records(source, header, element);
  for (std::uint64_t i = 0; i < element.count; ++i) {
    Vec3 position = Vec3::Zero();
    records.read(i, [&](std::size_t property, double value) {
      if (axisOf[property] >= 0) position[axisOf[property]] = value;
    });
    builder.addVertex(position);
  }
}

void readPlyFaces(ByteSource& source, const PlyHeader& header, const PlyElement& element, std::uint64_t vertices,
                  MeshBuilder& builder) {
  const std::size_t indices = propertyOf(element, "vertex_indices", "vertex_index", true, source);
  PlyRecords records(source, header, element);
  std::vector<Index> corners;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    corners.clear();
    records.read(i, [&](std::size_t property, double value) {
      if (property != indices) return;
      if (!(value >= 0 && value < static_cast<double>(vertices)) || value != std::floor(value)) {
        records.fail("an index below " + std::to_string(vertices), std::to_string(value));
      }
      corners.push_back(static_cast<Index>(value));
    });
    if (corners.size() < 3) records.fail("a face of at least 3 corners", std::to_string(corners.size()));
    builder.addFace(corners);
  }
}

}  // namespace

RawMesh readPlyMesh(ByteSource& source) {
  const PlyHeader header = readPlyHeader(source);
  const auto elementOf = [&](std::string_view name) {
    const auto found = std::find_if(header.elements.begin(), header.elements.end(),
                                    [name](const PlyElement& element) { return element.name == name; });
    if (found == header.elements.end()) source.fail("the header declares no element " + std::string(name));
    return found;
  };
  for (const PlyElement& element : header.elements) {
    if (element.name == "tristrips") source.fail("the header declares triangle strips, which are not read");
  }
  const auto vertex = elementOf("vertex");
  elementOf("face");
  RawMesh raw;
  raw.summary.format = header.encoding == PlyEncoding::ascii          ? "PLY ascii"
                       : header.encoding == PlyEncoding::littleEndian ? "PLY binary_little_endian"
                                                                      : "PLY binary_big_endian";
  raw.summary.vertices = vertex->count;
  // Faces may stand before vertices, so indices are held against what the header declares; a file that does not keep it
  // is refused as truncated.
  const std::uint64_t vertices = std::min<std::uint64_t>(vertex->count, kMostElements);
  MeshBuilder builder(source, raw);
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      readPlyVertices(source, header, element, builder);
    } else if (element.name == "face") {
      readPlyFaces(source, header, element, vertices, builder);
    } else if (!element.properties.empty()) {
      PlyRecords records(source, header, element);
      for (std::uint64_t i = 0; i < element.count; ++i) records.read(i, [](std::size_t, double) {});
    }
  }
  if (header.encoding == PlyEncoding::ascii) {
    warnOfExtraLines(source);
  } else {
    warnOfExtraData(source);
  }
  return raw;
}

namespace {

constexpr std::size_t kStlHeaderBytes = 80;
constexpr std::size_t kStlRecordBytes = 50;

// Joins vertices at equal positions, in the order in which they come.
class Welder {
 public:
  Welder(MeshBuilder& builder, RawMesh& raw) : builder_(builder), raw_(raw) {}

  Index add(const Vec3& position) {
    ++raw_.summary.vertices;
    Key key;
    // Adding zero makes −0 to +0, which compare equal.
    for (std::size_t i = 0; i < 3; ++i) {
      key[i] = std::bit_cast<std::uint64_t>(position[static_cast<Eigen::Index>(i)] + 0.0);
    }
    const auto [place, isNew] = indexOf_.try_emplace(key, static_cast<Index>(builder_.vertices()));
    if (isNew) {
      builder_.addVertex(position);
    } else {
      ++raw_.summary.welded;
    }
    return place->second;
  }

 private:
  using Key = std::array<std::uint64_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const {
      std::uint64_t hash = 0;
      for (const std::uint64_t part : key) {
        hash = (hash ^ part) * 0xbf58476d1ce4e5b9U;
        hash ^= hash >> 31U;
      }
      return static_cast<std::size_t>(hash);
    }
  };
  MeshBuilder& builder_;
  RawMesh& raw_;
  std::unordered_map<Key, Index, Hash> indexOf_;
};

void readBinaryStl(ByteSource& source, RawMesh& raw) {
  raw.summary.format = "STL binary";
  const char* bytes = source.take(kStlHeaderBytes + 4);
  if (bytes == nullptr) source.fail("expected an STL file, found neither \"solid\" nor the 84 bytes of a header");
  const bool swapped = std::endian::native == std::endian::big;
  const auto declared = static_cast<std::uint64_t>(decodeScalar(bytes + kStlHeaderBytes, ScalarType::uint32, swapped));
  MeshBuilder builder(source, raw);
  Welder welder(builder, raw);
  for (std::uint64_t record = 0; record < declared; ++record) {
    bytes = source.take(kStlRecordBytes);
    if (bytes == nullptr) source.failTruncated(declared, "triangles", record);
    std::array<Vec3, 3> corners;
    for (std::size_t i = 0; i < 9; ++i) {
      // The normal, 12 bytes, is passed over: it follows from the corners.
      corners[i / 3][static_cast<Eigen::Index>(i % 3)] = decodeScalar(bytes + 12 + 4 * i, ScalarType::float32, swapped);
    }
    std::array<Index, 3> triangle;
    for (std::size_t i = 0; i < 3; ++i) {
      if (!corners[i].allFinite()) {
        source.fail("triangle " + std::to_string(record + 1) + ": expected finite coordinates");
      }
      triangle[i] = welder.add(corners[i]);
    }
    builder.addFace(triangle);
  }
  warnOfExtraData(source);
}

bool isWord(std::string_view word, std::string_view expected) {
  return word.size() == expected.size() && std::equal(word.begin(), word.end(), expected.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == b;
         });
}

class StlText {
 public:
  StlText(ByteSource& source, RawMesh& raw)
      : source_(source), raw_(raw), builder_(source, raw), welder_(builder_, raw) {}

  void read() {
    raw_.summary.format = "STL ascii";
    std::string_view line;
    while (nextLine(line)) {
      LineScanner scanner(source_, line);
      const std::string_view word = scanner.word();
      // A name, of one or several words, may follow.
      if (!isWord(word, "solid")) source_.failAtLine("\"solid\"", quotedToken(word));
      readSolid();
    }
  }

 private:
  bool nextLine(std::string_view& line) {
    while (source_.nextLine(line)) {
      if (!LineScanner(source_, line).atEnd()) return true;
    }
    return false;
  }
  LineScanner expect(std::string_view first, std::string_view second) {
    std::string_view line;
    if (!nextLine(line)) {
      source_.fail("file ends within triangle " + std::to_string(raw_.summary.faces + 1) + " (line " +
                   std::to_string(source_.line()) + ")");
    }
    LineScanner scanner(source_, line);
    for (const std::string_view word : {first, second}) {
      if (word.empty()) continue;
      const std::string_view found = scanner.word();
      if (!isWord(found, word)) source_.failAtLine("\"" + std::string(word) + "\"", quotedToken(found));
    }
    return scanner;
  }
  void readSolid() {
    std::string_view line;
    while (nextLine(line)) {
      LineScanner scanner(source_, line);
      const std::string_view word = scanner.word();
      if (isWord(word, "endsolid")) return;
      if (!isWord(word, "facet")) source_.failAtLine("\"facet\" or \"endsolid\"", quotedToken(word));
      readFacet();
    }
    source_.fail("file ends before \"endsolid\" (line " + std::to_string(source_.line()) + ")");
  }
  void readFacet() {
    expect("outer", "loop").expectEnd("outer loop");
    std::array<Index, 3> triangle;
    for (Index& corner : triangle) {
      LineScanner scanner = expect("vertex", "");
      const Vec3 position = readPosition(scanner);
      scanner.expectEnd("the vertex");
      if (!position.allFinite()) source_.failAtLine("finite coordinates", "others");
      corner = welder_.add(position);
    }
    expect("endloop", "").expectEnd("endloop");
    expect("endfacet", "").expectEnd("endfacet");
    builder_.addFace(triangle);
  }

  ByteSource& source_;
  RawMesh& raw_;
  MeshBuilder builder_;
  Welder welder_;
};

}  // namespace

bool isBinaryStl(std::istream& stream) {
  const std::streampos start = stream.tellg();
  std::array<char, kStlHeaderBytes + 4> head{};
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  const bool isLongEnough = stream.gcount() == static_cast<std::streamsize>(head.size());
  stream.clear();
  stream.seekg(0, std::ios::end);
  const auto bytes = static_cast<std::uint64_t>(stream.tellg() - start);
  stream.seekg(start);
  // Some programs begin binary files with "solid" as well; only binary ones have exactly the length that they declare.
  const auto declared = static_cast<std::uint64_t>(
      decodeScalar(head.data() + kStlHeaderBytes, ScalarType::uint32, std::endian::native == std::endian::big));
  if (isLongEnough && bytes == head.size() + kStlRecordBytes * declared) return true;
  std::string_view text(head.data(), head.size());
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return !isWord(text.substr(0, 5), "solid");
}

RawMesh readStlMesh(ByteSource& source, bool binary) {
  RawMesh raw;
  raw.firstNumber = kNone;
  if (binary) {
    readBinaryStl(source, raw);
  } else {
    StlText(source, raw).read();
  }
  return raw;
}

}  // namespace voroform::mesh
