#include "voroform/voronoi/weighted_moments.hpp"

#include <algorithm>

#include "voroform/core/parallel.hpp"
#include "weighted_cell.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 256;

// Adds the pyramid of a facet's polygon over the site; counter-clockwise seen from outside if `outward` is 1, else −1.
template <class Position>
void addPyramid(std::span<const Index> polygon, double outward, const Vec3& site, const Position& position,
                WeightedCell<3>& cell) {
  const Vec3 p = position(polygon[0]) - site;
  Vec3 q = position(polygon[1]) - site;
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vec3 r = position(polygon[k]) - site;
    cell.add(p, q, r, outward * p.dot(q.cross(r)) / 6);
    q = r;
  }
}

// Adds the cone of a loop's flat cap (a fan about the loop's centroid) over the site.
void addFlatCap(const Diagram& diagram, const ClippedDiagram& clipped, std::span<const Index> loop, const Vec3& site,
                WeightedCell<3>& cell) {
  Vec3 centroid = Vec3::Zero();
  for (const Index point : loop) centroid += clipped.position(diagram, point);
  const Vec3 c = centroid / static_cast<double>(loop.size()) - site;
  Vec3 p = clipped.position(diagram, loop.back()) - site;
  for (const Index point : loop) {
    const Vec3 q = clipped.position(diagram, point) - site;
    cell.add(c, p, q, c.dot(p.cross(q)) / 6);
    p = q;
  }
}

void addFacet(const Diagram& diagram, const ClippedDiagram& clipped, Index facet, Index site, WeightedCell<3>& cell) {
  using State = ClippedDiagram::FacetState;
  const auto f = static_cast<std::size_t>(facet);
  const State state = clipped.facetStates[f];
  if (state == State::outside) return;
  const double outward = diagram.facetSites[f][0] == site ? 1 : -1;
  const Vec3& origin = diagram.sites[static_cast<std::size_t>(site)];
  if (state == State::whole) {
    addPyramid(
        diagram.facet(facet), outward, origin,
        [&](Index v) -> const Vec3& { return diagram.vertices[static_cast<std::size_t>(v)]; }, cell);
    return;
  }
  const auto first = std::lower_bound(clipped.polygonFacets.begin(), clipped.polygonFacets.end(), facet);
  for (auto it = first; it != clipped.polygonFacets.end() && *it == facet; ++it) {
    addPyramid(
        clipped.polygon(static_cast<Index>(it - clipped.polygonFacets.begin())), outward, origin,
        [&](Index v) -> const Vec3& { return clipped.position(diagram, v); }, cell);
  }
}

}  // namespace

WeightedMoments<3> weightedMoments(const Diagram& diagram, const ClippedDiagram& clipped,
                                   const DensityValues<3>& density, const RunContext& context) {
  const auto siteCount = static_cast<std::size_t>(diagram.siteCount);
  WeightedMoments<3> result;
  result.moments.resize(siteCount);
  result.volumes.resize(siteCount);
  parallelFor(context, siteCount, kGrain, [&](std::size_t begin, std::size_t end) {
    WeightedCell<3> cell(density);
    auto loop = static_cast<std::size_t>(
        std::lower_bound(clipped.loopSites.begin(), clipped.loopSites.end(), static_cast<Index>(begin)) -
        clipped.loopSites.begin());
    for (std::size_t s = begin; s < end; ++s) {
      cell.begin(diagram.sites[s]);
      for (const Index f : diagram.facetsOf(static_cast<Index>(s))) {
        addFacet(diagram, clipped, f, static_cast<Index>(s), cell);
      }
      for (; loop < clipped.loopSites.size() && clipped.loopSites[loop] == static_cast<Index>(s); ++loop) {
        addFlatCap(diagram, clipped, clipped.loop(static_cast<Index>(loop)), diagram.sites[s], cell);
      }
      cell.finish(result.moments[s], result.volumes[s]);
    }
  });
  return result;
}

}  // namespace voroform::voronoi
