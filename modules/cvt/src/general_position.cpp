#include "general_position.hpp"

#include <algorithm>

#include "voroform/core/random.hpp"

namespace voroform::cvt {

namespace {

// Neighboring vertices of the diagram coincide if they are closer than this share of their distance from their sites.
constexpr double kCoincidence = 1e-9;
// How far sites move, as a share of their distance from the nearest of the sites around: far enough that rounding
// cannot undo it.
constexpr double kMove = 1e-6;
constexpr std::uint64_t kSeed = 0;
constexpr int kRounds = 3;

// Whether the vertices v and w, neighbors by a slot of v, coincide with at least four real sites on their sphere.
bool coincide(const voronoi::Diagram& diagram, Index v, Index w) {
  const auto i = static_cast<std::size_t>(v);
  const auto j = static_cast<std::size_t>(w);
  const Vec3& place = diagram.vertices[i];
  const double radius = (place - diagram.sites[static_cast<std::size_t>(diagram.vertexSites[i][0])]).norm();
  if ((diagram.vertices[j] - place).norm() > kCoincidence * radius) return false;
  int real = 0;
  for (const Index site : diagram.vertexSites[i]) real += diagram.isReal(site) ? 1 : 0;
  const Index other = diagram.vertexSites[j][static_cast<std::size_t>(diagram.slotOf(w, v))];
  return real + (diagram.isReal(other) ? 1 : 0) >= 4;
}

// Of each site that is to move, its distance from the nearest site around; 0 of the others.
std::vector<double> sitesToMove(const voronoi::Diagram& diagram) {
  std::vector<double> nearest(static_cast<std::size_t>(diagram.siteCount), 0.0);
  for (Index v = 0; v < diagram.vertexCount(); ++v) {
    for (const Index w : diagram.vertexNeighbors[static_cast<std::size_t>(v)]) {
      if (w == kNone || !coincide(diagram, v, w)) continue;
      const auto& around = diagram.vertexSites[static_cast<std::size_t>(v)];
      for (const Index a : around) {
        if (!diagram.isReal(a)) continue;
        double& least = nearest[static_cast<std::size_t>(a)];
        for (const Index b : around) {
          if (a == b || !diagram.isReal(b)) continue;
          const double distance =
              (diagram.sites[static_cast<std::size_t>(a)] - diagram.sites[static_cast<std::size_t>(b)]).norm();
          least = least > 0 ? std::min(least, distance) : distance;
        }
      }
    }
  }
  return nearest;
}

}  // namespace

Index moveToGeneralPosition(std::vector<Vec3>& sites, voronoi::Diagram& diagram, const Box3& domain,
                            const RunContext& context) {
  const Box3 cube(Vec3::Constant(-1), Vec3::Constant(1));
  std::vector<std::uint8_t> moved(sites.size(), 0);
  for (std::uint64_t round = 0; round < kRounds; ++round) {
    const std::vector<double> distances = sitesToMove(diagram);
    bool any = false;
    for (std::size_t s = 0; s < sites.size(); ++s) {
      if (!(distances[s] > 0)) continue;
      const Vec3 way = randomInBox(kSeed, RandomStream::generalPosition, round * sites.size() + s, cube);
      sites[s] += kMove * distances[s] * way;
      moved[s] = 1;
      any = true;
    }
    if (!any) break;
    diagram = voronoi::buildDiagram(sites, domain, context);
  }
  return static_cast<Index>(std::count(moved.begin(), moved.end(), std::uint8_t{1}));
}

}  // namespace voroform::cvt
