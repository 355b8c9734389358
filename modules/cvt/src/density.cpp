#include "voroform/cvt/density.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "surface_grid.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::cvt {

namespace {

constexpr std::size_t kGrain = 256;
// Nodes of the grid along the width of the boundary's band, and along a cell for the curvature.
constexpr double kNodesPerWidth = 8;
constexpr double kNodesPerCell = 2;
// The grid has at least so many intervals across the form's shortest side, or it would miss plates.
constexpr double kIntervalsAcross = 4;
// Normals for the curvature are compared a cell's size to either side, and at least so many spacings of the grid: forms
// are often rough on smaller scales.
constexpr double kCurvatureStep = 2;
// The share of surface points that are curved less than κ₀.
constexpr double kCurvatureRank = 0.95;
constexpr int kSmoothingPasses = 4;

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

void throwIfInvalid(const DensityOptions& options) {
  if (const auto violations = validate(options); !violations.empty()) throw UsageError(violations.front());
}

double widthOf(const DensityOptions& options, double cellSize) {
  return options.width > 0 ? options.width : kDefaultWidth * cellSize;
}

double gridSpacing(const implicit::ImplicitFunction& f, double wanted) {
  const Vec3 sizes = f.bounds().sizes();
  const double longest = sizes.maxCoeff();
  const double coarsest = std::min(longest / kFewestIntervals, sizes.minCoeff() / kIntervalsAcross);
  return std::max(std::min(wanted, coarsest), longest / kMostIntervals);
}

DensityPtr<3> boundaryDensityOf(const implicit::ImplicitFunction& f, double ratio, double width,
                                const RunContext& context) {
  const SurfaceGrid surface = surfaceGrid(f, gridSpacing(f, width / kNodesPerWidth), context);
  std::vector<float> depths(surface.grid.size());
  for (std::size_t node = 0; node < depths.size(); ++node) {
    const Vec3& nearest = surface.points[static_cast<std::size_t>(surface.nearest[node])];
    const double distance = (nearest - surface.grid.position(node)).norm();
    depths[node] = static_cast<float>(surface.inside[node] != 0 ? distance : -distance);
  }
  return boundaryDensity<3>(GridFunction(surface.grid, std::move(depths)), ratio, width);
}

// The root mean square of the principal curvatures: ‖dn‖/√2, dn the change of the unit normal along the surface.
double curvatureAt(const implicit::ImplicitFunction& f, const Vec3& p, double step) {
  const Vec3 normal = f.gradient(p).stableNormalized();
  const Vec3 u = normal.unitOrthogonal();
  const Vec3 v = normal.cross(u);
  double squared = 0;
  for (const Vec3& tangent : {u, v}) {
    const Vec3 change =
        f.gradient(p + step * tangent).stableNormalized() - f.gradient(p - step * tangent).stableNormalized();
    squared += (change - change.dot(normal) * normal).squaredNorm();
  }
  const double curvature = std::sqrt(squared / 2) / (2 * step);
  return std::isfinite(curvature) ? curvature : 0;
}

DensityPtr<3> curvatureDensityOf(const implicit::ImplicitFunction& f, double ratio, double cellSize,
                                 const RunContext& context) {
  const SurfaceGrid surface = surfaceGrid(f, gridSpacing(f, cellSize / kNodesPerCell), context);
  const double step = std::max(cellSize, kCurvatureStep * surface.grid.spacing);
  std::vector<double> curvatures(surface.points.size());
  parallelFor(context, curvatures.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) curvatures[k] = curvatureAt(f, surface.points[k], step);
  });
  std::vector<double> ranked = curvatures;
  const auto rank = ranked.begin() + static_cast<std::ptrdiff_t>(kCurvatureRank * static_cast<double>(ranked.size()));
  std::nth_element(ranked.begin(), rank, ranked.end());
  const double most = *rank;
  std::vector<float> sizes(surface.grid.size());
  for (std::size_t node = 0; node < sizes.size(); ++node) {
    const double curvature = curvatures[static_cast<std::size_t>(surface.nearest[node])];
    const bool flat = !(curvature * ratio * ratio > most);
    sizes[node] = static_cast<float>(flat ? ratio : std::max(1.0, std::sqrt(most / curvature)));
  }
  GridFunction size(surface.grid, std::move(sizes));
  size.smooth(kSmoothingPasses, context);
  return std::make_shared<const Density<3>>(std::move(size), ratio);
}

}  // namespace

