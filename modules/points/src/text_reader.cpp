// Columns of numbers: XYZ, XYZN, PWN, TXT.
#include <algorithm>
#include <cmath>
#include <utility>

#include "readers.hpp"
#include "records.hpp"
#include "voroform/core/text_scanner.hpp"

namespace voroform::points {
namespace {

bool startsComment(const char* p, const char* end) { return *p == '#' || (*p == '/' && p + 1 != end && p[1] == '/'); }

std::string describeSeparator(char separator) {
  return separator == ' ' ? "a blank" : separator == ',' ? "a comma" : "a semicolon";
}

// Splits lines into columns. All lines of a file have one kind of separator: a comma that stands for a decimal point in
// a file with blanks or semicolons would otherwise pass as one more column.
class ColumnScanner {
 public:
  explicit ColumnScanner(const ByteSource& source) : source_(source) {}

  // Reads the first six numbers of the line into `values` and returns how many columns there are; 0 for a blank line
  // or a comment.
  std::size_t read(std::string_view line, std::array<double, 6>& values) {
    const char* p = line.data();
    const char* const end = p + line.size();
    std::size_t columns = 0;
    for (;;) {
      while (p != end && isBlank(*p)) ++p;
      if (p == end || startsComment(p, end)) return columns;
      double value = 0;
      const char* const behind = parseNumber(p, end, value);
      if (behind == nullptr || !endsNumber(behind, end)) failAtToken(p, end, columns);
      if (columns < 6) values[columns] = value;
      ++columns;
      p = passSeparator(behind, end);
    }
  }

 private:
  static bool endsNumber(const char* p, const char* end) {
    return p == end || isBlank(*p) || *p == ',' || *p == ';' || startsComment(p, end);
  }

  const char* passSeparator(const char* p, const char* end) {
    while (p != end && isBlank(*p)) ++p;
    if (p == end || startsComment(p, end)) return p;
    const bool isMark = *p == ',' || *p == ';';
    const char found = isMark ? *p : ' ';
    if (separator_ == 0) separator_ = found;
    if (found != separator_) {
      source_.failAtLine(describeSeparator(separator_) + " between numbers as before",
                         describeSeparator(found) + " (decimal commas are not supported)");
    }
    return isMark ? p + 1 : p;
  }

  [[noreturn]] void failAtToken(const char* p, const char* end, std::size_t columns) const {
    const char* last = p;
    while (last != end && !isBlank(*last) && *last != ';' && *last != ',') ++last;
    if (last == p) ++last;
    source_.failAtLine("a number in column " + std::to_string(columns + 1),
                       quotedToken({p, static_cast<std::size_t>(last - p)}));
  }

  const ByteSource& source_;
  char separator_ = 0;
};

// Watches whether columns 4 to 6 are colors from 0 to 255: then they are no normals.
class ColorDetector {
 public:
  void add(const std::array<double, 6>& values) {
    for (std::size_t i = 3; i < 6; ++i) {
      largest_ = std::max(largest_, values[i]);
      possible_ = possible_ && values[i] >= 0 && values[i] <= 255 && values[i] == std::floor(values[i]);
    }
  }
  bool areColors() const { return possible_ && largest_ > 1; }

 private:
  bool possible_ = true;
  double largest_ = 0;
};

class TextReader {
 public:
  explicit TextReader(ByteSource& source) : source_(source), scanner_(source) {}

  ReadResult read() {
    std::string_view line;
    while (source_.nextLine(line)) {
      std::array<double, 6> values{};
      const std::size_t columns = scanner_.read(line, values);
      if (columns > 0) addLine(columns, values);
    }
    checkCount();
    return finish();
  }

 private:
  void addLine(std::size_t columns, const std::array<double, 6>& values) {
    if (columns_ == 0 && !declared_ && columns == 1) {
      setCount(values[0]);
      return;
    }
    if (columns_ == 0) {
      if (columns < 3) source_.failAtLine("3 or more columns", std::to_string(columns));
      columns_ = columns;
    }
    if (columns != columns_) {
      source_.failAtLine(std::to_string(columns_) + " columns as before", std::to_string(columns));
    }
    const std::size_t records = cloud_.positions.size();
    if (declared_ && records == *declared_) {
      if (columns_ != 3 || cloud_.normals.size() == records) {
        source_.failAtLine("the end of the file after the declared " + std::to_string(*declared_) + " points",
                           "one more line");
      }
      cloud_.normals.emplace_back(values[0], values[1], values[2]);
      return;
    }
    requireRoom(records, source_);
    cloud_.positions.emplace_back(values[0], values[1], values[2]);
    if (columns_ >= 6) {
      colors_.add(values);
      cloud_.normals.emplace_back(values[3], values[4], values[5]);
    }
  }

  void setCount(double value) {
    constexpr double kMost = 9.0e15;  // integers below are exact
    if (!(value >= 1 && value <= kMost && value == std::floor(value))) {
      source_.failAtLine("the number of points or 3 or more columns", "1 column that is no positive integer");
    }
    declared_ = static_cast<std::uint64_t>(value);
  }

  void checkCount() {
    const std::size_t records = cloud_.positions.size();
    if (declared_ && records < *declared_) source_.failTruncated(*declared_, "points", records);
    if (declared_ && columns_ == 3 && !cloud_.normals.empty() && cloud_.normals.size() < records) {
      source_.failTruncated(*declared_, "points and as many normals", records + cloud_.normals.size());
    }
    if (records == 0) source_.fail(source_.line() == 0 ? "the file is empty" : "the file holds no points");
  }

  ReadResult finish() {
    ReadResult result;
    result.summary.format = "text with " + std::to_string(columns_) + " columns";
    result.summary.records = cloud_.positions.size();
    if (columns_ >= 6 && colors_.areColors()) {
      source_.context().warn(
          source_.name() + ": columns 4 to 6 hold integers from 0 to 255: taken as colors and ignored, not as normals");
      cloud_.normals = {};
    }
    result.summary.normals = cloud_.hasNormals();
    result.cloud = std::move(cloud_);
    return result;
  }

  ByteSource& source_;
  ColumnScanner scanner_;
  ColorDetector colors_;
  PointCloud cloud_;
  std::size_t columns_ = 0;
  std::optional<std::uint64_t> declared_;
};

}  // namespace

ReadResult readText(ByteSource& source) { return TextReader(source).read(); }

}  // namespace voroform::points
