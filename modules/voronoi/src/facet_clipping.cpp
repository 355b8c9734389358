#include "facet_clipping.hpp"

#include <algorithm>
#include <string>

#include "thin_parts.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 4096;

// A stretch of a facet's border that lies in the solid: it begins at an entering root and ends at a leaving one, with
// diagram vertices between.
struct Stretch {
  std::vector<Index> points;
};

// What a chunk of facets keeps.
struct PolygonChunk {
  std::vector<Index> facets;
  std::vector<std::uint32_t> sizes;
  std::vector<Index> points;
  std::vector<Chord> chords;
  std::vector<Vec3> tonguePoints;  // numbered −1, −2, … in points and chords
  std::vector<Index> tongueFacets;
  std::int64_t evaluations = 0;
};

class FacetClipper {
 public:
  FacetClipper(const Diagram& diagram, const EdgeRoots& roots, const implicit::ImplicitFunction& f,
               const ClipOptions& options, ClippedDiagram& clipped)
      : diagram_(diagram), roots_(roots), f_(f), options_(options), clipped_(clipped) {}

  void clip(std::size_t begin, std::size_t end, PolygonChunk& chunk) {
    using State = ClippedDiagram::FacetState;
    for (std::size_t facet = begin; facet < end; ++facet) {
      const auto loop = diagram_.facet(static_cast<Index>(facet));
      std::uint8_t touched = 0;
      for (const Index v : loop) touched |= roots_.touched[static_cast<std::size_t>(v)];
      const bool firstInside = roots_.inside[static_cast<std::size_t>(loop.front())] != 0;
      State state = firstInside ? State::whole : State::outside;
      if (touched != 0 && walk(loop)) {
        state = State::cut;
        keep(static_cast<Index>(facet), chunk);
      }
      clipped_.facetStates[facet] = state;
    }
  }