template <int M>
Density<M>::Density(std::function<double(const Vec<M>&)> relativeSize, double ratio)
    : relativeSize_(std::move(relativeSize)), ratio_(ratio) {
  if (!(ratio >= 1 && ratio <= kMostRatio)) {
    throw UsageError("the ratio of cell sizes is " + number(ratio) + ", but must be from 1 to " + number(kMostRatio));
  }
}

namespace {

// s^(−(M+2)), s clamped to [1, ratio].
template <int M>
double densityOfSize(double size, double ratio) {
  const double inverse = 1 / std::clamp(size, 1.0, ratio);
  const double squared = inverse * inverse;
  return M == 2 ? squared * squared : squared * squared * inverse;
}

}  // namespace

template <int M>
double Density<M>::relativeSize(const Vec<M>& p) const {
  return std::clamp(relativeSize_(p), 1.0, ratio_);
}

template <int M>
double Density<M>::value(const Vec<M>& p) const {
  return densityOfSize<M>(relativeSize_(p), ratio_);
}

template <int M>
void Density<M>::values(std::span<const Vec<M>> points, std::span<double> out) const {
  for (std::size_t k = 0; k < points.size(); ++k) out[k] = relativeSize_(points[k]);
  for (double& value : out) value = densityOfSize<M>(value, ratio_);
}

template <int M>
double Density<M>::siteDensity(const Vec<M>& p) const {
  return std::pow(relativeSize(p), -M);
}

const char* toString(DensityKind kind) {
  switch (kind) {
    case DensityKind::constant:
      return "constant";
    case DensityKind::boundary:
      return "boundary";
    case DensityKind::curvature:
      return "curvature";
  }
  return "";
}

std::vector<std::string> validate(const DensityOptions& options) {
  std::vector<std::string> violations;
  constexpr double kMost = Density<3>::kMostRatio;
  if (!(options.ratio >= 1 && options.ratio <= kMost)) {
    violations.push_back("density-ratio is " + number(options.ratio) + ", but must be from 1 to " + number(kMost));
  }
  if (!(options.width >= 0) || !std::isfinite(options.width)) {
    violations.push_back("density-width is " + number(options.width) + ", but must be at least 0");
  }
  return violations;
}

template <int M>
DensityPtr<M> boundaryDensity(std::function<double(const Vec<M>&)> depth, double ratio, double width) {
  if (!(width > 0)) throw UsageError("the width of the density is " + number(width) + ", but must be above 0");
  auto relativeSize = [depth = std::move(depth), ratio, perWidth = 1 / width](const Vec<M>& p) {
    const double t = std::clamp(depth(p) * perWidth, 0.0, 1.0);
    return 1 + (ratio - 1) * t * t * (3 - 2 * t);
  };
  return std::make_shared<const Density<M>>(std::move(relativeSize), ratio);
}

DensityPtr<3> makeDensity(const implicit::ImplicitFunction& f, const DensityOptions& options, double cellSize,
                          const RunContext& context) {
  throwIfInvalid(options);
  switch (options.kind) {
    case DensityKind::constant:
      break;
    case DensityKind::boundary:
      return boundaryDensityOf(f, options.ratio, widthOf(options, cellSize), context);
    case DensityKind::curvature:
      return curvatureDensityOf(f, options.ratio, cellSize, context);
  }
  return nullptr;
}

DensityPtr<2> makeDensity(const mesh::PlanarRegion& region, const DensityOptions& options, double cellSize) {
  throwIfInvalid(options);
  switch (options.kind) {
    case DensityKind::constant:
      break;
    case DensityKind::boundary:
      return boundaryDensity<2>([&region](const Vec2& p) { return -region.signedDistance(p); }, options.ratio,
                                widthOf(options, cellSize));
    case DensityKind::curvature:
      throw UsageError("density is curvature, but a polygon's edges are straight: use boundary or constant");
  }
  return nullptr;
}

template class Density<2>;
template class Density<3>;
template DensityPtr<2> boundaryDensity<2>(std::function<double(const Vec2&)>, double, double);
template DensityPtr<3> boundaryDensity<3>(std::function<double(const Vec3&)>, double, double);

}  // namespace voroform::cvt
