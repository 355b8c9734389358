// Regions of the plane from well-known text and from lists of coordinates.
#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <optional>
#include <utility>

#include "voroform/core/byte_source.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/core/text_scanner.hpp"
#include "voroform/mesh/planar_region.hpp"

namespace voroform::mesh {

namespace {

// Points are numbered by an Index, with room for the crossings that clipping adds.
constexpr std::size_t kMostPoints = std::numeric_limits<Index>::max() / 4;

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // some editors begin UTF-8 text with it

// The rings as the file has them, and the line of each point.
struct RingFile {
  std::vector<std::vector<Vec2>> rings;
  std::vector<std::vector<std::uint64_t>> lines;
  // WKT only: the polygon of each ring; a polygon's first ring is its outline, the others are its holes.
  std::vector<std::size_t> polygons;
  std::size_t points = 0;

  void beginRing() {
    rings.emplace_back();
    lines.emplace_back();
  }
  void add(const Vec2& point, std::uint64_t line) {
    rings.back().push_back(point);
    lines.back().push_back(line);
    ++points;
  }
  void dropLast() {
    rings.back().pop_back();
    lines.back().pop_back();
    --points;
  }
  bool closed() const { return rings.back().size() > 1 && rings.back().front() == rings.back().back(); }
};

[[noreturn]] void failAt(const ByteSource& source, std::uint64_t line, const std::string& message) {
  throw InputError(source.name() + ":" + std::to_string(line) + ": " + message);
}

// Words, numbers and the marks ( ) , of well-known text, across lines of any length.
class WktScanner {
 public:
  explicit WktScanner(ByteSource& source) : source_(source) { advance(); }

  std::uint64_t line() const { return line_; }

  // The next mark, word or number; empty at the end of the file. Of a longer token the first characters.
  std::string next() {
    while (hasByte_ && (isBlank(byte_) || byte_ == '\n' || byte_ == '\r')) advance();
    std::string token;
    if (!hasByte_) return token;
    do {
      token += byte_;
      const bool mark = isMark(byte_);
      advance();
      if (mark) break;
    } while (hasByte_ && token.size() < kLongestToken && !isMark(byte_) && !isBlank(byte_) && byte_ != '\n' &&
             byte_ != '\r');
    return token;
  }

  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    failAt(source_, line_, "expected " + expected + ", found " + (found.empty() ? "the end" : quotedToken(found)));
  }

  // Reads one of the two tokens; whether it was the first.
  bool either(const std::string& first, const std::string& second) {
    const std::string token = next();
    if (token != first && token != second) fail(quotedToken(first) + " or " + quotedToken(second), token);
    return token == first;
  }
  void expect(const std::string& expected) {
    const std::string token = next();
    if (token != expected) fail(quotedToken(expected), token);
  }
  double number(const std::string& name) {
    const std::string token = next();
    const std::optional<double> value = toNumber(token);
    if (!value) fail("a number for " + name, token);
    return *value;
  }

 private:
  static constexpr std::size_t kLongestToken = 1024;

  static bool isMark(char c) { return c == '(' || c == ')' || c == ','; }

  // A line counts from the character behind its end, so that a token's line is that of its last character.
  void advance() {
    if (hasByte_ && byte_ == '\n') ++line_;
    const char* const byte = source_.take(1);
    hasByte_ = byte != nullptr;
    if (hasByte_) byte_ = *byte;
  }

  ByteSource& source_;
  std::uint64_t line_ = 1;
  char byte_ = 0;
  bool hasByte_ = false;
};

void requireRoom(const RingFile& file, const ByteSource& source, std::uint64_t line) {
  if (file.points >= kMostPoints) {
    failAt(source, line, "expected at most " + std::to_string(kMostPoints) + " points, found more");
  }
}

class WktReader {
 public:
  explicit WktReader(ByteSource& source) : source_(source), scanner_(source) {}

  RingFile read() {
    std::string word = scanner_.next();
    if (word.starts_with(kByteOrderMark)) word.erase(0, kByteOrderMark.size());
    if (word.empty()) source_.fail("the file is empty");
    std::string upper = word;
    for (char& c : upper) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    if (upper == "POLYGON") {
      readPolygon(0);
    } else if (upper == "MULTIPOLYGON") {
      scanner_.expect("(");
      std::size_t polygon = 0;
      do readPolygon(polygon++);
      while (scanner_.either(",", ")"));
    } else {
      scanner_.fail("POLYGON or MULTIPOLYGON", word);
    }
    const std::string rest = scanner_.next();
    if (!rest.empty()) scanner_.fail("the end of the file after one geometry", rest);
    return std::move(file_);
  }

 private:
  void readPolygon(std::size_t polygon) {
    scanner_.expect("(");
    do {
      file_.beginRing();
      file_.polygons.push_back(polygon);
      readRing();
    } while (scanner_.either(",", ")"));
  }

