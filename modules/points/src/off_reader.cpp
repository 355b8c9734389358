// OFF (Geomview): its vertices; the faces are only walked over.
#include <utility>

#include "readers.hpp"
#include "records.hpp"
#include "voroform/core/text_scanner.hpp"
#include "voroform/mesh/off_header.hpp"

namespace voroform::points {
namespace {

void readFaces(ByteSource& source, std::uint64_t faces, std::uint64_t vertices) {
  std::string_view line;
  for (std::uint64_t face = 0; face < faces; ++face) {
    if (!mesh::nextOffLine(source, line)) source.failTruncated(faces, "faces", face);
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
  const mesh::OffHeader header = mesh::readOffHeader(source);
  const std::uint64_t vertices = header.vertices;
  ReadResult result;
  result.summary.faces = header.faces;

  CloudBuilder builder(source, header.normals);
  std::string_view line;
  std::array<double, 6> values{};
  for (std::uint64_t record = 0; record < vertices; ++record) {
    if (!mesh::nextOffLine(source, line)) source.failTruncated(vertices, "points", record);
    LineScanner scanner(source, line);
    for (std::size_t i = 0; i < (header.normals ? 6U : 3U); ++i) values[i] = scanner.number(roleName(i));
    while (header.extras && !scanner.atEnd()) scanner.number("a color or texture coordinate");
    scanner.expectEnd("the record");
    builder.add(values);
  }
  readFaces(source, result.summary.faces, vertices);
  mesh::warnOfExtraOffLines(source);
  result.summary.format = "OFF";
  result.summary.records = builder.size();
  result.summary.normals = header.normals;
  result.cloud = std::move(builder.cloud());
  return result;
}

}  // namespace voroform::points
