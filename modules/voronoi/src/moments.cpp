#include <algorithm>

#include "voroform/core/parallel.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 4096;

// Moments of a planar polygon about a point beside its plane: area, ∫ y dA and ∫ ‖y‖² dA.
struct PolygonMoments {
  double area = 0;
  Vec3 first = Vec3::Zero();
  double second = 0;
};

template <class Position>
PolygonMoments polygonMoments(std::span<const Index> polygon, const Vec3& origin, const Vec3& normal,
                              const Position& position) {
  PolygonMoments sum;
  const Vec3 p = position(polygon[0]) - origin;
  Vec3 q = position(polygon[1]) - origin;
  const double pp = p.squaredNorm();
  double qq = q.squaredNorm();
  for (std::size_t k = 2; k < polygon.size(); ++k) {
    const Vec3 r = position(polygon[k]) - origin;
    const double rr = r.squaredNorm();
    const double area = 0.5 * normal.dot((q - p).cross(r - p));
    const Vec3 total = p + q + r;
    sum.area += area;
    sum.first += area * total;
    sum.second += area * (pp + qq + rr + total.squaredNorm());
    q = r;
    qq = rr;
  }
  sum.first /= 3;
  sum.second /= 12;
  return sum;
}

// Adds the pyramid of a facet's polygon over the site at `apex`, `height` away: with x = t·y for y on the base,
// ∫ dx = hA/3, ∫ x dx = h/4 ∫ y dA, ∫ ‖x‖² dx = h/5 ∫ ‖y‖² dA. The polygon's points are as far from the facet's second
// site as from its first, so that both have the same mass and second moment.
void addPyramid(const PolygonMoments& base, double height, const Vec3& shift, SiteMoments& site) {
  site.mass += height * base.area / 3;
  site.first += height / 4 * (base.first - base.area * shift);
  site.second += height / 5 * base.second;
}

// Adds the cone of a loop's flat cap (a fan about the loop's centroid) over the site.
void addFlatCap(const Diagram& diagram, const ClippedDiagram& clipped, std::span<const Index> loop, const Vec3& origin,
                SiteMoments& site) {
  Vec3 centroid = Vec3::Zero();
  for (const Index point : loop) centroid += clipped.position(diagram, point);
  const Vec3 c = centroid / static_cast<double>(loop.size()) - origin;
  const double cc = c.squaredNorm();
  Vec3 p = clipped.position(diagram, loop.back()) - origin;
  double pp = p.squaredNorm();
  for (const Index point : loop) {
    const Vec3 q = clipped.position(diagram, point) - origin;
    const double qq = q.squaredNorm();
    const double volume = c.dot(p.cross(q)) / 6;
    const Vec3 total = c + p + q;
    site.mass += volume;
    site.first += volume / 4 * total;
    site.second += volume / 20 * (cc + pp + qq + total.squaredNorm());
    p = q;
    pp = qq;
  }
}

}  // namespace

std::vector<SiteMoments> siteMoments(const Diagram& diagram, const ClippedDiagram& clipped, const RunContext& context) {
  using State = ClippedDiagram::FacetState;
  const std::size_t facetCount = diagram.facetSites.size();

  // A cut facet's polygons, by its number among the cut ones.
  std::vector<PolygonMoments> facets(facetCount);
  parallelFor(context, facetCount, kGrain, [&](std::size_t begin, std::size_t end) {
    // Both facets and polygons ascend: find the chunk's first polygon once.
    std::size_t polygon = static_cast<std::size_t>(
        std::lower_bound(clipped.polygonFacets.begin(), clipped.polygonFacets.end(), static_cast<Index>(begin)) -
        clipped.polygonFacets.begin());
    for (std::size_t f = begin; f < end; ++f) {
      const State state = clipped.facetStates[f];
      if (state == State::outside) continue;
      const auto& [a, b] = diagram.facetSites[f];
      const Vec3& origin = diagram.sites[static_cast<std::size_t>(a)];
      const Vec3 normal = (diagram.sites[static_cast<std::size_t>(b)] - origin).normalized();
      if (state == State::whole) {
        facets[f] = polygonMoments(diagram.facet(static_cast<Index>(f)), origin, normal, [&](Index v) -> const Vec3& {
          return diagram.vertices[static_cast<std::size_t>(v)];
        });
        continue;
      }
      for (; polygon < clipped.polygonFacets.size() && clipped.polygonFacets[polygon] == static_cast<Index>(f);
           ++polygon) {
        const PolygonMoments part =
            polygonMoments(clipped.polygon(static_cast<Index>(polygon)), origin, normal,
                           [&](Index v) -> const Vec3& { return clipped.position(diagram, v); });
        facets[f].area += part.area;
        facets[f].first += part.first;
        facets[f].second += part.second;
      }
    }
  });

  const auto siteCount = static_cast<std::size_t>(diagram.siteCount);
  std::vector<SiteMoments> result(siteCount);
  parallelFor(context, siteCount, kGrain, [&](std::size_t begin, std::size_t end) {
    auto loop = static_cast<std::size_t>(
        std::lower_bound(clipped.loopSites.begin(), clipped.loopSites.end(), static_cast<Index>(begin)) -
        clipped.loopSites.begin());
    for (std::size_t s = begin; s < end; ++s) {
      SiteMoments& site = result[s];
      for (const Index f : diagram.facetsOf(static_cast<Index>(s))) {
        const PolygonMoments& base = facets[static_cast<std::size_t>(f)];
        if (base.area == 0) continue;
        const auto& [a, b] = diagram.facetSites[static_cast<std::size_t>(f)];
        const Vec3 across = diagram.sites[static_cast<std::size_t>(b)] - diagram.sites[static_cast<std::size_t>(a)];
        const bool isFirst = a == static_cast<Index>(s);
        addPyramid(base, 0.5 * across.norm(), isFirst ? Vec3(Vec3::Zero()) : across, site);
      }
      for (; loop < clipped.loopSites.size() && clipped.loopSites[loop] == static_cast<Index>(s); ++loop) {
        addFlatCap(diagram, clipped, clipped.loop(static_cast<Index>(loop)), diagram.sites[s], site);
      }
    }
  });
  return result;
}

}  // namespace voroform::voronoi
