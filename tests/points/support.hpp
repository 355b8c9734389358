// Input files built by hand, byte by byte, and what the readers make of them.
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <initializer_list>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "voroform/core/error.hpp"
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

struct Outcome {
  ReadResult result;
  std::string error;  // the InputError's message; empty if there was none
  std::vector<std::string> warnings;
};

// Reads the bytes under the name "file".
inline Outcome readBytes(const std::string& bytes, const std::string& format) {
  Outcome outcome;
  RunContext context;
  context.log = [&](LogLevel level, std::string_view message) {
    if (level == LogLevel::warning) outcome.warnings.emplace_back(message);
  };
  std::istringstream stream(bytes);
  try {
    outcome.result = readPoints(stream, format, "file", context);
  } catch (const InputError& error) {
    outcome.error = error.what();
  }
  return outcome;
}

}  // namespace voroform::points::test
