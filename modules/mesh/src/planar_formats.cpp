// VTU and PLY of planar tessellations.
#include "voroform/mesh/planar_formats.hpp"

#include <algorithm>

#include "planar_pieces.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/output_file.hpp"
#include "vtu_appended.hpp"

namespace voroform::mesh {

namespace {

constexpr std::uint8_t kPolygonType = 7;
constexpr std::int32_t kFormatVersion = 1;
constexpr const char* kCell = "cell";
constexpr const char* kSite = "site";

void checkData(const std::filesystem::path& path, const PlanarTessellation& tessellation,
               std::span<const CellData> data) {
  const auto cells = static_cast<std::size_t>(tessellation.cellCount());
  for (const CellData& array : data) {
    if (array.values.size() != cells) {
      throw UsageError(path.string() + ": the cell data '" + array.name + "' has " +
                       std::to_string(array.values.size()) + " values for " + std::to_string(cells) + " cells");
    }
    if (array.name == kCell || array.name == kSite) {
      throw UsageError(path.string() + ": the name '" + array.name + "' is taken by the cells' own data");
    }
  }
}

std::vector<Vec3> inSpace(std::span<const Vec2> points) {
  std::vector<Vec3> result;
  result.reserve(points.size());
  for (const Vec2& point : points) result.emplace_back(point.x(), point.y(), 0);
  return result;
}

// The value of each piece's cell.
template <class T>
std::vector<T> ofPieces(const PlanarPieces& pieces, const std::vector<T>& ofCells) {
  std::vector<T> result;
  result.reserve(pieces.cells.size());
  for (const Index cell : pieces.cells) result.push_back(ofCells[static_cast<std::size_t>(cell)]);
  return result;
}

}  // namespace

void writePlanarVtu(const std::filesystem::path& path, const PlanarTessellation& tessellation,
                    std::span<const CellData> data) {
  checkData(path, tessellation, data);
  const PlanarPieces pieces = planarPieces(tessellation);
  const std::vector<Vec3> points = inSpace(pieces.points);
  const std::vector<Vec3> sites = ofPieces(pieces, inSpace(tessellation.sites));
  const std::vector<std::uint8_t> types(pieces.cells.size(), kPolygonType);
  std::vector<std::vector<double>> arrays;
  for (const CellData& array : data) arrays.push_back(ofPieces(pieces, array.values));

  const std::vector<std::int32_t> format = {kFormatVersion};

  vtu::AppendedLayout layout;
  layout.text("    <FieldData>");
  layout.vector("Int32", kPlanarFormatField, 1, true, format);
  layout.text("    </FieldData>");
  layout.text("    <Piece NumberOfPoints=\"" + std::to_string(points.size()) + "\" NumberOfCells=\"" +
              std::to_string(pieces.cells.size()) + "\">");
  layout.text("      <Points>");
  layout.vector("Float64", "Points", 3, false, points);
  layout.text("      </Points>");
  layout.text("      <Cells>");
  layout.vector("Int64", "connectivity", 1, false, pieces.connectivity);
  layout.vector("Int64", "offsets", 1, false, pieces.ends);
  layout.vector("UInt8", "types", 1, false, types);
  layout.text("      </Cells>");
  layout.text("      <CellData>");
  layout.vector("Int32", kCell, 1, false, pieces.cells);
  for (std::size_t k = 0; k < arrays.size(); ++k) layout.vector("Float64", data[k].name, 1, false, arrays[k]);
  layout.vector("Float64", kSite, 3, false, sites);
  layout.text("      </CellData>");
  layout.text("    </Piece>");
  OutputFile file(path);
  layout.write(file.stream());
  file.commit();
}

void writePlanarSitesPly(const std::filesystem::path& path, std::span<const Vec2> sites) {
  writeSitesPly(path, inSpace(sites), Frame{});
}

}  // namespace voroform::mesh
