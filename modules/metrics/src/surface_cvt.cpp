#include "voroform/metrics/surface_cvt.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>

#include "surface_cvt_cells.hpp"
#include "surface_cvt_grid.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/core/random.hpp"

namespace voroform::metrics {

namespace {

constexpr std::size_t kGrain = 1024;
// More samples than this are taken for a mistake in the spacing.
constexpr double kMostSamples = 1e8;
// Sites move by this multiple of the way to their centroids. On a plane the energy falls with any factor between 0 and
// 2; above 1 the long waves of the density, which Lloyd's method damps slowly, fall faster (Xiao 2010).
constexpr double kRelaxation = 1.6;

using Corners = std::array<Vec3, 3>;

Corners cornersOf(const mesh::TriangleMesh& mesh, Index triangle) {
  const auto& indices = mesh.triangles[static_cast<std::size_t>(triangle)];
  const auto corner = [&](std::size_t k) -> const Vec3& { return mesh.vertices[static_cast<std::size_t>(indices[k])]; };
  return {corner(0), corner(1), corner(2)};
}

// Sites uniform by area: one in each of equal parts of the mesh's area, taken in the triangles' order.
SurfaceSites initialSites(const mesh::TriangleMesh& mesh, const Facets& facets, std::size_t count, std::uint64_t seed,
                          const RunContext& context) {
  SurfaceSites sites;
  sites.points.resize(count);
  sites.triangles.resize(count);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto random = [&](std::size_t k) { return randomUnit(seed, RandomStream::surfaceSampling, 3 * i + k); };
      const double place = (static_cast<double>(i) + random(0)) / static_cast<double>(count) * facets.area();
      // The last triangle that begins at or before the place and has an area.
      const auto after = std::upper_bound(facets.areaUpTo.begin() + 1, facets.areaUpTo.end() - 1, place);
      auto triangle = static_cast<std::size_t>(after - facets.areaUpTo.begin()) - 1;
      while (facets.areas[triangle] <= 0) --triangle;
      const Corners corners = cornersOf(mesh, static_cast<Index>(triangle));
      const double root = std::sqrt(random(1));
      sites.points[i] = (1 - root) * corners[0] + root * ((1 - random(2)) * corners[1] + random(2) * corners[2]);
      sites.triangles[i] = static_cast<Index>(triangle);
    }
  });
  return sites;
}

// The point of a triangle nearest to p (Ericson 2005, 5.1.5).
Vec3 nearestInTriangle(const Corners& corners, const Vec3& p) {
  const auto& [a, b, c] = corners;
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const double d1 = ab.dot(p - a);
  const double d2 = ac.dot(p - a);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = ab.dot(p - b);
  const double d4 = ac.dot(p - b);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const double d5 = ab.dot(p - c);
  const double d6 = ac.dot(p - c);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

// A place on the mesh.
struct Place {
  Vec3 point = Vec3::Zero();
  Index triangle = kNone;
};

// The point nearest to the target on the triangles of a site's cell. It lies inside one of them but where the mesh is
// saddle-shaped or folded, as the centroid of a cell lies on the side that the cell bends around.
Place backOnMesh(const mesh::TriangleMesh& mesh, std::span<const SurfacePiece> pieces, const Vec3& target) {
  Place best;
  double bestDistance = std::numeric_limits<double>::infinity();
  for (const SurfacePiece& piece : pieces) {
    const Vec3 point = nearestInTriangle(cornersOf(mesh, piece.triangle), target);
    const double distance = (point - target).squaredNorm();
    if (distance >= bestDistance) continue;
    bestDistance = distance;
    best = {point, piece.triangle};
  }
  return best;
}

void moveToCentroids(const mesh::TriangleMesh& mesh, const SurfaceCells& cells, double relaxation, SurfaceSites& sites,
                     const RunContext& context) {
  parallelFor(context, sites.points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::span pieces(cells.pieces.data() + cells.offsets[i], cells.offsets[i + 1] - cells.offsets[i]);
      double area = 0;
      Vec3 moment = Vec3::Zero();
      for (const SurfacePiece& piece : pieces) {
        area += piece.area;
        moment += piece.moment;
      }
      // A site whose place another one has already owns nothing and stays.
      if (area <= 0) continue;
      const Place place = backOnMesh(mesh, pieces, sites.points[i] + relaxation / area * moment);
      sites.points[i] = place.point;
      sites.triangles[i] = place.triangle;
    }
  });
}

