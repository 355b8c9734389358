#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "voroform/core/output_file.hpp"
#include "voroform/points/read.hpp"

namespace voroform::points {
namespace {

void appendLittleEndian(double value, std::vector<char>& bytes) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (unsigned shift = 0; shift < 64; shift += 8) bytes.push_back(static_cast<char>((bits >> shift) & 0xffU));
}

}  // namespace

void writePointsPly(const std::filesystem::path& path, const PointCloud& cloud) {
  constexpr std::size_t kBlockBytes = std::size_t{1} << 16;
  OutputFile file(path);
  std::ostream& stream = file.stream();
  stream << "ply\nformat binary_little_endian 1.0\nelement vertex " << cloud.positions.size()
         << "\nproperty double x\nproperty double y\nproperty double z\n";
  if (cloud.hasNormals()) stream << "property double nx\nproperty double ny\nproperty double nz\n";
  stream << "end_header\n";
  std::vector<char> block;
  const auto flush = [&] {
    stream.write(block.data(), static_cast<std::streamsize>(block.size()));
    block.clear();
  };
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3 position = cloud.frame.origin + cloud.positions[i];
    for (const double value : position) appendLittleEndian(value, block);
    if (cloud.hasNormals()) {
      for (const double value : cloud.normals[i]) appendLittleEndian(value, block);
    }
    if (block.size() >= kBlockBytes) flush();
  }
  flush();
  file.commit();
}

}  // namespace voroform::points
