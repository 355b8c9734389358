#include "voroform/mesh/off_header.hpp"

#include "voroform/core/text_scanner.hpp"

namespace voroform::mesh {
namespace {

// The header word is [ST][C][N][4][n]OFF.
void readKind(std::string_view word, const ByteSource& source, OffHeader& header) {
  constexpr std::string_view kEnd = "OFF";
  std::string_view prefix = word;
  if (word.size() >= kEnd.size() && word.substr(word.size() - kEnd.size()) == kEnd) {
    prefix.remove_suffix(kEnd.size());
    if (prefix.substr(0, 2) == "ST") {
      header.extras = true;
      prefix.remove_prefix(2);
    }
    if (prefix.substr(0, 1) == "C") {
      header.extras = true;
      prefix.remove_prefix(1);
    }
    if (prefix.substr(0, 1) == "N") {
      header.normals = true;
      prefix.remove_prefix(1);
    }
    // Some programs write the letters the other way round.
    if (prefix == "C" && !header.extras) {
      header.extras = true;
      prefix.remove_prefix(1);
    }
  }
  if (!prefix.empty()) source.failAtLine("OFF, COFF, NOFF or CNOFF", quotedToken(word));
}

}  // namespace

bool nextOffLine(ByteSource& source, std::string_view& line) {
  while (source.nextLine(line)) {
    line = line.substr(0, line.find('#'));
    if (!LineScanner(source, line).atEnd()) return true;
  }
  return false;
}

void warnOfExtraOffLines(ByteSource& source) {
  std::string_view line;
  if (!nextOffLine(source, line)) return;
  source.context().warn(source.name() + ":" + std::to_string(source.line()) +
                        ": ignored lines behind the declared records");
}

OffHeader readOffHeader(ByteSource& source) {
  std::string_view line;
  if (!nextOffLine(source, line)) source.fail(source.line() == 0 ? "the file is empty" : "the file holds no header");
  LineScanner first(source, line);
  OffHeader header;
  readKind(first.word(), source, header);
  LineScanner counts = first;
  if (first.atEnd()) {
    if (!nextOffLine(source, line)) source.fail("file ends before the numbers of vertices and faces");
    counts = LineScanner(source, line);
  }
  header.vertices = counts.count("the number of vertices");
  header.faces = counts.count("the number of faces");
  if (!counts.atEnd()) counts.count("the number of edges");
  counts.expectEnd("the number of edges");
  return header;
}

}  // namespace voroform::mesh
