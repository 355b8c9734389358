// Input files built by hand, byte by byte, and what the readers make of them.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <initializer_list>
#include <string>
#include <string_view>

#include "support/read_outcome.hpp"
#include "voroform/points/read.hpp"

namespace voroform::points::test {

// Appends text and binary values in a given byte order.
class Bytes {
 public:
  explicit Bytes(std::string_view text = {}, std::endian order = std::endian::little) : data_(text), order_(order) {}

  template <class T>
  Bytes& put(T value) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    if (order_ != std::endian::native) std::reverse(bytes.begin(), bytes.end());
    data_ += bytes;
    return *this;
  }
  template <class T>
  Bytes& putAll(std::initializer_list<T> values) {
    for (const T value : values) put(value);
    return *this;
  }
  const std::string& text() const { return data_; }

 private:
  std::string data_;
  std::endian order_;
};

using Outcome = voroform::test::ReadOutcome<ReadResult>;

// Reads the bytes under the name "file".
inline Outcome readBytes(const std::string& bytes, const std::string& format) {
  return voroform::test::readOutcome<ReadResult>(bytes, [&](std::istream& stream, const RunContext& context) {
    return readPoints(stream, format, "file", context);
  });
}

}  // namespace voroform::points::test
