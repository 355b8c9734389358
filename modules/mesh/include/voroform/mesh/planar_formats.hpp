// Files of planar tessellations. All writers go through OutputFile: a file appears whole or not at all, and has the
// same bytes every time. The formats are described in docs/formats.md.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "voroform/mesh/formats.hpp"
#include "voroform/mesh/planar_tessellation.hpp"

namespace voroform::mesh {

// Field data by which files of writePlanarVtu are told from others: the version of the format, 1.
inline constexpr const char* kPlanarFormatField = "voroform_planar_format";

// VTK's XML unstructured grid, appended raw data, Float64 points with z = 0, cells of type VTK_POLYGON. A cell with
// several outlines has a polygon for each, a cell with holes is cut into triangles; all pieces carry the cell's number
// ("cell"), its site ("site", three components) and its values of the arrays given. Throws UsageError if an array has
// not one value a cell.
void writePlanarVtu(const std::filesystem::path& path, const PlanarTessellation& tessellation,
                    std::span<const CellData> data);

struct PlanarSvgOptions {
  // Values that the ends of the color scale stand for, blue at the low end and red at the high one; values beyond have
  // the ends' colors. low < high.
  double low = 0;
  double high = 1;
  std::string label;  // of the color bar
};

// A picture: each cell filled by the color of its value, with a color bar. Coordinates have two decimals of a pixel,
// the longer side of the tessellation has 800 pixels. Throws UsageError if there is not one value a cell, or on a scale
// without extent.
void writePlanarSvg(const std::filesystem::path& path, const PlanarTessellation& tessellation,
                    std::span<const double> values, const PlanarSvgOptions& options);

// sites.ply as writeSitesPly (formats.hpp) writes it, with z = 0.
void writePlanarSitesPly(const std::filesystem::path& path, std::span<const Vec2> sites);

}  // namespace voroform::mesh
