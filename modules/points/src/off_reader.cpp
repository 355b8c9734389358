// OFF (Geomview): its vertices; the faces are only walked over.
#include <utility>

#include "readers.hpp"
#include "records.hpp"
#include "voroform/core/text_scanner.hpp"

namespace voroform::points {
namespace {

// The next line that holds more than blanks and a comment; false at the end of the file.
bool nextFullLine(ByteSource& source, std::string_view& line) {
  while (source.nextLine(line)) {
    line = line.substr(0, line.find('#'));
    if (!LineScanner(source, line).atEnd()) return true;
  }
  return false;
}

struct OffKind {
  bool normals = false;
  bool extras = false;  // colors or texture coordinates after position and normal
};

// The header word is [ST][C][N][4][n]OFF.
OffKind readKind(std::string_view word, const ByteSource& source) {
  constexpr std::string_view kEnd = "OFF";
  OffKind kind;
  std::string_view prefix = word;
  if (word.size() >= kEnd.size() && word.substr(word.size() - kEnd.size()) == kEnd) {
    prefix.remove_suffix(kEnd.size());
    if (prefix.substr(0, 2) == "ST") {
      kind.extras = true;
      prefix.remove_prefix(2);
    }
    if (prefix.substr(0, 1) == "C") {
      kind.extras = true;
      prefix.remove_prefix(1);
    }
    if (prefix.substr(0, 1) == "N") {
      kind.normals = true;
      prefix.remove_prefix(1);
    }
    // Some programs write the letters the other way round.
    if (prefix == "C" && !kind.extras) {
      kind.extras = true;
      prefix.remove_prefix(1);
    }
  }
  if (!prefix.empty()) source.failAtLine("OFF, COFF, NOFF or CNOFF", quotedToken(word));
  return kind;
}

void readFaces(ByteSource& source, std::uint64_t faces, std::uint64_t vertices) {
  std::string_view line;
  for (std::uint64_t face = 0; face < faces; ++face) {
    if (!nextFullLine(source, line)) source.failTruncated(faces, "faces", face);
    LineScanner scanner(source, line);
    const std::uint64_t corners = scanner.count("the number of corners of the face");
    for (std::uint64_t i = 0; i < corners; ++i) {
      const std::uint64_t vertex = scanner.count("the index of a vertex");
      if (vertex >= vertices) {
        source.failAtLine("an index below " + std::to_string(vertices), std::to_string(vertex));
      }
    }
  }
}

}  // namespace

ReadResult readOff(ByteSource& source) {
  std::string_view line;
  if (!nextFullLine(source, line)) source.fail(source.line() == 0 ? "the file is empty" : "the file holds no header");
  LineScanner header(source, line);
  const OffKind kind = readKind(header.word(), source);
  LineScanner counts = header;
  if (header.atEnd()) {
    if (!nextFullLine(source, line)) source.fail("file ends before the numbers of vertices and faces");
    counts = LineScanner(source, line);
  }
  const std::uint64_t vertices = counts.count("the number of vertices");
  ReadResult result;
  result.summary.faces = counts.count("the number of faces");
  if (!counts.atEnd()) counts.count("the number of edges");
  counts.expectEnd("the number of edges");

  CloudBuilder builder(source, kind.normals);
  std::array<double, 6> values{};
  for (std::uint64_t record = 0; record < vertices; ++record) {
    if (!nextFullLine(source, line)) source.failTruncated(vertices, "points", record);
    LineScanner scanner(source, line);
    for (std::size_t i = 0; i < (kind.normals ? 6U : 3U); ++i) values[i] = scanner.number(roleName(i));
    while (kind.extras && !scanner.atEnd()) scanner.number("a color or texture coordinate");
    scanner.expectEnd("the record");
    builder.add(values);
  }
  readFaces(source, result.summary.faces, vertices);
  if (nextFullLine(source, line)) {
    source.context().warn(source.name() + ":" + std::to_string(source.line()) +
                          ": ignored lines behind the declared records");
  }
  result.summary.format = "OFF";
  result.summary.records = builder.size();
  result.summary.normals = kind.normals;
  result.cloud = std::move(builder.cloud());
  return result;
}

}  // namespace voroform::points
