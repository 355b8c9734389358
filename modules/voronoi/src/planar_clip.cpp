#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "planar_predicates.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/voronoi/planar.hpp"

namespace voroform::voronoi {

namespace {

// Where the boundary passes through an edge of the diagram.
struct Crossing {
  Index edge = kNone;
  // +1 from the edge's first site to its second: then the way along the edge enters the region, whose interior lies on
  // the boundary's left. −1 the other way.
  std::int8_t entering = 0;
};

struct SitePiece {
  Index site = kNone;
  PlanarClip::Piece piece;
};

// Follows the region's boundary from cell to cell.
class BoundaryWalk {
 public:
  BoundaryWalk(const PlanarDiagram& diagram, const mesh::PlanarRegion& region, PlanarClip& clip)
      : diagram_(diagram), region_(region), clip_(clip) {
    clip.regionPoints = region.points().size();
    clip.points.assign(region.points().begin(), region.points().end());
  }

  void followRing(std::size_t ring) {
    const std::uint32_t begin = region_.ringOffsets()[ring];
    locate(region_.points()[begin]);
    for (std::uint32_t k = begin; k < region_.ringOffsets()[ring + 1]; ++k) followEdge(static_cast<Index>(k));
  }

  const std::vector<Crossing>& crossings() const { return crossings_; }
  const std::vector<SitePiece>& pieces() const { return pieces_; }

 private:
  const Vec2& siteAt(Index site) const { return diagram_.sites[static_cast<std::size_t>(site)]; }

  Index across(Index edge, Index site) const {
    const auto& [a, b] = diagram_.edgeSites[static_cast<std::size_t>(edge)];
    return a == site ? b : a;
  }

  // Goes to the nearest site by way of ever nearer ones.
  void locate(const Vec2& p) {
    for (;;) {
      Index nearest = site_;
      for (const Index edge : diagram_.edgesOf(site_)) {
        const Index other = across(edge, site_);
        if (isNearer(p, siteAt(nearest), siteAt(other))) nearest = other;
      }
      if (nearest == site_) return;
      enter(nearest);
    }
  }

  // From cell to cell: a neighbor is met on the way to q if q is nearer to it, and of these the one whose bisector
  // comes first is the next. Each step leads to a site nearer to q, so the walk ends.
  void followEdge(Index regionEdge) {
    const auto vertices = diagram_.vertexCount();
    const Index end = region_.next(static_cast<std::size_t>(regionEdge));
    const Vec2& p = region_.points()[static_cast<std::size_t>(regionEdge)];
    const Vec2& q = region_.points()[static_cast<std::size_t>(end)];
    Index from = vertices + regionEdge;
    for (;;) {
      Index next = kNone;
      Index crossed = kNone;
      for (const Index edge : diagram_.edgesOf(site_)) {
        const Index other = across(edge, site_);
        if (!isNearer(q, siteAt(site_), siteAt(other))) continue;
        if (next != kNone && !isCrossedBefore(p, q, siteAt(site_), siteAt(other), siteAt(next))) continue;
        next = other;
        crossed = edge;
      }
      if (next == kNone) break;
      const Index crossing = vertices + static_cast<Index>(clip_.points.size());
      clip_.points.push_back(bisectorCrossing(p, q, siteAt(site_), siteAt(next)));
      const bool fromFirst = diagram_.edgeSites[static_cast<std::size_t>(crossed)][0] == site_;
      crossings_.push_back({crossed, static_cast<std::int8_t>(fromFirst ? 1 : -1)});
      pieces_.push_back({site_, {from, crossing, regionEdge}});
      enter(next);
      from = crossing;
    }
    pieces_.push_back({site_, {from, vertices + end, regionEdge}});
  }

  void enter(Index site) {
    if (!diagram_.isReal(site)) throw MethodError("the region reaches beyond the domain of the Voronoi diagram");
    site_ = site;
  }