 private:
  // Collects the points of the facet's border that the solid holds, in cyclic order; false if there is no root.
  bool walk(std::span<const Index> loop) {
    border_.clear();
    bool found = false;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Index v = loop[k];
      const Index w = loop[(k + 1) % loop.size()];
      if (roots_.inside[static_cast<std::size_t>(v)] != 0) border_.push_back(v);
      if (roots_.touched[static_cast<std::size_t>(v)] == 0) continue;
      const Index edge =
          roots_.crossedEdge[4 * static_cast<std::size_t>(v) + static_cast<std::size_t>(diagram_.slotOf(v, w))];
      if (edge == kNone) continue;
      found = true;
      const Index first =
          diagram_.vertexCount() + static_cast<Index>(roots_.rootOffsets[static_cast<std::size_t>(edge)]);
      const Index last =
          diagram_.vertexCount() + static_cast<Index>(roots_.rootOffsets[static_cast<std::size_t>(edge) + 1]);
      if (v < w) {
        for (Index r = first; r < last; ++r) border_.push_back(r);
      } else {
        for (Index r = last; r-- > first;) border_.push_back(r);
      }
    }
    return found;
  }

  bool isRoot(Index point) const { return point >= diagram_.vertexCount(); }

  // Cuts the border into stretches, each from an entering to a leaving root. Roots alternate between the two kinds; the
  // first one's kind follows from the sign where the walk began.
  void cutIntoStretches(bool beganInside) {
    stretches_.clear();
    bool inside = beganInside;
    std::vector<Index> head;  // of the stretch that the walk began within
    for (const Index point : border_) {
      if (!isRoot(point)) {
        (stretches_.empty() ? head : stretches_.back().points).push_back(point);
      } else if (inside) {
        (stretches_.empty() ? head : stretches_.back().points).push_back(point);
        inside = false;
      } else {
        stretches_.push_back({{point}});
        inside = true;
      }
    }
    if (!head.empty()) {
      Stretch& last = stretches_.back();
      last.points.insert(last.points.end(), head.begin(), head.end());
    }
  }

  // Whether the stretches belong together through the facet's middle. One stretch does. Where all roots lie on one edge
  // the middle is inside if one of the facet's vertices is. Else f decides at the mean of the
  // roots (the saddle's sign, as in Marching Cubes' ambiguous faces).
  bool joined(PolygonChunk& chunk) const {
    if (stretches_.size() == 1) return true;
    if (rootsOnOneEdge()) return std::any_of(border_.begin(), border_.end(), [&](Index p) { return !isRoot(p); });
    Vec3 mean = Vec3::Zero();
    for (const Stretch& stretch : stretches_) {
      mean += position(stretch.points.front()) + position(stretch.points.back());
    }
    mean /= 2.0 * static_cast<double>(stretches_.size());
    ++chunk.evaluations;
    return f_.value(mean) < 0;
  }

  bool rootsOnOneEdge() const {
    const std::array<Index, 3>* first = nullptr;
    for (const Index point : border_) {
      if (!isRoot(point)) continue;
      const auto& sites = clipped_.rootSites[static_cast<std::size_t>(point - diagram_.vertexCount())];
      if (first != nullptr && sites != *first) return false;
      first = &sites;
    }
    return true;
  }

  const Vec3& position(Index point) const { return clipped_.position(diagram_, point); }

  void keep(Index facet, PolygonChunk& chunk) {
    const auto loop = diagram_.facet(facet);
    cutIntoStretches(roots_.inside[static_cast<std::size_t>(loop.front())] != 0);
    if (stretches_.size() == 1 && stretches_[0].points.size() == 2 && keepTongue(facet, chunk)) return;
    if (joined(chunk)) {
      polygon_.clear();
      for (std::size_t k = 0; k < stretches_.size(); ++k) {
        const auto& points = stretches_[k].points;
        polygon_.insert(polygon_.end(), points.begin(), points.end());
        chunk.chords.push_back({points.back(), stretches_[(k + 1) % stretches_.size()].points.front(), facet});
      }
      addPolygon(facet, polygon_, chunk);
    } else {
      for (const Stretch& stretch : stretches_) {
        chunk.chords.push_back({stretch.points.back(), stretch.points.front(), facet});
        addPolygon(facet, stretch.points, chunk);
      }
    }
  }

  // The border holds one stretch of one edge: the solid may go on within the facet.
  bool keepTongue(Index facet, PolygonChunk& chunk) {
    polygon_ = stretches_[0].points;
    const std::vector<Vec3> tongue =
        facetTongue(diagram_, facet, position(polygon_[0]), position(polygon_[1]), f_, options_, chunk.evaluations);
    if (tongue.empty()) return false;
    for (const Vec3& point : tongue) {
      chunk.tonguePoints.push_back(point);
      chunk.tongueFacets.push_back(facet);
      polygon_.push_back(-static_cast<Index>(chunk.tonguePoints.size()));
    }
    for (std::size_t k = 1; k < polygon_.size(); ++k) {
      chunk.chords.push_back({polygon_[k], polygon_[(k + 1) % polygon_.size()], facet});
    }
    addPolygon(facet, polygon_, chunk);
    return true;
  }

  // A polygon of two points (both roots of one edge) has no area; its chord stays, so that the cell's loop closes.
  static void addPolygon(Index facet, const std::vector<Index>& points, PolygonChunk& chunk) {
    if (points.size() < 3) return;
    chunk.facets.push_back(facet);
    chunk.sizes.push_back(static_cast<std::uint32_t>(points.size()));
    chunk.points.insert(chunk.points.end(), points.begin(), points.end());
  }

  const Diagram& diagram_;
  const EdgeRoots& roots_;
  const implicit::ImplicitFunction& f_;
  const ClipOptions& options_;
  ClippedDiagram& clipped_;
  std::vector<Index> border_;
  std::vector<Stretch> stretches_;
  std::vector<Index> polygon_;
};

}  // namespace

void clipFacets(const Diagram& diagram, const EdgeRoots& roots, const implicit::ImplicitFunction& f,
                const ClipOptions& options, ClippedDiagram& clipped, const RunContext& context) {
  const std::size_t count = diagram.facetSites.size();
  clipped.facetStates.resize(count);
  std::vector<PolygonChunk> chunks((count + kGrain - 1) / kGrain);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    FacetClipper(diagram, roots, f, options, clipped).clip(begin, end, chunks[begin / kGrain]);
  });
  clipped.polygonOffsets.clear();
  for (PolygonChunk& chunk : chunks) {
    const Index firstPoint = diagram.vertexCount() + static_cast<Index>(clipped.points.size());
    const auto number = [firstPoint](Index& point) {
      if (point < 0) point = firstPoint - point - 1;
    };
    for (Index& point : chunk.points) number(point);
    for (Chord& chord : chunk.chords) {
      number(chord.leave);
      number(chord.enter);
    }
    clipped.points.insert(clipped.points.end(), chunk.tonguePoints.begin(), chunk.tonguePoints.end());
    clipped.chordPointFacets.insert(clipped.chordPointFacets.end(), chunk.tongueFacets.begin(),
                                    chunk.tongueFacets.end());
    clipped.summary.tonguePoints += static_cast<Index>(chunk.tonguePoints.size());
    clipped.summary.evaluations += chunk.evaluations;
    clipped.polygonFacets.insert(clipped.polygonFacets.end(), chunk.facets.begin(), chunk.facets.end());
    clipped.polygonOffsets.insert(clipped.polygonOffsets.end(), chunk.sizes.begin(), chunk.sizes.end());
    clipped.polygonPoints.insert(clipped.polygonPoints.end(), chunk.points.begin(), chunk.points.end());
    clipped.chords.insert(clipped.chords.end(), chunk.chords.begin(), chunk.chords.end());
  }
  exclusiveScan(clipped.polygonOffsets);
}

