// Energies in domains grown by a layer on their boundary.
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "clipped_sites.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/planar_domain.hpp"

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
Evaluation<M> grown(std::span<const Vec<M>> sites, const ClippedSites<M>& cells, const Domain<M>& domain,
                    const Density<M>* density, double thickness, const RunContext& context) {
  voronoi::WeightedMoments<M> moments = momentsOf(cells, density, context);
  const std::vector<Layer<M>> added = layers(domain, cells.diagram, cells.clip, thickness);
  for (std::size_t i = 0; i < added.size(); ++i) {
    voronoi::Moments<M>& cell = moments.moments[i];
    cell.mass += added[i].moments.mass;
    cell.first += added[i].moments.first;
    cell.second += added[i].moments.second;
    if (density != nullptr) moments.volumes[i] += added[i].volume;
  }
  return evaluationOf<M>(sites, cells, std::move(moments), context);
}

}  // namespace

Evaluation<3> ImplicitDomain::evaluateGrown(std::span<const Vec3> sites, double thickness,
                                            const RunContext& context) const {
  return grown<3>(sites, clipSites(sites, f_, clipOptions(), context), *this, density_.get(), thickness, context);
}

Evaluation<2> PlanarDomain::evaluateGrown(std::span<const Vec2> sites, double thickness,
                                          const RunContext& context) const {
  return grown<2>(sites, clipSites(sites, region_, context), *this, density_.get(), thickness, context);
}

}  // namespace voroform::cvt
