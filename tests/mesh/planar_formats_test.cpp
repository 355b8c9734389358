// Files of planar tessellations; what VTK's own reader makes of them.
#include "voroform/mesh/planar_formats.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPolygon.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridReader.h>

#include <cstring>
#include <limits>

#include "file_support.hpp"
#include "support/planar_tessellations.hpp"
#include "voroform/core/error.hpp"
#include "voroform/mesh/planar_moments.hpp"

namespace voroform::mesh {
namespace {

using ::testing::HasSubstr;
using testing::readAll;
using testing::TemporaryFolder;

std::vector<double> areasOf(const PlanarTessellation& tessellation) {
  std::vector<double> areas;
  for (const PlanarCellMoments& moments : cellMoments(tessellation, RunContext{})) areas.push_back(moments.area);
  return areas;
}

// The area with its sign: VTK's is always positive.
double signedArea(vtkUnstructuredGrid& grid, vtkIdList& ids) {
  double sum = 0;
  for (vtkIdType k = 0; k < ids.GetNumberOfIds(); ++k) {
    Vec3 a;
    Vec3 b;
    grid.GetPoint(ids.GetId(k), a.data());
    grid.GetPoint(ids.GetId((k + 1) % ids.GetNumberOfIds()), b.data());
    EXPECT_EQ(a.z(), 0);
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum / 2;
}

struct ReadBack {
  std::vector<double> areas;  // by cell, of its pieces by VTK
  std::vector<int> pieces;    // by cell
  std::vector<vtkIdType> longest;
};

// Reads the file, checks each piece's data against the tessellation.
void readBack(const std::filesystem::path& path, const PlanarTessellation& tessellation, ReadBack& result) {
  const std::vector<double> areas = areasOf(tessellation);
  writePlanarVtu(path, tessellation, std::vector<CellData>{{"area", areas}});
  vtkNew<vtkXMLUnstructuredGridReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  ASSERT_EQ(reader->GetErrorCode(), 0U);
  vtkUnstructuredGrid& grid = *reader->GetOutput();
  vtkDataArray* number = grid.GetCellData()->GetArray("cell");
  vtkDataArray* area = grid.GetCellData()->GetArray("area");
  vtkDataArray* site = grid.GetCellData()->GetArray("site");
  ASSERT_NE(number, nullptr);
  ASSERT_NE(area, nullptr);
  ASSERT_NE(site, nullptr);
  ASSERT_EQ(site->GetNumberOfComponents(), 3);
  result.areas.assign(areas.size(), 0);
  result.pieces.assign(areas.size(), 0);
  result.longest.assign(areas.size(), 0);
  vtkNew<vtkIdList> ids;
  for (vtkIdType piece = 0; piece < grid.GetNumberOfCells(); ++piece) {
    ASSERT_EQ(grid.GetCellType(piece), 7);
    const auto cell = static_cast<std::size_t>(number->GetComponent(piece, 0));
    grid.GetCellPoints(piece, ids);
    double normal[3];
    const double vtkArea = vtkPolygon::ComputeArea(grid.GetPoints(), ids->GetNumberOfIds(), ids->GetPointer(0), normal);
    EXPECT_NEAR(vtkArea, signedArea(grid, *ids), 1e-12) << "turned clockwise";
    result.areas[cell] += vtkArea;
    ++result.pieces[cell];
    result.longest[cell] = std::max(result.longest[cell], ids->GetNumberOfIds());
    EXPECT_EQ(area->GetComponent(piece, 0), areas[cell]);
    EXPECT_EQ(site->GetComponent(piece, 0), tessellation.sites[cell].x());
    EXPECT_EQ(site->GetComponent(piece, 1), tessellation.sites[cell].y());
    EXPECT_EQ(site->GetComponent(piece, 2), 0);
  }
}

TEST(PlanarVtu, VtkReadsTheCells) {
  const TemporaryFolder folder;
  ReadBack read;
  readBack(folder / "cells.vtu", testing::squares(5), read);
  EXPECT_THAT(read.areas, ::testing::Each(1.0));
  EXPECT_THAT(read.pieces, ::testing::Each(1));
  EXPECT_THAT(read.longest, ::testing::Each(4));
}

TEST(PlanarVtu, CellsWithHolesAreCutIntoTriangles) {
  const TemporaryFolder folder;
  ReadBack read;
  readBack(folder / "cells.vtu", testing::ringAndIsland(), read);
  ASSERT_EQ(read.areas.size(), 2U);
  EXPECT_NEAR(read.areas[0], 35, 1e-12);
  EXPECT_NEAR(read.areas[1], 3, 1e-12);
  EXPECT_THAT(read.longest, ::testing::Each(3));
  // A ring of 4 + 4 corners has 8 triangles.
  EXPECT_EQ(read.pieces[0], 9);
  EXPECT_EQ(read.pieces[1], 8);
}

TEST(PlanarVtu, CellsWithSeveralOutlinesHaveAPolygonForEach) {
  const TemporaryFolder folder;
  // Not convex, too.
  const PlanarTessellation two = testing::joinLoops({{0, 0}, {4, 0}, {4, 4}, {3, 1}, {6, 0}, {7, 0}, {6, 1}},
                                                    {{{0, 1, 2, 3}, {4, 5, 6}}}, {{3, 0.5}});
  ReadBack read;
  readBack(folder / "cells.vtu", two, read);
  EXPECT_NEAR(read.areas[0], 4.5, 1e-12);
  EXPECT_EQ(read.pieces[0], 2);
  EXPECT_EQ(read.longest[0], 4);
}

TEST(PlanarVtu, SameBytesEveryTime) {
  const TemporaryFolder folder;
  const std::vector<CellData> data = {{"a<\"b\">", {1, 2}}};
  writePlanarVtu(folder / "a.vtu", testing::ringAndIsland(), data);
  writePlanarVtu(folder / "b.vtu", testing::ringAndIsland(), data);
  EXPECT_EQ(readAll(folder / "a.vtu"), readAll(folder / "b.vtu"));
  EXPECT_THAT(readAll(folder / "a.vtu").substr(0, 1000), HasSubstr(kPlanarFormatField));
}

TEST(PlanarVtu, RefusesDataOfTheWrongSizeOrName) {
  const TemporaryFolder folder;
  for (const CellData& data : {CellData{"area", {1}}, CellData{"cell", {1, 2}}, CellData{"site", {1, 2}}}) {
    EXPECT_THROW(writePlanarVtu(folder / "c.vtu", testing::ringAndIsland(), std::vector<CellData>{data}), UsageError);
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "c.vtu"));
}

std::string svgOf(const PlanarTessellation& tessellation, const std::vector<double>& values,
                  const PlanarSvgOptions& options) {
  const TemporaryFolder folder;
  writePlanarSvg(folder / "cells.svg", tessellation, values, options);
  return readAll(folder / "cells.svg");
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

constexpr const char* kBlue = "#2c7bb6";
constexpr const char* kMiddle = "#ffffbf";
constexpr const char* kRed = "#d7191c";

TEST(PlanarSvg, FillsTheCellsByTheirValues) {
  PlanarSvgOptions options;
  options.low = 0.08;
  options.high = 0.09;
  options.label = "G <&>";
  const std::string svg = svgOf(testing::squares(2), {0.08, 0.085, 0.09, 0.5}, options);
  const auto path = [](const std::string& color, const std::string& d) {
    return "<path fill=\"" + color + "\" d=\"" + d + "\"/>";
  };
  // Pixels downwards: the first cell is the lower left one.
  EXPECT_THAT(svg, HasSubstr(path(kBlue, "M20.00,820.00 420.00,820.00 420.00,420.00 20.00,420.00z")));
  EXPECT_THAT(svg, HasSubstr(path(kMiddle, "M420.00,820.00 820.00,820.00 820.00,420.00 420.00,420.00z")));
  EXPECT_EQ(count(svg, std::string("<path fill=\"") + kRed), 2U);
  EXPECT_EQ(count(svg, "<path"), 4U);
  EXPECT_THAT(svg, HasSubstr("G &lt;&amp;&gt;"));
  for (const char* tick : {">0.0800<", ">0.0825<", ">0.0850<", ">0.0875<", ">≥ 0.0900<"}) {
    EXPECT_THAT(svg, HasSubstr(tick));
  }
}

TEST(PlanarSvg, ValuesBeyondTheScale) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = svgOf(testing::squares(2), {-7, nan, -std::numeric_limits<double>::infinity(), 0}, {});
  EXPECT_EQ(count(svg, std::string("<path fill=\"") + kBlue), 3U);
  EXPECT_EQ(count(svg, std::string("<path fill=\"") + kRed), 1U);
}

TEST(PlanarSvg, HolesStayOpen) {
  const std::string svg = svgOf(testing::ringAndIsland(), {0, 1}, {});
  EXPECT_THAT(svg, HasSubstr("fill-rule=\"evenodd\""));
  EXPECT_EQ(count(svg, "<path"), 2U);
  EXPECT_EQ(count(svg, "zM") + count(svg, "z\"/>"), 5U) << "one end for each loop";
}

TEST(PlanarSvg, TenThousandCellsTakeLessThanThreeMegabytes) {
  PlanarTessellation tessellation = testing::squares(101);
  for (Vec2& vertex : tessellation.vertices) vertex *= 1.0 / 7;
  EXPECT_LT(svgOf(tessellation, std::vector<double>(10201, 0.3), {}).size(), 3'000'000U);
}

TEST(PlanarSvg, RefusesWrongSizesAndScales) {
  EXPECT_THROW(svgOf(testing::squares(2), {1, 2}, {}), UsageError);
  PlanarSvgOptions options;
  options.high = options.low;
  EXPECT_THROW(svgOf(testing::squares(1), {1}, options), UsageError);
}

TEST(PlanarSites, StandInThePlane) {
  const TemporaryFolder folder;
  writePlanarSitesPly(folder / "sites.ply", std::vector<Vec2>{{0.1, -2}, {1e300, 1.0 / 3}});
  const std::string bytes = readAll(folder / "sites.ply");
  const double expected[6] = {0.1, -2, 0, 1e300, 1.0 / 3, 0};
  ASSERT_GT(bytes.size(), sizeof expected);
  EXPECT_EQ(std::memcmp(bytes.data() + bytes.size() - sizeof expected, expected, sizeof expected), 0);
}

}  // namespace
}  // namespace voroform::mesh
