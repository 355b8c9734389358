// Reads cells.vtu as written by writeCellsVtu: strictly, and safely whatever the file holds.
#include <algorithm>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/mesh/formats.hpp"
#include "vtu_appended.hpp"
#include "vtu_header.hpp"
#include "vtu_layout.hpp"

namespace voroform::mesh {

namespace {

// The XML part is a few kilobytes; a file without the blocks' marker in this stretch is something else.
constexpr std::size_t kMaxHeaderBytes = std::size_t{1} << 20U;
constexpr std::size_t kCompareValues = std::size_t{1} << 16U;

// A block of appended data, known to lie within the file.
struct Block {
  std::uint64_t begin = 0;
  std::uint64_t bytes = 0;
};

class VtuFile {
 public:
  explicit VtuFile(const std::filesystem::path& path) : name_(path.string()), stream_(openInputFile(path)) {
    std::error_code error;
    size_ = std::filesystem::file_size(path, error);
    if (error) fail("its size cannot be found: " + error.message());
    std::string head(std::min<std::uint64_t>(size_, kMaxHeaderBytes), '\0');
    readBytes(0, head.data(), head.size());
    const std::size_t appended = head.find("<AppendedData");
    const std::size_t marker = appended == std::string::npos ? appended : head.find(">\n_", appended);
    if (marker == std::string::npos) fail("no appended data found; expected a cells.vtu as voroform writes it");
    blocks_ = marker + 3;
    header_ = vtu::parseHeader(std::string_view(head).substr(0, marker + 1), name_);
    checkEnd();
  }

  const vtu::Header& header() const { return header_; }

  [[noreturn]] void fail(const std::string& what) const { throw InputError(name_ + ": " + what); }

  const vtu::DataArray* find(const std::string& section, const std::string& name) const {
    for (const vtu::DataArray& array : header_.arrays) {
      if (array.section == section && array.name == name) return &array;
    }
    return nullptr;
  }

  // Finds an array and its bytes, which must be a whole number of tuples.
  Block block(const std::string& section, const std::string& name, const std::string& type, std::uint64_t components,
              std::uint64_t scalarBytes) {
    const vtu::DataArray* array = find(section, name);
    if (array == nullptr) fail("no array '" + name + "' in " + section);
    if (array->type != type || array->components != components) {
      fail("the array '" + name + "' is " + array->type + " with " + std::to_string(array->components) +
           " components, expected " + type + " with " + std::to_string(components));
    }
    const std::uint64_t available = size_ - blocks_;
    if (array->offset > available || available - array->offset < sizeof(std::uint64_t)) {
      fail("the array '" + name + "' begins beyond the end of the file: truncated?");
    }
    Block result;
    result.begin = blocks_ + array->offset + sizeof(std::uint64_t);
    readBytes(blocks_ + array->offset, &result.bytes, sizeof(result.bytes));
    if (result.bytes > size_ - result.begin) {
      fail("the array '" + name + "' declares " + std::to_string(result.bytes) + " bytes where " +
           std::to_string(size_ - result.begin) + " are left: truncated?");
    }
    if (result.bytes % (components * scalarBytes) != 0) {
      fail("the array '" + name + "' has " + std::to_string(result.bytes) + " bytes, no whole number of values");
    }
    return result;
  }

  template <class T>
  std::vector<T> read(const std::string& section, const std::string& name, const std::string& type,
                      std::uint64_t components, std::uint64_t scalarBytes) {
    const Block found = block(section, name, type, components, scalarBytes);
    std::vector<T> values(found.bytes / sizeof(T));
    readBytes(found.begin, values.data(), found.bytes);
    return values;
  }

  // As read, with a known number of tuples.
  template <class T>
  std::vector<T> read(const std::string& section, const std::string& name, const std::string& type,
                      std::uint64_t components, std::uint64_t scalarBytes, std::uint64_t count) {
    std::vector<T> values = read<T>(section, name, type, components, scalarBytes);
    if (values.size() != count) {
      fail("the array '" + name + "' has " + std::to_string(values.size()) + " entries, expected " +
           std::to_string(count));
    }
    return values;
  }

