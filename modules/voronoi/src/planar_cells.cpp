// Clipped planar cells: their borders, moments and loops.
#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/voronoi/planar.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 1024;

void appendEdge(const PlanarDiagram& diagram, const PlanarClip& clip, Index edge, Index site,
                std::vector<CellWall>& walls) {
  const auto e = static_cast<std::size_t>(edge);
  const auto& [a, b] = diagram.edgeSites[e];
  const auto& [first, last] = diagram.edgeVertices[e];
  const bool leftward = site == a;
  const Index neighbor = leftward ? b : a;
  const auto append = [&](Index from, Index to) {
    walls.push_back(leftward ? CellWall{from, to, neighbor} : CellWall{to, from, neighbor});
  };
  bool inside = clip.inside[static_cast<std::size_t>(first)] != 0;
  const Index row = clip.cutRows[e];
  if (row == kNone) {
    if (inside) append(first, last);
    return;
  }
  Index from = first;
  for (std::uint32_t k = clip.cutOffsets[static_cast<std::size_t>(row)];
       k < clip.cutOffsets[static_cast<std::size_t>(row) + 1]; ++k) {
    if (inside) append(from, clip.cutCrossings[k]);
    inside = !inside;
    from = clip.cutCrossings[k];
  }
  if (inside) append(from, last);
}

// The moments of a closed border about the origin by Green's theorem: of the triangles that its edges span with it.
class BorderMoments {
 public:
  void add(const Vec2& p, const Vec2& q) {
    const double doubleArea = p.x() * q.y() - p.y() * q.x();
    sum_.mass += doubleArea;
    sum_.first += doubleArea * (p + q);
    sum_.second += doubleArea * (p.squaredNorm() + p.dot(q) + q.squaredNorm());
  }
  Moments<2> moments() const { return {sum_.mass / 2, sum_.first / 6, sum_.second / 12}; }

 private:
  Moments<2> sum_;
};

// Loops of one cell, each by its walls' numbers in order.
class LoopTracer {
 public:
  // Calls beginLoop() and visit(wall) for each of the loop's walls in order. Throws MethodError if a loop stays open.
  template <class Begin, class Visit>
  void trace(Index site, std::span<const CellWall> walls, const Begin& beginLoop, const Visit& visit) {
    byStart_.resize(walls.size());
    std::iota(byStart_.begin(), byStart_.end(), std::size_t{0});
    std::sort(byStart_.begin(), byStart_.end(),
              [&](std::size_t a, std::size_t b) { return walls[a].from < walls[b].from; });
    visited_.assign(walls.size(), false);
    for (std::size_t first = 0; first < walls.size(); ++first) {
      if (visited_[first]) continue;
      beginLoop();
      std::size_t w = first;
      do {
        visited_[w] = true;
        visit(walls[w]);
        const Index to = walls[w].to;
        const auto next = std::lower_bound(byStart_.begin(), byStart_.end(), to,
                                           [&](std::size_t a, Index point) { return walls[a].from < point; });
        if (next == byStart_.end() || walls[*next].from != to || (visited_[*next] && *next != first)) {
          throw MethodError("the walls of the cell of site " + std::to_string(site) + " do not close");
        }
        w = *next;
      } while (w != first);
    }
  }

 private:
  std::vector<std::size_t> byStart_;
  std::vector<bool> visited_;
};

}  // namespace

void appendCellWalls(const PlanarDiagram& diagram, const PlanarClip& clip, Index site, std::vector<CellWall>& walls) {
  for (const Index edge : diagram.edgesOf(site)) appendEdge(diagram, clip, edge, site, walls);
  for (const auto& piece : clip.piecesOf(site)) walls.push_back({piece.from, piece.to, kNone});
}

std::vector<Moments<2>> planarMoments(const PlanarDiagram& diagram, const PlanarClip& clip, const RunContext& context) {
  std::vector<Moments<2>> result(static_cast<std::size_t>(diagram.siteCount));
  parallelFor(context, result.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<CellWall> walls;
    for (std::size_t s = begin; s < end; ++s) {
      walls.clear();
      appendCellWalls(diagram, clip, static_cast<Index>(s), walls);
      const Vec2& site = diagram.sites[s];
      BorderMoments border;
      for (const CellWall& wall : walls) {
        border.add(clip.position(diagram, wall.from) - site, clip.position(diagram, wall.to) - site);
      }
      result[s] = border.moments();
    }
  });
  return result;
}

mesh::PlanarTessellation toTessellation(const PlanarDiagram& diagram, const PlanarClip& clip,
                                        const RunContext& context) {
  mesh::PlanarTessellation result;
  result.sites.assign(diagram.sites.begin(), diagram.sites.begin() + diagram.siteCount);
  std::vector<CellWall> walls;
  LoopTracer tracer;
  for (Index site = 0; site < diagram.siteCount; ++site) {
    if (site % static_cast<Index>(kGrain) == 0) context.throwIfCancelled();
    walls.clear();
    appendCellWalls(diagram, clip, site, walls);
    bool open = false;
    const auto endLoop = [&] {
      if (open) result.loopOffsets.push_back(static_cast<std::uint32_t>(result.loopVertices.size()));
    };
    tracer.trace(
        site, walls,
        [&] {
          endLoop();
          open = true;
        },
        [&](const CellWall& wall) {
          result.loopVertices.push_back(wall.from);
          result.neighbors.push_back(wall.neighbor);
        });
    endLoop();
    result.cellOffsets.push_back(static_cast<std::uint32_t>(result.loopOffsets.size() - 1));
  }

  // Only points of cells become vertices, in the order of their first use.
  std::vector<Index> vertexOf(diagram.vertices.size() + clip.points.size(), kNone);
  for (Index& point : result.loopVertices) {
    Index& vertex = vertexOf[static_cast<std::size_t>(point)];
    if (vertex == kNone) {
      vertex = static_cast<Index>(result.vertices.size());
      result.vertices.push_back(clip.position(diagram, point));
    }
    point = vertex;
  }
  return result;
}

}  // namespace voroform::voronoi