  const PlanarDiagram& diagram_;
  const mesh::PlanarRegion& region_;
  PlanarClip& clip_;
  std::vector<Crossing> crossings_;
  std::vector<SitePiece> pieces_;
  Index site_ = 0;
};

void sortPiecesBySite(const std::vector<SitePiece>& pieces, Index siteCount, PlanarClip& clip) {
  std::vector<std::uint32_t> offsets(static_cast<std::size_t>(siteCount), 0);
  for (const SitePiece& piece : pieces) ++offsets[static_cast<std::size_t>(piece.site)];
  exclusiveScan(offsets);
  clip.pieces.resize(pieces.size());
  std::vector<std::uint32_t> place(offsets.begin(), offsets.end() - 1);
  for (const SitePiece& piece : pieces) clip.pieces[place[static_cast<std::size_t>(piece.site)]++] = piece.piece;
  clip.sitePieceOffsets = std::move(offsets);
}

// Whether each vertex lies inside: vertices of ghosts' cells do not, and along an edge each crossing changes it.
void classifyVertices(const PlanarDiagram& diagram, const std::vector<Crossing>& crossings, PlanarClip& clip) {
  std::vector<Index> entering(diagram.edgeSites.size(), 0);  // along the edge, leaving counted negative
  for (const Crossing& crossing : crossings) entering[static_cast<std::size_t>(crossing.edge)] += crossing.entering;
  constexpr std::uint8_t kUnknown = 2;
  clip.inside.assign(diagram.vertices.size(), kUnknown);
  std::vector<Index> stack;
  for (std::size_t v = 0; v < diagram.vertices.size(); ++v) {
    const auto& sites = diagram.vertexSites[v];
    if (std::all_of(sites.begin(), sites.end(), [&](Index site) { return diagram.isReal(site); })) continue;
    clip.inside[v] = 0;
    stack.push_back(static_cast<Index>(v));
  }
  while (!stack.empty()) {
    const Index v = stack.back();
    stack.pop_back();
    for (const Index edge : diagram.vertexEdges[static_cast<std::size_t>(v)]) {
      if (edge == kNone) continue;
      const auto& [first, second] = diagram.edgeVertices[static_cast<std::size_t>(edge)];
      const int change =
          v == first ? entering[static_cast<std::size_t>(edge)] : -entering[static_cast<std::size_t>(edge)];
      const int winding = clip.inside[static_cast<std::size_t>(v)] + change;
      const Index other = v == first ? second : first;
      auto& state = clip.inside[static_cast<std::size_t>(other)];
      if (state == winding) continue;
      if (state != kUnknown || winding < 0 || winding > 1)
        throw MethodError("the region's rings do not bound a region");
      state = static_cast<std::uint8_t>(winding);
      stack.push_back(other);
    }
  }
}

// Puts the crossings of an edge in their order along it. It alternates between the two directions; where rounding makes
// places equal, or turns their order, that decides.
void orderAlongEdge(const PlanarDiagram& diagram, const std::vector<Crossing>& crossings, Index edge,
                    const PlanarClip& clip, std::span<Index> row) {
  if (row.size() < 2) return;
  const auto& [first, second] = diagram.edgeVertices[static_cast<std::size_t>(edge)];
  const Vec2& start = diagram.vertices[static_cast<std::size_t>(first)];
  const Vec2 along = diagram.vertices[static_cast<std::size_t>(second)] - start;
  std::vector<std::pair<double, Index>> places[2];  // leaving and entering
  const Index firstCrossing = diagram.vertexCount() + static_cast<Index>(clip.regionPoints);
  for (const Index point : row) {
    const bool enters = crossings[static_cast<std::size_t>(point - firstCrossing)].entering > 0;
    places[enters ? 1 : 0].emplace_back(along.dot(clip.position(diagram, point) - start), point);
  }
  std::sort(places[0].begin(), places[0].end());
  std::sort(places[1].begin(), places[1].end());
  bool inside = clip.inside[static_cast<std::size_t>(first)] != 0;
  std::size_t used[2] = {0, 0};
  for (Index& point : row) {
    const std::size_t kind = inside ? 0 : 1;
    point = places[kind][used[kind]++].second;
    inside = !inside;
  }
}

void collectCuts(const PlanarDiagram& diagram, const std::vector<Crossing>& crossings, PlanarClip& clip) {
  clip.cutRows.assign(diagram.edgeSites.size(), kNone);
  for (const Crossing& crossing : crossings) clip.cutRows[static_cast<std::size_t>(crossing.edge)] = 0;
  for (std::size_t e = 0; e < clip.cutRows.size(); ++e) {
    if (clip.cutRows[e] == kNone) continue;
    clip.cutRows[e] = static_cast<Index>(clip.cutEdges.size());
    clip.cutEdges.push_back(static_cast<Index>(e));
  }
  clip.cutOffsets.assign(clip.cutEdges.size(), 0);
  const auto rowOf = [&](const Crossing& crossing) {
    return static_cast<std::size_t>(clip.cutRows[static_cast<std::size_t>(crossing.edge)]);
  };
  for (const Crossing& crossing : crossings) ++clip.cutOffsets[rowOf(crossing)];
  exclusiveScan(clip.cutOffsets);
  clip.cutCrossings.resize(crossings.size());
  std::vector<std::uint32_t> place(clip.cutOffsets.begin(), clip.cutOffsets.end() - 1);
  Index point = diagram.vertexCount() + static_cast<Index>(clip.regionPoints);
  for (const Crossing& crossing : crossings) clip.cutCrossings[place[rowOf(crossing)]++] = point++;
  for (std::size_t row = 0; row < clip.cutEdges.size(); ++row) {
    orderAlongEdge(
        diagram, crossings, clip.cutEdges[row], clip,
        std::span(clip.cutCrossings).subspan(clip.cutOffsets[row], clip.cutOffsets[row + 1] - clip.cutOffsets[row]));
  }
}

}  // namespace

PlanarClip clipPlanar(const PlanarDiagram& diagram, const mesh::PlanarRegion& region, const RunContext& context) {
  PlanarClip clip;
  BoundaryWalk walk(diagram, region, clip);
  for (std::size_t ring = 0; ring < region.ringCount(); ++ring) {
    context.throwIfCancelled();
    walk.followRing(ring);
  }
  sortPiecesBySite(walk.pieces(), diagram.siteCount, clip);
  classifyVertices(diagram, walk.crossings(), clip);
  collectCuts(diagram, walk.crossings(), clip);
  return clip;
}

std::vector<std::array<Index, 2>> neighborPairs(const PlanarDiagram& diagram, const PlanarClip& clip) {
  std::vector<std::array<Index, 2>> pairs;
  for (std::size_t e = 0; e < diagram.edgeSites.size(); ++e) {
    if (!diagram.isReal(diagram.edgeSites[e][1])) continue;
    // A cut edge has a piece on either side of its crossing.
    const bool inside = clip.inside[static_cast<std::size_t>(diagram.edgeVertices[e][0])] != 0;
    if (inside || clip.cutRows[e] != kNone) pairs.push_back(diagram.edgeSites[e]);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace voroform::voronoi