  void readBytes(std::uint64_t begin, void* target, std::uint64_t bytes) {
    if (bytes == 0) return;
    stream_.clear();
    stream_.seekg(static_cast<std::streamoff>(begin));
    stream_.read(static_cast<char*>(target), static_cast<std::streamsize>(bytes));
    if (!stream_) fail("cannot read " + std::to_string(bytes) + " bytes at byte " + std::to_string(begin));
  }

 private:
  void checkEnd() {
    const std::size_t length = std::strlen(vtu::kEnd);
    std::string end(length, '\0');
    if (size_ < blocks_ + length) fail("truncated inside the appended data");
    readBytes(size_ - length, end.data(), length);
    if (end != vtu::kEnd) fail("does not end with </AppendedData> and </VTKFile>: truncated?");
  }

  std::string name_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
  std::uint64_t blocks_ = 0;
  vtu::Header header_;
};

// Compares an array in the file with values that come one by one.
class Comparison {
 public:
  Comparison(VtuFile& file, const std::string& name, std::int64_t count)
      : file_(file), name_(name), block_(file.block("Cells", name, "Int64", 1, sizeof(std::int64_t))) {
    if (block_.bytes != static_cast<std::uint64_t>(count) * sizeof(std::int64_t)) disagree();
  }
  void put(std::int64_t value) {
    if (next_ == values_.size()) refill();
    if (values_[next_++] != value) disagree();
  }

 private:
  void refill() {
    values_.resize(std::min<std::uint64_t>(kCompareValues, (block_.bytes - done_) / sizeof(std::int64_t)));
    if (values_.empty()) disagree();
    file_.readBytes(block_.begin + done_, values_.data(), values_.size() * sizeof(std::int64_t));
    done_ += values_.size() * sizeof(std::int64_t);
    next_ = 0;
  }
  [[noreturn]] void disagree() const {
    file_.fail("the array '" + name_ + "' of the cells disagrees with the faces in the field data");
  }

