// Energies in domains grown by a layer on their boundary.
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "gather.hpp"
#include "voroform/core/error.hpp"
#include "voroform/cvt/energy.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/planar_domain.hpp"
#include "voroform/voronoi/clip.hpp"
#include "voroform/voronoi/diagram.hpp"
#include "voroform/voronoi/planar.hpp"
#include "voroform/voronoi/weighted_moments.hpp"

namespace voroform::cvt {

namespace {

// What a layer adds to a cell.
template <int M>
struct Layer {
  voronoi::Moments<M> moments;
  double volume = 0;  // not weighted
};

// Adds what a simplex of the boundary (a segment or a triangle) sweeps over when it moves by `thickness` along its
// normal; corners are relative to the site. With y on the simplex A and ν its unit normal: ∫ dx = t|A|,
// ∫ x dx = t∫y dA + t²/2·|A|ν, ∫ ‖x‖² dx = t∫‖y‖² dA + t²|A|ν·y + t³/3·|A|.
template <int M>
void addSwept(const std::array<Vec<M>, M>& corners, const Vec<M>& areaNormal, double thickness, double density,
              Layer<M>& layer) {
  const double area = areaNormal.norm();
  Vec<M> total = Vec<M>::Zero();
  double squares = 0;
  for (const Vec<M>& corner : corners) {
    total += corner;
    squares += corner.squaredNorm();
  }
  const double t = thickness;
  const double second = area / (M * (M + 1)) * (total.squaredNorm() + squares);
  layer.volume += t * area;
  layer.moments.mass += density * t * area;
  layer.moments.first += density * t * (area / M * total + t / 2 * areaNormal);
  layer.moments.second += density * t * (second + t * areaNormal.dot(corners[0]) + t * t / 3 * area);
}

template <int M>
void addSweptAt(const Vec<M>& center, const Domain<M>& domain, const std::array<Vec<M>, M>& corners,
                const Vec<M>& areaNormal, double thickness, Layer<M>& layer) {
  const double siteDensity = domain.siteDensity(center);
  addSwept<M>(corners, areaNormal, thickness * std::pow(siteDensity, -1.0 / M), std::pow(siteDensity, (M + 2.0) / M),
              layer);
}

// The caps' triangles: fans about the loops' centroids.
std::vector<Layer<3>> layers(const Domain<3>& domain, const voronoi::Diagram& diagram,
                             const voronoi::ClippedDiagram& clipped, double thickness) {
  std::vector<Layer<3>> result(static_cast<std::size_t>(diagram.siteCount));
  for (Index l = 0; l < clipped.loopCount(); ++l) {
    const auto loop = clipped.loop(l);
    const auto i = static_cast<std::size_t>(clipped.loopSites[static_cast<std::size_t>(l)]);
    const Vec3& site = diagram.sites[i];
    Vec3 centroid = Vec3::Zero();
    for (const Index point : loop) centroid += clipped.position(diagram, point);
    centroid /= static_cast<double>(loop.size());
    const Vec3 c = centroid - site;
    Vec3 p = clipped.position(diagram, loop.back()) - site;
    for (const Index point : loop) {
      const Vec3 q = clipped.position(diagram, point) - site;
      addSweptAt<3>(centroid, domain, {p, q, c}, 0.5 * (q - p).cross(c - p), thickness, result[i]);
      p = q;
    }
  }
  return result;
}

std::vector<Layer<2>> layers(const Domain<2>& domain, const voronoi::PlanarDiagram& diagram,
                             const voronoi::PlanarClip& clip, double thickness) {
  std::vector<Layer<2>> result(static_cast<std::size_t>(diagram.siteCount));
  for (Index s = 0; s < diagram.siteCount; ++s) {
    const auto i = static_cast<std::size_t>(s);
    for (const auto& piece : clip.piecesOf(s)) {
      const Vec2 p = clip.position(diagram, piece.from);
      const Vec2 q = clip.position(diagram, piece.to);
      // The cell lies on the left of the way from p to q.
      const Vec2 outward(q.y() - p.y(), p.x() - q.x());
      addSweptAt<2>(0.5 * (p + q), domain, {p - diagram.sites[i], q - diagram.sites[i]}, outward, thickness, result[i]);
    }
  }
  return result;
}

template <int M>
Evaluation<M> grown(std::span<const Vec<M>> sites, voronoi::WeightedMoments<M> cells,
                    const std::vector<Layer<M>>& layers, const RunContext& context) {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    voronoi::Moments<M>& cell = cells.moments[i];
    cell.mass += layers[i].moments.mass;
    cell.first += layers[i].moments.first;
    cell.second += layers[i].moments.second;
    if (!cells.volumes.empty()) cells.volumes[i] += layers[i].volume;
  }
  Evaluation<M> result;
  result.moments = std::move(cells.moments);
  gather<M>(sites, cells.volumes, result, context);
  return result;
}

}  // namespace

Evaluation<3> ImplicitDomain::evaluateGrown(std::span<const Vec3> sites, double thickness,
                                            const RunContext& context) const {
  const voronoi::Diagram diagram = voronoi::buildDiagram(sites, siteBox(), context);
  const Stopwatch watch;
  voronoi::ClipOptions options;
  options.cap = voronoi::CapKind::flat;
  options.rootFinder = rootFinder_;
  options.rootTolerance = kOptimizationRootTolerance;
  const voronoi::ClippedDiagram clipped = voronoi::clip(diagram, f_, options, context);
  voronoi::WeightedMoments<3> cells;
  if (density_ != nullptr) {
    const auto values = [&](std::span<const Vec3> points, std::span<double> out) { density_->values(points, out); };
    cells = voronoi::weightedMoments(diagram, clipped, values, context);
  } else {
    cells.moments = voronoi::siteMoments(diagram, clipped, context);
  }
  Evaluation<3> result = grown<3>(sites, std::move(cells), layers(*this, diagram, clipped, thickness), context);
  result.secondsDelaunay = diagram.secondsDelaunay;
  result.secondsAfterDelaunay = diagram.secondsFlattening + watch.seconds();
  return result;
}

Evaluation<2> PlanarDomain::evaluateGrown(std::span<const Vec2> sites, double thickness,
                                          const RunContext& context) const {
  const Box2 box = siteBox();
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!box.contains(sites[i])) {
      throw MethodError("site " + std::to_string(i) + " lies outside the domain or is not finite");
    }
  }
  const voronoi::PlanarDiagram diagram = voronoi::buildPlanarDiagram(sites, box, context);
  const Stopwatch watch;
  const voronoi::PlanarClip clip = voronoi::clipPlanar(diagram, region_, context);
  voronoi::WeightedMoments<2> cells;
  if (density_ != nullptr) {
    const auto values = [&](std::span<const Vec2> points, std::span<double> out) { density_->values(points, out); };
    cells = voronoi::weightedMoments(diagram, clip, values, context);
  } else {
    cells.moments = voronoi::planarMoments(diagram, clip, context);
  }
  Evaluation<2> result = grown<2>(sites, std::move(cells), layers(*this, diagram, clip, thickness), context);
  result.secondsDelaunay = diagram.secondsDelaunay;
  result.secondsAfterDelaunay = diagram.secondsFlattening + watch.seconds();
  return result;
}

}  // namespace voroform::cvt
