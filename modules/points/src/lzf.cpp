#include "lzf.hpp"

namespace voroform::points {

std::size_t lzfLargestOutput(std::size_t compressed) {
  constexpr std::size_t kLargestCopy = 264;
  constexpr std::size_t kBytesOfItsCode = 3;
  return (compressed / kBytesOfItsCode + 1) * kLargestCopy;
}

bool decodeLzf(std::string_view compressed, std::size_t size, std::vector<char>& output) {
  output.clear();
  if (size > lzfLargestOutput(compressed.size())) return false;
  output.reserve(size);
  std::size_t next = 0;
  const auto byte = [&] { return static_cast<std::size_t>(static_cast<unsigned char>(compressed[next++])); };
  while (next < compressed.size()) {
    const std::size_t control = byte();
    if (control < 32) {
      const std::size_t length = control + 1;
      if (compressed.size() - next < length || size - output.size() < length) return false;
      output.insert(output.end(), compressed.begin() + static_cast<std::ptrdiff_t>(next),
                    compressed.begin() + static_cast<std::ptrdiff_t>(next + length));
      next += length;
      continue;
    }
    std::size_t length = control >> 5;
    if (length == 7) {
      if (next == compressed.size()) return false;
      length += byte();
    }
    length += 2;
    if (next == compressed.size()) return false;
    const std::size_t distance = ((control & 31U) << 8U) + byte() + 1;
    if (distance > output.size() || size - output.size() < length) return false;
    // The copy may overlap its own output, so it goes byte by byte.
    for (std::size_t i = 0; i < length; ++i) output.push_back(output[output.size() - distance]);
  }
  return output.size() == size;
}

}  // namespace voroform::points
