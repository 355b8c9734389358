#include "voroform/core/byte_source.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "voroform/core/error.hpp"

namespace voroform {

namespace {

// Some editors begin UTF-8 text with it.
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace

std::string quotedToken(std::string_view token) {
  constexpr std::size_t kLongest = 32;
  constexpr char kHex[] = "0123456789abcdef";
  std::string text = "\"";
  for (const char c : token.substr(0, kLongest)) {
    const auto code = static_cast<unsigned char>(c);
    if (code >= 0x20 && code < 0x7f) {
      text += c;
    } else {
      text += "\\x";
      text += kHex[code / 16];
      text += kHex[code % 16];
    }
  }
  text += token.size() > kLongest ? "…\"" : "\"";
  return text;
}

ByteSource::ByteSource(std::istream& stream, std::string name, const RunContext& context)
    : stream_(stream), name_(std::move(name)), context_(context), block_(kFirstBlockBytes) {}

bool ByteSource::fill() {
  context_.throwIfCancelled();
  if (begin_ > 0) {
    std::memmove(block_.data(), block_.data() + begin_, available());
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == block_.size()) block_.resize(std::min(2 * block_.size(), kBlockBytes));
  if (end_ == block_.size() || !stream_.good()) return false;
  stream_.read(block_.data() + end_, static_cast<std::streamsize>(block_.size() - end_));
  const auto count = static_cast<std::size_t>(stream_.gcount());
  if (stream_.bad()) fail("cannot be read further than byte " + std::to_string(bytesRead_ + count));
  end_ += count;
  bytesRead_ += count;
  return count > 0;
}

bool ByteSource::nextLine(std::string_view& line) {
  std::size_t searched = 0;
  const char* lineEnd = nullptr;
  for (;;) {
    if (available() > searched) {
      lineEnd = static_cast<const char*>(std::memchr(block_.data() + begin_ + searched, '\n', available() - searched));
    }
    if (lineEnd != nullptr) break;
    searched = available();
    if (fill()) continue;
    if (available() == kBlockBytes) {
      ++line_;
      failAtLine("a line of at most " + std::to_string(kBlockBytes) + " bytes", "a longer one");
    }
    break;
  }
  if (lineEnd == nullptr && available() == 0) return false;
  const char* const first = block_.data() + begin_;
  std::size_t length = lineEnd != nullptr ? static_cast<std::size_t>(lineEnd - first) : available();
  begin_ += lineEnd != nullptr ? length + 1 : length;
  if (length > 0 && first[length - 1] == '\r') --length;
  line = std::string_view(first, length);
  ++line_;
  if (line_ == 1 && line.starts_with(kByteOrderMark)) line.remove_prefix(kByteOrderMark.size());
  return true;
}

const char* ByteSource::take(std::size_t bytes) {
  while (available() < bytes) {
    if (!fill()) return nullptr;
  }
  const char* const data = block_.data() + begin_;
  begin_ += bytes;
  return data;
}

bool ByteSource::skip(std::uint64_t bytes) {
  for (;;) {
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, available()));
    begin_ += step;
    bytes -= step;
    if (bytes == 0) return true;
    if (!fill()) return false;
  }
}

bool ByteSource::atEnd() { return available() == 0 && !fill(); }

void ByteSource::fail(const std::string& message) const { throw InputError(name_ + ": " + message); }

void ByteSource::failAtLine(const std::string& expected, const std::string& found) const {
  throw InputError(name_ + ":" + std::to_string(line_) + ": expected " + expected + ", found " + found);
}

void ByteSource::failTruncated(std::uint64_t declared, std::string_view things, std::uint64_t complete) const {
  fail("declares " + std::to_string(declared) + " " + std::string(things) + ", file ends after record " +
       std::to_string(complete) + " (byte " + std::to_string(bytesRead_) + ")");
}

void warnOfExtraData(ByteSource& source) {
  if (!source.atEnd()) source.context().warn(source.name() + ": ignored data behind the declared records");
}

}  // namespace voroform
