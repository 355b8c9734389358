#include "voroform/pipeline/planar.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "form_parts.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/cvt/planar_domain.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/pipeline/site_options.hpp"
#include "voroform/voronoi/planar.hpp"
#include "warnings.hpp"

namespace voroform::pipeline {

namespace {

constexpr std::string_view kShapePrefix = "shape2d:";
constexpr const char* kKind = "region";

// Measured peaks of whole runs, certificate and writers included, at a million sites of the square and the star: 0.72
// and 0.83 kB a site. A density takes no grid here.
constexpr cvt::MemoryCost kCost = {1200, 0};

void throwIfInvalid(const PlanarOptions& options) {
  if (const auto violations = validate(options); !violations.empty()) throw UsageError(violations.front());
}

// Takes out the cells without loops, which have no neighbors; gives their number.
Index dropEmptyCells(mesh::PlanarTessellation& tessellation) {
  const Index count = tessellation.cellCount();
  std::vector<Index> renumbered(static_cast<std::size_t>(count), kNone);
  std::vector<Vec2> sites;
  std::vector<std::uint32_t> cellOffsets = {0};
  for (Index cell = 0; cell < count; ++cell) {
    const std::size_t end = tessellation.endLoop(cell);
    if (tessellation.firstLoop(cell) == end) continue;
    renumbered[static_cast<std::size_t>(cell)] = static_cast<Index>(sites.size());
    sites.push_back(tessellation.sites[static_cast<std::size_t>(cell)]);
    cellOffsets.push_back(static_cast<std::uint32_t>(end));
  }
  for (Index& neighbor : tessellation.neighbors) {
    if (neighbor != kNone) neighbor = renumbered[static_cast<std::size_t>(neighbor)];
  }
  tessellation.sites = std::move(sites);
  tessellation.cellOffsets = std::move(cellOffsets);
  return count - tessellation.cellCount();
}

void warnOfLosses(const PlanarResult& result, const RunContext& context) {
  warnOfEmptySites(result.emptySites, "region", context);
  const mesh::PlanarCertificate& certificate = result.measurement.certificate;
  if (!certificate.valid) warnOfProblems(certificate.problems, context);
}

}  // namespace

bool isPlanarInput(const std::string& input) {
  if (input.starts_with(kShapePrefix)) return true;
  const std::string extension = lowerCaseExtension(input);
  return extension == ".wkt" || extension == ".xy";
}

PlanarInput planarFromInput(const std::string& input, const RunContext& context) {
  const Stopwatch watch;
  if (input.starts_with(kShapePrefix)) {
    const std::string name = input.substr(kShapePrefix.size());
    InputRecord record;
    record.kind = kKind;
    record.name = name;
    return {mesh::namedRegion(name), std::move(record), watch.seconds()};
  }
  if (!isPlanarInput(input)) {
    throw UsageError(input + ": expected a region of the plane: shape2d:NAME, or a .wkt or .xy file");
  }
  context.report("read region", 0);
  mesh::PlanarRegion region = mesh::readPlanarRegion(input, context);
  InputRecord record = fileRecord(input, kKind, lowerCaseExtension(input) == ".wkt" ? "WKT" : "XY");
  context.report("read region", 1);
  return {std::move(region), std::move(record), watch.seconds()};
}

std::vector<Vec2> readPlanarSites(const std::filesystem::path& path, const mesh::PlanarRegion& region,
                                  const RunContext& context) {
  std::vector<Vec2> sites;
  for (const Vec3& site : readSites(path, context)) {
    const auto fail = [&](const std::string& fault) {
      throw InputError(path.string() + ": site " + std::to_string(sites.size() + 1) + " " + fault);
    };
    if (site.z() != 0) fail("lies off the plane: its z is " + std::to_string(site.z()) + ", expected 0");
    if (!region.contains(site.head<2>())) fail("lies outside the region");
    sites.emplace_back(site.head<2>());
  }
  return sites;
}

std::vector<std::string> validate(const PlanarOptions& options) {
  std::vector<std::string> violations = validate(static_cast<const cvt::SiteOptions&>(options));
  const std::vector<std::string> others = validate(options.density);
  violations.insert(violations.end(), others.begin(), others.end());
  if (options.density.kind == cvt::DensityKind::curvature) {
    violations.emplace_back("density is curvature, but a polygon's edges are straight: use boundary or constant");
  }
  return violations;
}

PlanarMeasurement measure(const mesh::PlanarTessellation& tessellation, const mesh::PlanarRegion& region,
                          std::uint64_t seed, const RunContext& context) {
  PlanarMeasurement result;
  context.report("certificate", 0);
  mesh::PlanarValidateOptions options;
  options.seed = seed;
  result.certificate = mesh::validate(tessellation, region, options, context);
  context.report("certificate", 1);
  result.moments = mesh::cellMoments(tessellation, context);
  result.regularities = metrics::regularities(result.moments);
  result.onBoundary = mesh::boundaryCells(tessellation);
  result.regularity = metrics::planarRegularity(result.regularities, result.onBoundary);
  context.throwIfCancelled();
  return result;
}

PlanarResult tessellatePlanar(const PlanarInput& input, const PlanarOptions& options, const RunContext& context) {
  throwIfInvalid(options);
  const Index sites = cvt::siteCount(options, options.given.size());
  cvt::requireMemory(options, sites, kCost, options.memoryLimit);
  PlanarResult result;
  const RunContext recording = recordWarnings(context, result.warnings);
  Stopwatch watch;
  cvt::PlanarDomain domain(input.region);
  const double cellSize = std::sqrt(input.region.area() / std::max(sites, 1));
  domain.setDensity(cvt::makeDensity(input.region, options.density, cellSize));
  cvt::OptimizedSites<2> optimized = cvt::optimizeSites<2>(domain, options.given, options, recording);
  result.summary = std::move(optimized.summary);
  const voronoi::PlanarDiagram diagram = voronoi::buildPlanarDiagram(optimized.sites, domain.siteBox(), recording);
  const voronoi::PlanarClip clip = voronoi::clipPlanar(diagram, input.region, recording);
  result.tessellation = voronoi::toTessellation(diagram, clip, recording);
  result.emptySites = dropEmptyCells(result.tessellation);
  result.secondsTessellation = watch.seconds();
  watch.restart();
  result.measurement = measure(result.tessellation, input.region, options.seed, recording);
  result.secondsMetrics = watch.seconds();
  warnOfLosses(result, recording);
  return result;
}

}  // namespace voroform::pipeline
