#include "voroform/implicit/form_file.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/core/output_file.hpp"

namespace voroform::implicit {

namespace {

static_assert(std::endian::native == std::endian::little, "forms are written in little-endian order");

namespace fs = std::filesystem;

constexpr std::uint8_t kVtkTetrahedron = 10;
constexpr std::string_view kDataStart = "  <AppendedData encoding=\"raw\">\n_";
constexpr std::string_view kDataEnd = "\n  </AppendedData>\n</VTKFile>\n";
constexpr std::int64_t kFinestGrid = 512;

struct Counts {
  std::uint64_t vertices = 0;
  std::uint64_t tetrahedra = 0;
};

// What stands in the file after its header, in this order.
struct Content {
  std::vector<double> origin;
  std::vector<std::int64_t> gridResolution;
  std::vector<std::uint64_t> checksum;
  std::vector<double> values;
  std::vector<std::uint8_t> measured;  // 2 where unknown
  std::vector<Index> neighbors;
  std::vector<double> coordinates;
  std::vector<Index> connectivity;
  std::vector<std::int64_t> offsets;
  std::vector<std::uint8_t> types;
};

const Content kNoContent;  // for the arrays' types alone

// Calls visit(array, length) for all arrays of the content, which may be const or not.
template <class AnyContent, class Visit>
void visitArrays(AnyContent& content, const Counts& counts, const Visit& visit) {
  visit(content.origin, std::uint64_t{3});
  visit(content.gridResolution, std::uint64_t{1});
  visit(content.checksum, std::uint64_t{1});
  visit(content.values, counts.vertices);
  visit(content.measured, counts.vertices);
  visit(content.neighbors, 4 * counts.tetrahedra);
  visit(content.coordinates, 3 * counts.vertices);
  visit(content.connectivity, 4 * counts.tetrahedra);
  visit(content.offsets, counts.tetrahedra);
  visit(content.types, counts.tetrahedra);
}

template <class Array>
std::uint64_t bytesOf(const Array&, std::uint64_t length) {
  return length * sizeof(typename Array::value_type);
}

// The header depends on the two counts alone, so a reader can compare it as a whole.
std::string header(const Counts& counts) {
  std::vector<std::uint64_t> offsets;
  std::uint64_t next = 0;
  visitArrays(kNoContent, counts, [&](const auto& array, std::uint64_t length) {
    offsets.push_back(next);
    next += sizeof(std::uint64_t) + bytesOf(array, length);
  });
  std::size_t k = 0;
  const auto array = [&](const char* type, const char* name, const char* extent) {
    return "<DataArray type=\"" + std::string(type) + "\" Name=\"" + name + "\" " + extent +
           "format=\"appended\" offset=\"" + std::to_string(offsets[k++]) + "\"/>\n";
  };
  std::string text =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n"
      "    <FieldData>\n";
  text += "      " + array("Float64", "origin", "NumberOfTuples=\"3\" ");
  text += "      " + array("Int64", "grid_resolution", "NumberOfTuples=\"1\" ");
  text += "      " + array("UInt64", "checksum", "NumberOfTuples=\"1\" ");
  text += "    </FieldData>\n    <Piece NumberOfPoints=\"" + std::to_string(counts.vertices) + "\" NumberOfCells=\"" +
          std::to_string(counts.tetrahedra) + "\">\n";
  // One array a statement: each takes the next offset.
  text += "      <PointData Scalars=\"f\">\n";
  text += "        " + array("Float64", "f", "");
  text += "        " + array("UInt8", "measured", "");
  text += "      </PointData>\n      <CellData>\n";
  text += "        " + array("Int32", "neighbors", "NumberOfComponents=\"4\" ");
  text += "      </CellData>\n      <Points>\n";
  text += "        " + array("Float64", "points", "NumberOfComponents=\"3\" ");
  text += "      </Points>\n      <Cells>\n";
  text += "        " + array("Int32", "connectivity", "");
  text += "        " + array("Int64", "offsets", "");
  text += "        " + array("UInt8", "types", "");
  text += "      </Cells>\n";
  text += "    </Piece>\n  </UnstructuredGrid>\n";
  return text.append(kDataStart);
}

std::uint64_t fileSize(const Counts& counts) {
  std::uint64_t size = header(counts).size() + kDataEnd.size();
  visitArrays(kNoContent, counts,
              [&](const auto& array, std::uint64_t length) { size += sizeof(std::uint64_t) + bytesOf(array, length); });
  return size;
}

// FNV-1a over eight-byte words, the last one filled up with zeros.
std::uint64_t hashed(std::uint64_t hash, const void* data, std::size_t bytes) {
  constexpr std::uint64_t kPrime = 1099511628211ULL;
  const char* next = static_cast<const char*>(data);
  while (bytes > 0) {
    std::uint64_t word = 0;
    const std::size_t part = std::min(bytes, sizeof word);
    std::memcpy(&word, next, part);
    hash = (hash ^ word) * kPrime;
    hash ^= hash >> 32U;  // carries high bits down, which the product alone does not
    next += part;
    bytes -= part;
  }
  return hash;
}

// Of everything but the checksum itself.
std::uint64_t checksumOf(const Content& content, const Counts& counts) {
  std::uint64_t hash = 14695981039346656037ULL;
  visitArrays(content, counts, [&](const auto& array, std::uint64_t length) {
    if (static_cast<const void*>(&array) == static_cast<const void*>(&content.checksum)) return;
    hash = hashed(hash, array.data(), static_cast<std::size_t>(bytesOf(array, length)));
  });
  return hash;
}

Content contentOf(const TetrahedralForm& form, const Frame& frame, const Counts& counts) {
  constexpr std::uint8_t kUnknown = 2;
  const TetrahedralMesh& mesh = form.mesh();
  Content content;
  content.origin = {frame.origin.x(), frame.origin.y(), frame.origin.z()};
  content.gridResolution = {form.gridResolution()};
  content.measured = mesh.measured;
  if (mesh.measured.empty()) content.measured.assign(mesh.vertices.size(), kUnknown);
  content.values.reserve(mesh.vertices.size());
  content.coordinates.reserve(3 * mesh.vertices.size());
  for (const FormVertex& vertex : mesh.vertices) {
    content.values.push_back(vertex.value);
    content.coordinates.insert(content.coordinates.end(), vertex.position.begin(), vertex.position.end());
  }
  content.neighbors.reserve(4 * mesh.tetrahedra.size());
  content.connectivity.reserve(4 * mesh.tetrahedra.size());
  for (const FormTetrahedron& tetrahedron : mesh.tetrahedra) {
    content.neighbors.insert(content.neighbors.end(), tetrahedron.neighbors.begin(), tetrahedron.neighbors.end());
    content.connectivity.insert(content.connectivity.end(), tetrahedron.vertices.begin(), tetrahedron.vertices.end());
    content.offsets.push_back(static_cast<std::int64_t>(content.connectivity.size()));
  }
  content.types.assign(mesh.tetrahedra.size(), kVtkTetrahedron);
  content.checksum = {checksumOf(content, counts)};
  return content;
}

// A form's file while it is read; every complaint names it.
class FormReader {
 public:
  explicit FormReader(const fs::path& path) : path_(path), stream_(openInputFile(path)) {
    std::error_code error;
    size_ = fs::file_size(path, error);
    if (error) fail(error.message());
  }

