// Numbers and words out of one line of text; independent of the locale.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "voroform/core/byte_source.hpp"

namespace voroform {

inline bool isBlank(char c) { return c == ' ' || c == '\t'; }

// Reads the longest number at the start of [begin, end): decimal or scientific, a leading + allowed, nan and inf in any
// case; too small becomes 0, too large becomes infinite. Returns the place behind it, or nullptr if there is none.
const char* parseNumber(const char* begin, const char* end, double& value);

// The whole token as a number or as an unsigned integer.
std::optional<double> toNumber(std::string_view token);
std::optional<std::uint64_t> toCount(std::string_view token);

// Walks over the blank-separated tokens of a line. Errors name the source's current line.
class LineScanner {
 public:
  LineScanner(const ByteSource& source, std::string_view line)
      : source_(&source), next_(line.data()), end_(line.data() + line.size()) {}

  bool atEnd();
  // The next token, or an empty one at the end.
  std::string_view word();
  // `name` says in messages whose value belongs here: "expected a number for x".
  double number(std::string_view name);
  // An unsigned integer; `what` says in messages what it is: "expected the number of points".
  std::uint64_t count(std::string_view what);
  // Throws if something is left on the line. `what` says what should have ended here.
  void expectEnd(std::string_view what);

 private:
  const ByteSource* source_;
  const char* next_;
  const char* end_;
};

// Says through the context that more than blank lines follow behind what a file's header declares, and where.
void warnOfExtraLines(ByteSource& source);

}  // namespace voroform