  void readRing() {
    scanner_.expect("(");
    do {
      const double x = scanner_.number("x");
      const double y = scanner_.number("y");
      requireRoom(file_, source_, scanner_.line());
      file_.add({x, y}, scanner_.line());
    } while (scanner_.either(",", ")"));
    if (!file_.closed()) {
      failAt(source_, scanner_.line(),
             "expected a ring whose last point equals its first, found ring " + std::to_string(file_.rings.size()));
    }
    file_.dropLast();
  }

  ByteSource& source_;
  WktScanner scanner_;
  RingFile file_;
};

RingFile readCoordinates(ByteSource& source) {
  RingFile file;
  bool open = false;
  const auto closeRing = [&] {
    if (open && file.closed()) file.dropLast();
    open = false;
  };
  std::string_view line;
  while (source.nextLine(line)) {
    const std::size_t comment = line.find('#');
    if (comment != std::string_view::npos) line = line.substr(0, comment);
    const char* p = line.data();
    const char* const end = p + line.size();
    const auto skipBlanks = [&] {
      while (p != end && isBlank(*p)) ++p;
    };
    skipBlanks();
    if (p == end) {
      if (comment == std::string_view::npos) closeRing();
      continue;
    }
    std::array<double, 2> values{};
    for (std::size_t i = 0; i < 2; ++i) {
      const char* const behind = parseNumber(p, end, values[i]);
      if (behind == nullptr || (behind != end && !isBlank(*behind) && *behind != ',')) {
        const char* last = p;
        while (last != end && !isBlank(*last) && *last != ',') ++last;
        source.failAtLine(i == 0 ? "a number for x" : "a number for y",
                          p == end ? "the end of the line"
                                   : quotedToken({p, std::max<std::size_t>(1, static_cast<std::size_t>(last - p))}));
      }
      p = behind;
      skipBlanks();
      if (i == 0 && p != end && *p == ',') {
        ++p;
        skipBlanks();
      }
    }
    if (p != end) {
      source.failAtLine("the end of the line after 2 numbers", quotedToken({p, static_cast<std::size_t>(end - p)}));
    }
    if (!open) file.beginRing();
    open = true;
    requireRoom(file, source, source.line());
    file.add({values[0], values[1]}, source.line());
  }
  closeRing();
  if (file.rings.empty()) source.fail(source.line() == 0 ? "the file is empty" : "the file holds no points");
  return file;
}

// Holes must be holes, each of its own polygon.
void checkRoles(const RingFile& file, const PlanarRegion& region, const ByteSource& source) {
  for (std::size_t r = 0; r < file.rings.size();) {
    const std::size_t outline = r;
    const auto name = [](std::size_t ring) { return "ring " + std::to_string(ring + 1); };
    if (region.isHole(outline)) {
      failAt(source, file.lines[outline][0],
             name(outline) + ": the outline of a polygon lies inside of another polygon");
    }
    std::size_t end = outline + 1;
    while (end < file.rings.size() && file.polygons[end] == file.polygons[outline]) ++end;
    if (++r == end) continue;
    const PlanarRegion filled(std::span(file.rings).subspan(outline, 1));
    for (; r < end; ++r) {
      if (!region.isHole(r) || !filled.contains(file.rings[r][0])) {
        failAt(source, file.lines[r][0], name(r) + ": a hole that does not lie inside of its polygon's outline");
      }
    }
  }
}

using Reader = RingFile (*)(ByteSource&);

Reader readerOf(const std::string& format, const std::string& name) {
  if (format == ".wkt") return [](ByteSource& source) { return WktReader(source).read(); };
  if (format == ".xy" || format == ".txt") return readCoordinates;
  throw InputError(name + ": expected the extension .wkt, .xy or .txt, found " + quotedToken(format));
}

}  // namespace

PlanarRegion readPlanarRegion(std::istream& stream, const std::string& format, const std::string& name,
                              const RunContext& context) {
  const Reader reader = readerOf(format, name);
  ByteSource source(stream, name, context);
  const RingFile file = reader(source);
  try {
    PlanarRegion region(file.rings);
    if (!file.polygons.empty()) checkRoles(file, region, source);
    return region;
  } catch (const InvalidRegion& error) {
    failAt(source, file.lines[error.fault.ring][error.fault.point], error.what());
  }
}

PlanarRegion readPlanarRegion(const std::filesystem::path& path, const RunContext& context) {
  const std::string name = path.string();
  requireRegularFile(path);
  const std::string format = lowerCaseExtension(path);
  readerOf(format, name);  // a wrong extension is told before a file that cannot be opened
  std::ifstream stream = openInputFile(path);
  return readPlanarRegion(stream, format, name, context);
}

}  // namespace voroform::mesh