  [[noreturn]] void fail(const std::string& what) const { throw InputError(path_.string() + ": " + what); }

  Counts readHeader() {
    // Far longer than any header of ours.
    constexpr std::size_t kMost = 4096;
    std::string start(static_cast<std::size_t>(std::min<std::uint64_t>(size_, kMost)), '\0');
    stream_.read(start.data(), static_cast<std::streamsize>(start.size()));
    if (!stream_) fail("cannot be read");
    const Counts counts = {number(start, "NumberOfPoints=\""), number(start, "NumberOfCells=\"")};
    const std::string expected = header(counts);
    const auto [found, wanted] = std::mismatch(start.begin(), start.end(), expected.begin(), expected.end());
    if (wanted != expected.end()) {
      const auto line = 1 + std::count(start.begin(), found, '\n');
      fail("line " + std::to_string(line) + ": expected '" + lineAt(expected, wanted - expected.begin()) +
           "', found '" + lineAt(start, found - start.begin()) + "': this is not a form that voroform wrote");
    }
    const std::uint64_t wantedSize = fileSize(counts);
    if (size_ != wantedSize) {
      fail("expected " + std::to_string(wantedSize) + " bytes for " + std::to_string(counts.vertices) +
           " vertices and " + std::to_string(counts.tetrahedra) + " tetrahedra, found " + std::to_string(size_));
    }
    stream_.seekg(static_cast<std::streamoff>(expected.size()));
    return counts;
  }

  Content readContent(const Counts& counts) {
    Content content;
    visitArrays(content, counts, [&](auto& array, std::uint64_t length) {
      std::uint64_t bytes = 0;
      read(&bytes, sizeof bytes);
      if (bytes != bytesOf(array, length)) {
        fail("expected a block of " + std::to_string(bytesOf(array, length)) + " bytes, found one of " +
             std::to_string(bytes));
      }
      array.resize(static_cast<std::size_t>(length));
      read(array.data(), bytes);
    });
    std::string end(kDataEnd.size(), '\0');
    read(end.data(), end.size());
    if (end != kDataEnd) fail("expected the end of the appended data, found something else");
    return content;
  }

