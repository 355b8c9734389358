// Independent checks of clipped planar Voronoi diagrams.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "support/planar.hpp"
#include "voroform/voronoi/planar.hpp"

namespace voroform::testing {

struct PlanarResult {
  voronoi::PlanarDiagram diagram;
  voronoi::PlanarClip clip;
  std::vector<voronoi::Moments<2>> moments;
  mesh::PlanarTessellation tessellation;
};

inline PlanarResult clipSites(const std::vector<Vec2>& sites, const mesh::PlanarRegion& region,
                              const RunContext& context = {}) {
  PlanarResult result;
  result.diagram = voronoi::buildPlanarDiagram(sites, region.bounds(), context);
  result.clip = voronoi::clipPlanar(result.diagram, region, context);
  result.moments = voronoi::planarMoments(result.diagram, result.clip, context);
  result.tessellation = voronoi::toTessellation(result.diagram, result.clip, context);
  return result;
}

// The part of a convex polygon that is nearer to a than to b (Sutherland, Hodgman 1974).
inline std::vector<Vec2> nearerPart(const std::vector<Vec2>& polygon, const Vec2& a, const Vec2& b) {
  std::vector<Vec2> result;
  const auto excess = [&](const Vec2& p) { return (p - 0.5 * (a + b)).dot(b - a); };
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec2& p = polygon[k];
    const Vec2& q = polygon[(k + 1) % polygon.size()];
    const double atP = excess(p);
    const double atQ = excess(q);
    if (atP <= 0) result.push_back(p);
    if ((atP < 0 && atQ > 0) || (atP > 0 && atQ < 0)) result.push_back(p + atP / (atP - atQ) * (q - p));
  }
  return result;
}

// The moments of a site's clipped cell the slow, obvious way: the region is the sum of the triangles, of either sign,
// that its edges span with a point, and each is clipped by the bisectors of all other sites. Integrals by the midpoint
// rule on triangles, which is exact for polynomials of degree two.
inline voronoi::Moments<2> referenceMoments(const std::vector<Vec2>& sites, std::size_t site,
                                            const mesh::PlanarRegion& region) {
  voronoi::Moments<2> sum;
  const Vec2 apex(0.0625, -0.03125);
  for (std::size_t e = 0; e < region.points().size(); ++e) {
    std::vector<Vec2> part = {apex, region.points()[e], region.points()[static_cast<std::size_t>(region.next(e))]};
    const double sign = signedArea(part) < 0 ? -1 : 1;
    for (std::size_t other = 0; other < sites.size() && !part.empty(); ++other) {
      if (other != site) part = nearerPart(part, sites[site], sites[other]);
    }
    for (std::size_t k = 2; k < part.size(); ++k) {
      const double area = sign * std::abs(cross(part[k - 1] - part[0], part[k] - part[0])) / 2;
      for (const auto& [a, b] :
           {std::pair(part[0], part[k - 1]), std::pair(part[k - 1], part[k]), std::pair(part[k], part[0])}) {
        const Vec2 x = 0.5 * (a + b) - sites[site];
        sum.mass += area / 3;
        sum.first += area / 3 * x;
        sum.second += area / 3 * x.squaredNorm();
      }
    }
  }
  return sum;
}

// Cells fill the region: areas add up, by moments and by loops; each inner edge is seen by both its cells in opposite
// directions, boundary edges by one; loops enclose what the moments say. `tolerance` is relative to the region.
inline void expectPartition(const PlanarResult& result, const mesh::PlanarRegion& region, double tolerance) {
  const auto& tessellation = result.tessellation;
  const double area = region.area();
  ASSERT_EQ(tessellation.cellCount(), result.diagram.siteCount);
  ASSERT_EQ(tessellation.sites.size(), result.moments.size());

  using Edge = std::array<Index, 2>;
  std::map<Edge, std::array<Index, 2>> cellAndNeighbor;
  std::map<std::pair<Index, Index>, int> boundaryDegree;
  double boundaryLength = 0;
  double sum = 0;
  for (Index cell = 0; cell < tessellation.cellCount(); ++cell) {
    double cellArea = 0;
    const Vec2& site = tessellation.sites[static_cast<std::size_t>(cell)];
    for (std::size_t l = tessellation.firstLoop(cell); l < tessellation.endLoop(cell); ++l) {
      const auto loop = tessellation.loop(l);
      const auto neighbors = tessellation.loopNeighbors(l);
      std::set<Index> used(loop.begin(), loop.end());
      EXPECT_EQ(used.size(), loop.size()) << "a loop visits a vertex twice";
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Edge edge = {loop[k], loop[(k + 1) % loop.size()]};
        const Vec2& from = tessellation.vertices[static_cast<std::size_t>(edge[0])];
        const Vec2& to = tessellation.vertices[static_cast<std::size_t>(edge[1])];
        cellArea += cross(from - site, to - site) / 2;
        EXPECT_TRUE(cellAndNeighbor.emplace(edge, std::array{cell, neighbors[k]}).second) << "an edge seen twice";
        if (neighbors[k] == kNone) {
          boundaryLength += (to - from).norm();
          EXPECT_TRUE(result.clip.touchesBoundary(cell));
          EXPECT_LE(std::abs(region.signedDistance(0.5 * (from + to))), tolerance * std::sqrt(area));
        }
      }
    }
    EXPECT_NEAR(cellArea, result.moments[static_cast<std::size_t>(cell)].mass, tolerance * area);
    EXPECT_GE(cellArea, -tolerance * area);
    sum += cellArea;
  }
  EXPECT_NEAR(sum, area, tolerance * area);

  double regionLength = 0;
  for (std::size_t e = 0; e < region.points().size(); ++e) {
    regionLength += (region.points()[static_cast<std::size_t>(region.next(e))] - region.points()[e]).norm();
  }
  EXPECT_NEAR(boundaryLength, regionLength, tolerance * regionLength);

  std::set<std::array<Index, 2>> pairs;
  for (const auto& [edge, sides] : cellAndNeighbor) {
    const auto opposite = cellAndNeighbor.find({edge[1], edge[0]});
    if (sides[1] == kNone) continue;
    ASSERT_TRUE(opposite != cellAndNeighbor.end()) << "an inner edge with one cell";
    EXPECT_EQ(opposite->second[0], sides[1]);
    EXPECT_EQ(opposite->second[1], sides[0]);
    pairs.insert({std::min(sides[0], sides[1]), std::max(sides[0], sides[1])});
  }
  const auto neighbors = voronoi::neighborPairs(result.diagram, result.clip);
  EXPECT_TRUE(std::equal(neighbors.begin(), neighbors.end(), pairs.begin(), pairs.end()));

  for (std::size_t v = 0; v < result.diagram.vertices.size(); ++v) {
    const Vec2& vertex = result.diagram.vertices[v];
    if (std::abs(region.signedDistance(vertex)) < 1e-6 * std::sqrt(area)) continue;
    EXPECT_EQ(result.clip.inside[v] != 0, region.contains(vertex));
  }
}

}  // namespace voroform::testing
