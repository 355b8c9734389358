#include "captured_stream.hpp"

#include <utility>

namespace voroform::cli {

CapturedStream::CapturedStream(std::ostream& stream, Sink sink)
    : stream_(stream), sink_(std::move(sink)), target_(stream.rdbuf(this)) {}

CapturedStream::~CapturedStream() {
  stream_.rdbuf(target_);
  if (!line_.empty()) sink_(line_);
}

CapturedStream::int_type CapturedStream::overflow(int_type character) {
  if (!traits_type::eq_int_type(character, traits_type::eof())) {
    const std::lock_guard lock(mutex_);
    take(traits_type::to_char_type(character));
  }
  return traits_type::not_eof(character);
}

std::streamsize CapturedStream::xsputn(const char* text, std::streamsize count) {
  const std::lock_guard lock(mutex_);
  for (std::streamsize i = 0; i < count; ++i) take(text[i]);
  return count;
}

void CapturedStream::take(char character) {
  if (character != '\n') {
    line_ += character;
    return;
  }
  if (!line_.empty()) sink_(line_);
  line_.clear();
}

}  // namespace voroform::cli