void linkLoops(const Diagram& diagram, ClippedDiagram& clipped, const RunContext& context) {
  // Compressed rows from the sites to their chords. Seen from the facet's second site its polygon runs from leave to
  // enter; the first site sees it the same way round from outside, so its cap runs from enter to leave, and the second
  // site's from leave to enter.
  std::vector<std::uint32_t> offsets(static_cast<std::size_t>(diagram.siteCount), 0);
  const auto forEachOwner = [&](const auto& action) {
    for (std::size_t c = 0; c < clipped.chords.size(); ++c) {
      const auto& owners = diagram.facetSites[static_cast<std::size_t>(clipped.chords[c].facet)];
      for (const Index owner : owners) {
        if (diagram.isReal(owner)) action(owner, static_cast<Index>(c), owner == owners[0]);
      }
    }
  };
  struct Half {
    Index from;
    Index to;
    Index point;
  };
  forEachOwner([&](Index owner, Index, bool) { ++offsets[static_cast<std::size_t>(owner)]; });
  exclusiveScan(offsets);
  std::vector<Half> halves(offsets.back());
  std::vector<std::uint32_t> next(offsets.begin(), offsets.end() - 1);
  forEachOwner([&](Index owner, Index c, bool first) {
    const Chord& chord = clipped.chords[static_cast<std::size_t>(c)];
    halves[next[static_cast<std::size_t>(owner)]++] =
        first ? Half{chord.enter, chord.leave, chord.point} : Half{chord.leave, chord.enter, chord.point};
  });

  struct LoopChunk {
    std::vector<Index> sites;
    std::vector<std::uint32_t> sizes;
    std::vector<Index> points;
    Index boundaryCells = 0;
    Index multiLoopCells = 0;
  };
  std::vector<LoopChunk> chunks((static_cast<std::size_t>(diagram.siteCount) + kGrain - 1) / kGrain);
  parallelFor(context, static_cast<std::size_t>(diagram.siteCount), kGrain, [&](std::size_t begin, std::size_t end) {
    LoopChunk& chunk = chunks[begin / kGrain];
    std::vector<std::uint8_t> used;
    for (std::size_t site = begin; site < end; ++site) {
      const std::span<const Half> own(halves.data() + offsets[site], offsets[site + 1] - offsets[site]);
      if (own.empty()) continue;
      used.assign(own.size(), 0);
      Index loops = 0;
      for (std::size_t start = 0; start < own.size(); ++start) {
        if (used[start] != 0) continue;
        const std::size_t before = chunk.points.size();
        std::size_t half = start;
        do {
          used[half] = 1;
          chunk.points.push_back(own[half].from);
          if (own[half].point != kNone) chunk.points.push_back(own[half].point);
          const Index to = own[half].to;
          half = static_cast<std::size_t>(
              std::find_if(own.begin(), own.end(), [&](const Half& h) { return h.from == to; }) - own.begin());
          if (half == own.size() || (used[half] != 0 && half != start)) {
            throw MethodError("the chords of the cell of site " + std::to_string(site) + " do not close");
          }
        } while (half != start);
        if (chunk.points.size() - before < 3) {  // two coincident chords cancel
          chunk.points.resize(before);
          continue;
        }
        chunk.sites.push_back(static_cast<Index>(site));
        chunk.sizes.push_back(static_cast<std::uint32_t>(chunk.points.size() - before));
        ++loops;
      }
      if (loops > 0) ++chunk.boundaryCells;
      if (loops > 1) ++chunk.multiLoopCells;
    }
  });
  for (const LoopChunk& chunk : chunks) {
    clipped.loopSites.insert(clipped.loopSites.end(), chunk.sites.begin(), chunk.sites.end());
    clipped.loopOffsets.insert(clipped.loopOffsets.end(), chunk.sizes.begin(), chunk.sizes.end());
    clipped.loopPoints.insert(clipped.loopPoints.end(), chunk.points.begin(), chunk.points.end());
    clipped.summary.boundaryCells += chunk.boundaryCells;
    clipped.summary.multiLoopCells += chunk.multiLoopCells;
  }
  exclusiveScan(clipped.loopOffsets);
  clipped.summary.loops = clipped.loopCount();
}

}  // namespace voroform::voronoi
