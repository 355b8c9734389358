#include "dual_sites.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "voroform/core/parallel.hpp"
#include "voroform/cvt/energy.hpp"
#include "voroform/implicit/closest_point.hpp"
#include "voroform/voronoi/clip.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::metrics {

namespace {

constexpr std::size_t kGrain = 256;
// Lloyd's step times this. The momentum method is stable up to 4/3 times the inverse of the largest curvature, which
// for Lloyd's step is about 1.
constexpr double kOverRelaxation = 1.25;
// An inner site is projected if its cell's piece of S is larger than this share of the mean of the sites on S. Smaller
// ones mostly vanish by themselves.
constexpr double kPieceShare = 0.2;
// A cell below this share of the mean mass has no centroid to speak of (see cvt/energy.cpp).
constexpr double kEmptyShare = 1e-6;

// The pieces of S that cells hold: area and first moment about the site, of fans about the loops' centroids.
struct Pieces {
  std::vector<double> areas;
  std::vector<Vec3> firsts;
};

Pieces piecesOf(const voronoi::Diagram& diagram, const voronoi::ClippedDiagram& clipped,
                const std::vector<Vec3>& sites) {
  Pieces pieces{std::vector<double>(sites.size(), 0), std::vector<Vec3>(sites.size(), Vec3::Zero())};
  for (Index l = 0; l < clipped.loopCount(); ++l) {
    const auto site = static_cast<std::size_t>(clipped.loopSites[static_cast<std::size_t>(l)]);
    const auto loop = clipped.loop(l);
    Vec3 center = Vec3::Zero();
    for (const Index point : loop) center += clipped.position(diagram, point) / static_cast<double>(loop.size());
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3& a = clipped.position(diagram, loop[k]);
      const Vec3& b = clipped.position(diagram, loop[(k + 1) % loop.size()]);
      const double area = 0.5 * (a - center).cross(b - center).norm();
      pieces.areas[site] += area;
      pieces.firsts[site] += area * ((a + b + center) / 3 - sites[site]);
    }
  }
  return pieces;
}

// Sites that were moved to one place (at a corner of S) go back, all but the first: a diagram needs distinct sites.
void keepDistinct(std::vector<Vec3>& places, const std::vector<Vec3>& before) {
  const auto key = [&](std::size_t i) { return std::array{places[i][0], places[i][1], places[i][2]}; };
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    const auto a = key(i);
    const auto b = key(j);
    return a < b || (a == b && i < j);
  });
  std::vector<std::size_t> doubled;
  for (std::size_t k = 1; k < order.size(); ++k) {
    if (places[order[k]] == places[order[k - 1]]) doubled.push_back(order[k]);
  }
  for (const std::size_t i : doubled) places[i] = before[i];
}

}  // namespace

DualSites::DualSites(std::vector<Vec3> sites, const implicit::ImplicitFunction& f, double reach,
                     const RunContext& context)
    : f_(f),
      context_(context),
      reach_(reach),
      positions_(std::move(sites)),
      previous_(positions_),
      onSurface_(positions_.size(), 0) {}

Index DualSites::surfaceCount() const {
  return static_cast<Index>(std::count(onSurface_.begin(), onSurface_.end(), std::uint8_t{1}));
}

Index DualSites::project(const std::vector<std::uint8_t>& marked) {
  const Index before = surfaceCount();
  std::vector<Vec3> places = positions_;
  parallelFor(context_, places.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (marked[i] == 0 || onSurface_[i] != 0) continue;
      const implicit::ClosestPoint closest = implicit::closestPoint(f_, positions_[i], reach_);
      if (closest.found) places[i] = closest.position;
    }
  });
  keepDistinct(places, positions_);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] == positions_[i]) continue;
    onSurface_[i] = 1;
    positions_[i] = places[i];
    previous_[i] = places[i];  // no momentum from the projection
  }
  return surfaceCount() - before;
}

void DualSites::step() {
  // Extrapolate, then step from there; the weight k/(k + 3) is Nesterov's for convex functions.
  const double momentum = static_cast<double>(steps_) / (steps_ + 3);
  ++steps_;
  std::vector<Vec3> from(positions_.size());
  for (std::size_t i = 0; i < from.size(); ++i) from[i] = positions_[i] + momentum * (positions_[i] - previous_[i]);
  if (momentum > 0) moveAll(from, positions_);

  const Targets targets = targetsOf(from);
  previous_ = std::move(positions_);
  positions_ = from;
  for (std::size_t i = 0; i < from.size(); ++i) positions_[i] += kOverRelaxation * targets.steps[i];
  moveAll(positions_, from);
  project(targets.reaches);
}

DualSites::Targets DualSites::targetsOf(const std::vector<Vec3>& sites) const {
  context_.throwIfCancelled();
  const voronoi::Diagram diagram = voronoi::buildDiagram(sites, cvt::siteDomain(f_), context_);
  voronoi::ClipOptions options;
  options.cap = voronoi::CapKind::flat;
  options.rootTolerance = cvt::kOptimizationRootTolerance;
  const voronoi::ClippedDiagram clipped = voronoi::clip(diagram, f_, options, context_);
  const std::vector<voronoi::SiteMoments> moments = voronoi::siteMoments(diagram, clipped, context_);
  const Pieces pieces = piecesOf(diagram, clipped, sites);

  double volume = 0;
  double surfaceArea = 0;  // of the sites on S
  for (std::size_t i = 0; i < sites.size(); ++i) {
    volume += moments[i].mass;
    if (onSurface_[i] != 0) surfaceArea += pieces.areas[i];
  }
  const double leastMass = kEmptyShare * volume / static_cast<double>(sites.size());
  const double leastPiece = kPieceShare * surfaceArea / std::max(1, surfaceCount());

  Targets targets{std::vector<Vec3>(sites.size(), Vec3::Zero()), std::vector<std::uint8_t>(sites.size(), 0)};
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (onSurface_[i] != 0) {
      if (pieces.areas[i] > 0) targets.steps[i] = pieces.firsts[i] / pieces.areas[i];
    } else {
      if (moments[i].mass > leastMass) targets.steps[i] = moments[i].first / moments[i].mass;
      targets.reaches[i] = pieces.areas[i] > leastPiece ? 1 : 0;
    }
  }
  return targets;
}

Vec3 DualSites::allowed(std::size_t i, const Vec3& place, const Vec3& stay) const {
  if (onSurface_[i] != 0) {
    const implicit::ClosestPoint closest = implicit::closestPoint(f_, place, reach_);
    return closest.found ? closest.position : stay;
  }
  const double clearance = f_.clearance(place);
  return clearance < 0 || (clearance == 0 && f_.value(place) < 0) ? place : stay;
}

void DualSites::moveAll(std::vector<Vec3>& places, const std::vector<Vec3>& stay) const {
  parallelFor(context_, places.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) places[i] = allowed(i, places[i], stay[i]);
  });
  keepDistinct(places, stay);
}

}  // namespace voroform::metrics
