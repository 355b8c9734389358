// Damaged files: whatever happens to its bytes, a file is read or refused by an InputError, and memory stays bounded.
#include <gmock/gmock.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "support.hpp"
#include "voroform/core/random.hpp"

namespace {
std::atomic<std::size_t> largestAllocation = 0;
}

// All of the program's allocations pass through here, so that the largest is known. Not inlined: g++ would take the
// free() behind a new for a mistake.
[[gnu::noinline]] void* operator new(std::size_t size) {
  std::size_t largest = largestAllocation.load();
  while (size > largest && !largestAllocation.compare_exchange_weak(largest, size)) {
  }
  void* const memory = std::malloc(size > 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace voroform::points::test {
namespace {

struct Sample {
  std::string format;
  std::string bytes;
};

std::vector<Sample> samples() {
  const std::string properties =
      "element vertex 6\nproperty float x\nproperty float y\nproperty float z\nproperty list uchar short l\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  Bytes ply("ply\nformat binary_little_endian 1.0\n" + properties);
  Bytes plain(
      "ply\nformat binary_big_endian 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\n"
      "property float nx\nproperty float ny\nproperty float nz\nend_header\n",
      std::endian::big);
  std::string ascii = "ply\nformat ascii 1.0\n" + properties;
  std::string text = "6\n";
  std::string off = "CNOFF\n6 1 0\n";
  const std::string pcdFields =
      "VERSION 0.7\nFIELDS x y z i\nSIZE 4 4 4 2\nTYPE F F F U\nCOUNT 1 1 1 2\nWIDTH 6\nHEIGHT 1\nPOINTS 6\nDATA ";
  Bytes pcd(pcdFields + "binary\n");
  std::string pcdAscii = pcdFields + "ascii\n";
  for (int i = 0; i < 6; ++i) {
    const auto value = static_cast<float>(i);
    ply.putAll({value, 0.5F, -value}).put<std::uint8_t>(2).putAll<std::int16_t>({1, 2});
    plain.putAll({0.5 * i, 0.5, 0.25}).putAll({1.0F, 0.0F, value});
    const std::string number = std::to_string(i);
    ascii += number + " 0.5 -1e-3 2 1 2\n";
    text += number + " 0.5 -1e-3 0 0 1\n";
    off += number + " 0.5 -1e-3 0 0 1 255 0 0\n";
    pcd.putAll({value, 0.5F, -value}).putAll<std::uint16_t>({1, 2});
    pcdAscii += number + " 0.5 nan 1 2\n";
  }
  for (int i = 0; i < 2; ++i) {
    ply.put<std::uint8_t>(3).putAll<std::int32_t>({0, 1, 2});
    ascii += "3 0 1 2\n";
  }
  off += "3 0 1 2\n";
  Bytes lzf;  // 96 bytes: a literal zero, a copy of 95
  lzf.putAll<std::uint8_t>({0, 0, 7 << 5, 95 - 9, 0});
  const std::string compressed =
      pcdFields + "binary_compressed\n" + Bytes().put<std::uint32_t>(5).put<std::uint32_t>(96).text() + lzf.text();
  return {{".ply", ply.text()}, {".ply", plain.text()}, {".ply", ascii},    {".xyz", text},
          {".off", off},        {".pcd", pcd.text()},   {".pcd", pcdAscii}, {".pcd", compressed}};
}

std::string mutate(std::string bytes, std::uint64_t key) {
  std::uint64_t draws = 0;
  const auto draw = [&](std::size_t bound) {
    return static_cast<std::size_t>(randomBits(key, RandomStream::test, draws++) % bound);
  };
  const std::size_t changes = 1 + draw(4);
  for (std::size_t k = 0; k < changes && !bytes.empty(); ++k) {
    const std::size_t at = draw(bytes.size());
    switch (draw(6)) {
      case 0:
        bytes.resize(at);
        break;
      case 1:
        bytes[at] = static_cast<char>(draw(256));
        break;
      case 2:
        bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ (1U << draw(8)));
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, 1 + draw(20)));
        break;
      case 4:
        bytes.erase(at, 1 + draw(20));
        break;
      default:
        bytes.replace(at, 1, std::string(1 + draw(12), '9'));
    }
  }
  return bytes;
}

TEST(DamagedFiles, SamplesAreReadAsTheyAre) {
  for (const Sample& sample : samples()) {
    const Outcome outcome = readBytes(sample.bytes, sample.format);
    EXPECT_EQ(outcome.error, "") << sample.bytes;
    EXPECT_EQ(outcome.result.summary.records, 6U);
  }
}

TEST(DamagedFiles, AreReadOrRefusedInBoundedMemory) {
  constexpr std::uint64_t kMutations = 4000;
  // The block that files are read by is the largest piece that a file of a few hundred bytes may need.
  constexpr std::size_t kLargestAllowed = std::size_t{1} << 20;
  largestAllocation = 0;
  std::uint64_t key = 0;
  std::uint64_t refused = 0;
  for (const Sample& sample : samples()) {
    for (std::uint64_t i = 0; i < kMutations; ++i) {
      const Outcome outcome = readBytes(mutate(sample.bytes, key++), sample.format);
      if (!outcome.error.empty()) {
        ++refused;
        ASSERT_EQ(outcome.error.rfind("file:", 0), 0U) << outcome.error;
      } else {
        ASSERT_EQ(outcome.result.summary.records, outcome.result.cloud.positions.size());
      }
    }
  }
  EXPECT_LE(largestAllocation.load(), kLargestAllowed);
  EXPECT_GE(refused, key / 4);  // the mutations do reach the readers' checks
  EXPECT_LE(refused, key - key / 50);
}

TEST(DamagedFiles, AreRefusedAtEveryTruncationOfABinaryFile) {
  for (const Sample& sample : samples()) {
    // The last digits of a text may go without harm.
    const std::size_t longest = sample.bytes.size() - 4;
    for (std::size_t length = 0; length < longest; ++length) {
      EXPECT_NE(readBytes(sample.bytes.substr(0, length), sample.format).error, "") << length;
    }
  }
}

}  // namespace
}  // namespace voroform::points::test
