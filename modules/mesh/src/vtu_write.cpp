// Writes cells.vtu.
#include <string>
#include <vector>

#include "voroform/core/error.hpp"
#include "voroform/core/output_file.hpp"
#include "voroform/mesh/formats.hpp"
#include "vtu_appended.hpp"
#include "vtu_layout.hpp"

namespace voroform::mesh {

namespace {

using Buffer = vtu::AppendedBuffer;
using Layout = vtu::AppendedLayout;

void addPoints(Layout& layout, const std::string& name, const std::vector<Vec3>& points, const Frame& frame) {
  layout.array("Float64", name, 3, -1, points.size() * sizeof(Vec3), [&](Buffer& buffer) {
    if (!vtu::hasOrigin(frame)) {
      buffer.write(points.data(), points.size() * sizeof(Vec3));
      return;
    }
    for (const Vec3& point : points) buffer.put(Vec3(frame.origin + point));
  });
}

void checkSizes(const std::filesystem::path& path, const PolyhedralComplex& complex, std::span<const CellData> data) {
  const auto cells = static_cast<std::size_t>(complex.cellCount);
  for (const CellData& array : data) {
    if (array.values.size() != cells) {
      throw UsageError(path.string() + ": the cell data '" + array.name + "' has " +
                       std::to_string(array.values.size()) + " values for " + std::to_string(cells) + " cells");
    }
    if (array.name == vtu::kSite || array.name == vtu::kSiteLocal) {
      throw UsageError(path.string() + ": the name '" + array.name + "' is taken by the cells' sites");
    }
  }
  if (!complex.cellSites.empty() && complex.cellSites.size() != cells) {
    throw UsageError(path.string() + ": " + std::to_string(complex.cellSites.size()) + " sites for " +
                     std::to_string(cells) + " cells");
  }
}

}  // namespace

void writeCellsVtu(const std::filesystem::path& path, const PolyhedralComplex& complex,
                   std::span<const CellData> data) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(FaceTag) == 1);
  checkSizes(path, complex, data);
  const CellFaces rows = cellFaces(complex);
  const vtu::StreamEnds ends = vtu::streamEnds(complex, rows);
  const auto last = [](const std::vector<std::int64_t>& values) {
    return values.empty() ? std::uint64_t{0} : static_cast<std::uint64_t>(values.back());
  };
  const bool shifted = vtu::hasOrigin(complex.frame);

  Layout layout;
  layout.text("      <FieldData>");
  const std::vector<std::int32_t> format = {vtu::kFormatVersion};
  const std::vector<Vec3> origin = {complex.frame.origin};
  layout.vector("Int32", vtu::kFormat, 1, true, format);
  layout.vector("Float64", vtu::kOrigin, 3, true, origin);
  layout.vector("Int64", vtu::kFaceOffsets, 1, true, complex.faceOffsets);
  layout.vector("Int32", vtu::kFaceVertices, 1, true, complex.faceVertices);
  layout.vector("Int32", vtu::kFaceCells, 2, true, complex.faceCells);
  layout.vector("UInt8", vtu::kFaceTags, 1, true, complex.faceTags);
  layout.text("      </FieldData>");
  layout.text("    <Piece NumberOfPoints=\"" + std::to_string(complex.vertices.size()) + "\" NumberOfCells=\"" +
              std::to_string(complex.cellCount) + "\">");
  layout.text("      <Points>");
  addPoints(layout, "Points", complex.vertices, complex.frame);
  layout.text("      </Points>");
  layout.text("      <Cells>");
  layout.array("Int64", "connectivity", 1, -1, last(ends.connectivity) * 8, [&](Buffer& buffer) {
    vtu::emitConnectivity(
        complex, rows, [&](std::int64_t v) { buffer.put(v); }, [] {});
  });
  layout.vector("Int64", "offsets", 1, false, ends.connectivity);
  const std::vector<std::uint8_t> types(static_cast<std::size_t>(complex.cellCount), vtu::kPolyhedronType);
  layout.vector("UInt8", "types", 1, false, types);
  layout.array("Int64", "faces", 1, -1, last(ends.faces) * 8, [&](Buffer& buffer) {
    vtu::emitFaces(
        complex, rows, [&](std::int64_t value) { buffer.put(value); }, [] {});
  });
  layout.vector("Int64", "faceoffsets", 1, false, ends.faces);
  layout.text("      </Cells>");
  layout.text("      <PointData>");
  if (shifted) layout.vector("Float64", vtu::kLocal, 3, false, complex.vertices);
  layout.text("      </PointData>");
  layout.text("      <CellData>");
  for (const CellData& array : data) layout.vector("Float64", array.name, 1, false, array.values);
  if (!complex.cellSites.empty()) {
    addPoints(layout, vtu::kSite, complex.cellSites, complex.frame);
    if (shifted) layout.vector("Float64", vtu::kSiteLocal, 3, false, complex.cellSites);
  }
  layout.text("      </CellData>");
  layout.text("    </Piece>");
  OutputFile file(path);
  layout.write(file.stream());
  file.commit();
}

}  // namespace voroform::mesh
