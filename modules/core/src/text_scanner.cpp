#include "voroform/core/text_scanner.hpp"

#include <charconv>
#include <limits>
#include <system_error>

namespace voroform {
namespace {

// Whether a number that a double cannot hold is too large (and not too small): by the decimal place of its first
// digit other than 0.
bool isTooLarge(const char* begin, const char* end) {
  constexpr std::int64_t kFar = 1'000'000'000;
  std::int64_t place = 0;
  bool seenPoint = false;
  bool seenDigit = false;
  const char* p = begin;
  for (; p != end && *p != 'e' && *p != 'E'; ++p) {
    if (*p == '.') {
      seenPoint = true;
    } else if (*p >= '0' && *p <= '9') {
      seenDigit = seenDigit || *p != '0';
      if (seenDigit && !seenPoint) ++place;
      if (!seenDigit && seenPoint) --place;
    }
  }
  std::int64_t exponent = 0;
  if (p != end) {
    ++p;
    const bool negative = p != end && *p == '-';
    if (p != end && (*p == '-' || *p == '+')) ++p;
    if (std::from_chars(p, end, exponent).ec == std::errc::result_out_of_range || exponent > kFar) exponent = kFar;
    if (negative) exponent = -exponent;
  }
  return place + exponent > 0;
}

}  // namespace

const char* parseNumber(const char* begin, const char* end, double& value) {
  const char* start = begin;
  if (start != end && *start == '+') {
    ++start;
    if (start != end && *start == '-') return nullptr;
  }
  const std::from_chars_result result = std::from_chars(start, end, value);
  if (result.ec == std::errc::invalid_argument) return nullptr;
  if (result.ec == std::errc::result_out_of_range) {
    value = isTooLarge(start, result.ptr) ? std::numeric_limits<double>::infinity() : 0.0;
    if (*start == '-') value = -value;
  }
  return result.ptr;
}

std::optional<double> toNumber(std::string_view token) {
  double value = 0;
  const char* const end = token.data() + token.size();
  if (parseNumber(token.data(), end, value) != end || token.empty()) return std::nullopt;
  return value;
}

std::optional<std::uint64_t> toCount(std::string_view token) {
  std::uint64_t value = 0;
  const char* const end = token.data() + token.size();
  const std::from_chars_result result = std::from_chars(token.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  return value;
}

bool LineScanner::atEnd() {
  while (next_ != end_ && isBlank(*next_)) ++next_;
  return next_ == end_;
}

std::string_view LineScanner::word() {
  if (atEnd()) return {};
  const char* const first = next_;
  while (next_ != end_ && !isBlank(*next_)) ++next_;
  return {first, static_cast<std::size_t>(next_ - first)};
}

double LineScanner::number(std::string_view name) {
  if (atEnd()) source_->failAtLine("a number for " + std::string(name), "the end of the line");
  double value = 0;
  const char* const behind = parseNumber(next_, end_, value);
  if (behind == nullptr || (behind != end_ && !isBlank(*behind))) {
    source_->failAtLine("a number for " + std::string(name), quotedToken(word()));
  }
  next_ = behind;
  return value;
}

std::uint64_t LineScanner::count(std::string_view what) {
  if (atEnd()) source_->failAtLine(std::string(what), "the end of the line");
  const std::string_view token = word();
  const std::optional<std::uint64_t> value = toCount(token);
  if (!value) source_->failAtLine(std::string(what), quotedToken(token));
  return *value;
}

void LineScanner::expectEnd(std::string_view what) {
  if (!atEnd()) source_->failAtLine("the end of the line after " + std::string(what), quotedToken(word()));
}

void warnOfExtraLines(ByteSource& source) {
  std::string_view line;
  while (source.nextLine(line)) {
    if (LineScanner(source, line).atEnd()) continue;
    source.context().warn(source.name() + ":" + std::to_string(source.line()) +
                          ": ignored lines behind the declared records");
    return;
  }
}

}  // namespace voroform