  VtuFile& file_;
  std::string name_;
  Block block_;
  std::vector<std::int64_t> values_;
  std::uint64_t done_ = 0;
  std::size_t next_ = 0;
};

void readFaces(VtuFile& file, PolyhedralComplex& complex) {
  complex.faceOffsets = file.read<std::int64_t>("FieldData", vtu::kFaceOffsets, "Int64", 1, 8);
  complex.faceVertices = file.read<Index>("FieldData", vtu::kFaceVertices, "Int32", 1, 4);
  if (complex.faceOffsets.empty() || complex.faceOffsets.front() != 0 ||
      complex.faceOffsets.back() != static_cast<std::int64_t>(complex.faceVertices.size())) {
    file.fail("face_offsets does not run from 0 to the number of face_vertices");
  }
  const std::size_t faces = complex.faceOffsets.size() - 1;
  if (faces > static_cast<std::size_t>(std::numeric_limits<Index>::max())) file.fail("too many faces");
  complex.faceCells = file.read<std::array<Index, 2>>("FieldData", vtu::kFaceCells, "Int32", 2, 4, faces);
  complex.faceTags = file.read<FaceTag>("FieldData", vtu::kFaceTags, "UInt8", 1, 1, faces);
  const auto points = static_cast<Index>(complex.vertices.size());
  for (std::size_t f = 0; f < faces; ++f) {
    const auto fault = [&](const std::string& what) { file.fail("face " + std::to_string(f) + ": " + what); };
    if (complex.faceOffsets[f + 1] < complex.faceOffsets[f]) fault("its offsets fall");
    const auto [behind, ahead] = complex.faceCells[f];
    if (behind < 0 || behind >= complex.cellCount || ahead < kNone || ahead >= complex.cellCount || behind == ahead) {
      fault("lies between the cells " + std::to_string(behind) + " and " + std::to_string(ahead) + " of " +
            std::to_string(complex.cellCount));
    }
    if (complex.faceTags[f] > FaceTag::envelope) fault("unknown tag");
  }
  for (const Index v : complex.faceVertices) {
    if (v < 0 || v >= points)
      file.fail("face_vertices names the vertex " + std::to_string(v) + " of " + std::to_string(points));
  }
  for (std::size_t f = 0; f < faces; ++f) {
    if (complex.faceOffsets[f + 1] - complex.faceOffsets[f] < 3) {
      file.fail("face " + std::to_string(f) + ": fewer than three vertices");
    }
  }
}

// Points in world coordinates from the file against origin + local, bit for bit.
void checkWorld(VtuFile& file, const std::string& name, const std::vector<Vec3>& world, const std::vector<Vec3>& local,
                const Frame& frame) {
  for (std::size_t i = 0; i < local.size(); ++i) {
    const Vec3 expected = frame.origin + local[i];
    if (std::memcmp(expected.data(), world[i].data(), sizeof(Vec3)) != 0) {
      file.fail("the array '" + name + "', entry " + std::to_string(i) +
                ": disagrees with origin and local coordinates");
    }
  }
}

void checkCells(VtuFile& file, const PolyhedralComplex& complex) {
  const auto cells = static_cast<std::size_t>(complex.cellCount);
  for (const std::uint8_t type : file.read<std::uint8_t>("Cells", "types", "UInt8", 1, 1, cells)) {
    if (type != vtu::kPolyhedronType) file.fail("a cell of type " + std::to_string(type) + "; expected polyhedra (42)");
  }
  const CellFaces rows = cellFaces(complex);
  const vtu::StreamEnds ends = vtu::streamEnds(complex, rows);
  if (file.read<std::int64_t>("Cells", "offsets", "Int64", 1, 8, cells) != ends.connectivity ||
      file.read<std::int64_t>("Cells", "faceoffsets", "Int64", 1, 8, cells) != ends.faces) {
    file.fail("the cells' offsets disagree with the faces in the field data");
  }
  Comparison connectivity(file, "connectivity", cells == 0 ? 0 : ends.connectivity.back());
  vtu::emitConnectivity(
      complex, rows, [&](std::int64_t v) { connectivity.put(v); }, [] {});
  Comparison faces(file, "faces", cells == 0 ? 0 : ends.faces.back());
  vtu::emitFaces(
      complex, rows, [&](std::int64_t value) { faces.put(value); }, [] {});
}

}  // namespace

PolyhedralComplex readCellsVtu(const std::filesystem::path& path) {
  VtuFile file(path);
  constexpr auto kMax = static_cast<std::uint64_t>(std::numeric_limits<Index>::max());
  const std::uint64_t points = file.header().points;
  if (points > kMax || file.header().cells > kMax) file.fail("more points or cells than voroform can index");
  const auto format = file.read<std::int32_t>("FieldData", vtu::kFormat, "Int32", 1, 4, 1);
  if (format[0] != vtu::kFormatVersion) {
    file.fail("format version " + std::to_string(format[0]) + ", expected " + std::to_string(vtu::kFormatVersion));
  }
  PolyhedralComplex complex;
  complex.frame.origin = file.read<Vec3>("FieldData", vtu::kOrigin, "Float64", 3, 8, 1)[0];
  const bool shifted = vtu::hasOrigin(complex.frame);
  complex.vertices = file.read<Vec3>("Points", "Points", "Float64", 3, 8, points);
  if (shifted) {
    auto local = file.read<Vec3>("PointData", vtu::kLocal, "Float64", 3, 8, points);
    checkWorld(file, "Points", complex.vertices, local, complex.frame);
    complex.vertices = std::move(local);
  }
  // The types' bytes are there before anything is allocated for the declared number of cells.
  if (file.block("Cells", "types", "UInt8", 1, 1).bytes != file.header().cells) {
    file.fail("the number of cells differs from the number of their types");
  }
  complex.cellCount = static_cast<Index>(file.header().cells);
  readFaces(file, complex);
  if (file.find("CellData", vtu::kSite) != nullptr) {
    complex.cellSites = file.read<Vec3>("CellData", vtu::kSite, "Float64", 3, 8, file.header().cells);
    if (shifted) {
      auto local = file.read<Vec3>("CellData", vtu::kSiteLocal, "Float64", 3, 8, file.header().cells);
      checkWorld(file, vtu::kSite, complex.cellSites, local, complex.frame);
      complex.cellSites = std::move(local);
    }
  }
  checkCells(file, complex);
  return complex;
}

}  // namespace voroform::mesh