 private:
  void read(void* target, std::uint64_t bytes) {
    stream_.read(static_cast<char*>(target), static_cast<std::streamsize>(bytes));
    if (!stream_) fail("ends too early");
  }

  std::uint64_t number(const std::string& text, std::string_view key) const {
    const std::size_t at = text.find(key);
    if (at == std::string::npos) fail("expected a VTK unstructured grid with " + std::string(key) + "…\", found none");
    const char* first = text.data() + at + key.size();
    std::uint64_t value = 0;
    const auto parsed = std::from_chars(first, text.data() + text.size(), value);
    if (parsed.ec != std::errc() || value > std::numeric_limits<Index>::max()) {
      fail("expected a number of at most " + std::to_string(std::numeric_limits<Index>::max()) + " after " +
           std::string(key));
    }
    return value;
  }

  // The line around a position, printable and not too long.
  static std::string lineAt(const std::string& text, std::ptrdiff_t position) {
    constexpr std::size_t kLongest = 120;
    auto at = static_cast<std::size_t>(position);
    const std::size_t before = at == 0 ? std::string::npos : text.rfind('\n', at - 1);
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    std::string line = text.substr(begin, std::min(text.find('\n', begin) - begin, kLongest));
    for (char& c : line) {
      if (c < ' ' || c > '~') c = '?';
    }
    return line;
  }

  fs::path path_;
  std::ifstream stream_;
  std::uint64_t size_ = 0;
};

TetrahedralMesh meshOf(const Content& content, const Counts& counts, const FormReader& reader) {
  TetrahedralMesh mesh;
  mesh.vertices.resize(static_cast<std::size_t>(counts.vertices));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    mesh.vertices[v] = {Vec3(&content.coordinates[3 * v]), content.values[v]};
  }
  mesh.tetrahedra.resize(static_cast<std::size_t>(counts.tetrahedra));
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    if (content.offsets[t] != static_cast<std::int64_t>(4 * (t + 1)) || content.types[t] != kVtkTetrahedron) {
      reader.fail("cell " + std::to_string(t) + ": expected a tetrahedron, found another kind of cell");
    }
    std::copy_n(&content.connectivity[4 * t], 4, mesh.tetrahedra[t].vertices.begin());
    std::copy_n(&content.neighbors[4 * t], 4, mesh.tetrahedra[t].neighbors.begin());
  }
  const auto unlike = [&](std::uint8_t flag) { return flag > 2 || (flag == 2) != (content.measured[0] == 2); };
  if (std::any_of(content.measured.begin(), content.measured.end(), unlike)) {
    reader.fail("the flags of measured vertices must be 0 or 1, or all 2 if unknown");
  }
  if (!content.measured.empty() && content.measured[0] != 2) mesh.measured = content.measured;
  return mesh;
}

}  // namespace

void writeForm(const std::filesystem::path& path, const TetrahedralForm& form, const Frame& frame) {
  const Counts counts = {form.mesh().vertices.size(), form.mesh().tetrahedra.size()};
  const Content content = contentOf(form, frame, counts);
  OutputFile file(path);
  file.stream() << header(counts);
  visitArrays(content, counts, [&](const auto& array, std::uint64_t length) {
    const std::uint64_t bytes = bytesOf(array, length);
    file.stream().write(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    file.stream().write(reinterpret_cast<const char*>(array.data()), static_cast<std::streamsize>(bytes));
  });
  file.stream() << kDataEnd;
  file.commit();
}

FormFile readForm(const std::filesystem::path& path, const RunContext& context) {
  FormReader reader(path);
  const Counts counts = reader.readHeader();
  const Content content = reader.readContent(counts);
  if (content.checksum[0] != checksumOf(content, counts)) {
    reader.fail("the data do not agree with their checksum: the file was damaged or changed");
  }
  const Vec3 origin(content.origin.data());
  if (!origin.allFinite()) reader.fail("the origin must be finite");
  const std::int64_t resolution = content.gridResolution[0];
  if (resolution < 1 || resolution > kFinestGrid) {
    reader.fail("expected a grid resolution in [1, " + std::to_string(kFinestGrid) + "], found " +
                std::to_string(resolution));
  }
  TetrahedralMesh mesh = meshOf(content, counts, reader);
  try {
    return {std::make_shared<TetrahedralForm>(std::move(mesh), static_cast<int>(resolution), context), Frame{origin}};
  } catch (const InputError& problem) {
    reader.fail(problem.what());
  }
}

}  // namespace voroform::implicit