double energyOf(const SurfaceCells& cells) {
  double energy = 0;
  for (const SurfacePiece& piece : cells.pieces) energy += piece.energy;
  return energy;
}

// The distance from each point to the nearest other one.
void measureSpacing(double spacing, MeshSamples& samples, const RunContext& context) {
  const std::vector<Vec3>& points = samples.points;
  if (points.size() < 2) return;
  const PointGrid grid(points, spacing);
  std::vector<double> distances(points.size());
  parallelFor(context, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Index other = grid.nearest(points[i], spacing / 2, std::numeric_limits<double>::infinity(),
                                       [&](Index j) { return static_cast<std::size_t>(j) != i; });
      distances[i] = (points[static_cast<std::size_t>(other)] - points[i]).norm();
    }
  });
  const auto count = static_cast<double>(distances.size());
  double sum = 0;
  for (const double distance : distances) sum += distance;
  samples.meanSpacing = sum / count;
  double squares = 0;
  for (const double distance : distances) squares += std::pow(distance - samples.meanSpacing, 2);
  if (samples.meanSpacing > 0) samples.variation = std::sqrt(squares / count) / samples.meanSpacing;
}

// Sites at the spacing s on a hexagonal lattice have √3/2·s² each.
std::size_t sampleCount(double area, double spacing) {
  const double count = std::round(area / (std::numbers::sqrt3 / 2 * spacing * spacing));
  if (!(count <= kMostSamples)) {
    throw UsageError("surfaceCvt: a spacing of " + std::to_string(spacing) + " on an area of " + std::to_string(area) +
                     " asks for more than " + std::to_string(kMostSamples) + " samples");
  }
  return static_cast<std::size_t>(std::max(1.0, count));
}

}  // namespace

MeshSamples surfaceCvt(const mesh::TriangleMesh& mesh, const SurfaceCvtOptions& options, const RunContext& context) {
  if (!(options.spacing > 0) || !std::isfinite(options.spacing)) {
    throw UsageError("surfaceCvt: spacing must be above 0, got " + std::to_string(options.spacing));
  }
  if (options.iterations < 0) {
    throw UsageError("surfaceCvt: iterations must be at least 0, got " + std::to_string(options.iterations));
  }
  const Stopwatch watch;
  MeshSamples samples;
  const Facets facets = facetsOf(mesh, context);
  if (!std::isfinite(facets.area())) throw UsageError("surfaceCvt: the mesh has coordinates that are not finite");
  if (facets.area() <= 0) return samples;

  SurfaceSites sites = initialSites(mesh, facets, sampleCount(facets.area(), options.spacing), options.seed, context);
  double firstEnergy = 0;
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const SurfaceCells cells = surfaceCells(mesh, facets, sites, options.spacing, context);
    if (iteration == 0) firstEnergy = energyOf(cells);
    const bool last = iteration + 1 == options.iterations;
    moveToCentroids(mesh, cells, last ? 1 : kRelaxation, sites, context);
  }
  if (firstEnergy > 0) {
    const double energy = energyOf(surfaceCells(mesh, facets, sites, options.spacing, context));
    samples.energyDrop = 1 - energy / firstEnergy;
  }
  samples.points = std::move(sites.points);
  samples.triangles = std::move(sites.triangles);
  measureSpacing(options.spacing, samples, context);
  samples.seconds = watch.seconds();
  return samples;
}

}  // namespace voroform::metrics
