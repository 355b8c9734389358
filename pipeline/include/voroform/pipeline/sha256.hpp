// SHA-256 (FIPS 180-4), to name the files that a result was made from.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace voroform::pipeline {

class Sha256 {
 public:
  void update(std::span<const std::byte> data);
  // The digest in lower-case hexadecimal digits; the object is spent.
  std::string finish();

 private:
  void block(const std::byte* data);

  std::array<std::uint32_t, 8> state_ = {0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                         0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<std::byte, 64> pending_{};
  std::size_t pendingSize_ = 0;
  std::uint64_t totalBytes_ = 0;
};

// Throws InputError if the file cannot be read.
std::string sha256OfFile(const std::filesystem::path& path);

}  // namespace voroform::pipeline
