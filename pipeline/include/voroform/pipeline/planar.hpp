// Regions of the plane: their tessellations, measured and written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/density.hpp"
#include "voroform/cvt/optimized_sites.hpp"
#include "voroform/mesh/planar_moments.hpp"
#include "voroform/mesh/planar_region.hpp"
#include "voroform/mesh/planar_tessellation.hpp"
#include "voroform/mesh/planar_validate.hpp"
#include "voroform/metrics/regularity.hpp"
#include "voroform/pipeline/artifact_store.hpp"
#include "voroform/pipeline/form.hpp"

namespace voroform::pipeline {

// Whether the name stands for a region: shape2d:NAME, or a file that ends in .wkt or .xy.
bool isPlanarInput(const std::string& input);

struct PlanarInput {
  mesh::PlanarRegion region;
  InputRecord record;  // of the kind "region"
  double secondsReading = 0;
};
// Throws UsageError for an unknown shape2d: name or a name that stands for no region; InputError.
PlanarInput planarFromInput(const std::string& input, const RunContext& context);

// The sites of a file as readSites() reads them. Throws InputError for a site whose z is not 0 or that lies outside the
// region, too.
std::vector<Vec2> readPlanarSites(const std::filesystem::path& path, const mesh::PlanarRegion& region,
                                  const RunContext& context);

struct PlanarOptions : cvt::SiteOptions {
  // Initial sites for Initialization::given.
  std::vector<Vec2> given;
  // Where cells are to be small; not by curvature, which polygons do not have.
  cvt::DensityOptions density;
  // Memory the run may take, in bytes; a larger estimate throws EnvironmentError before anything is allocated. 0:
  // usableMemory().
  std::uint64_t memoryLimit = 0;
};

// Every violation of the options, as sentences naming field, value and rule; empty if there is none.
std::vector<std::string> validate(const PlanarOptions& options);

// All that is measured on a tessellation and its region.
struct PlanarMeasurement {
  std::vector<mesh::PlanarCellMoments> moments;  // one a cell
  std::vector<double> regularities;              // one a cell
  std::vector<std::uint8_t> onBoundary;          // one a cell
  mesh::PlanarCertificate certificate;
  metrics::Regularity regularity;
};
PlanarMeasurement measure(const mesh::PlanarTessellation& tessellation, const mesh::PlanarRegion& region,
                          std::uint64_t seed, const RunContext& context);

struct PlanarResult {
  mesh::PlanarTessellation tessellation;  // without empty cells
  cvt::SiteSummary summary;
  Index emptySites = 0;  // sites without a cell at the end: dropped
  PlanarMeasurement measurement;
  std::vector<std::string> warnings;
  double secondsTessellation = 0;
  double secondsMetrics = 0;
};

// Sites, their tessellation, clipped exactly, and its measures. The same bits for any number of threads. Warns of what
// was lost, and of a certificate that failed. Throws as cvt::optimizeSites does, EnvironmentError if the memory does
// not suffice.
PlanarResult tessellatePlanar(const PlanarInput& input, const PlanarOptions& options, const RunContext& context);

struct PlanarWriteOptions {
  PlanarOptions tessellate;  // as given to tessellatePlanar(), for the record
  int threads = 0;           // as given, for the record
};

// The upper end of the color scale of cells.svg; the lower one is the optimum.
inline constexpr double kPlanarScaleEnd = 0.09;

// Writes cells.vtu, cells.svg, sites.ply and at last metrics.json to the folder: all of them or none. Returns the names
// of the files written.
std::vector<std::string> writePlanarResults(const PlanarInput& input, const PlanarResult& result,
                                            const PlanarWriteOptions& options, const std::filesystem::path& folder,
                                            const RunContext& context);

}  // namespace voroform::pipeline
