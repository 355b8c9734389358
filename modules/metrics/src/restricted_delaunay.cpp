#include "restricted_delaunay.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "voroform/core/parallel.hpp"
#include "voroform/metrics/shape_quality.hpp"

namespace voroform::metrics {

namespace {

constexpr std::size_t kGrain = 1024;
// Rounds of the repair in which tetrahedra may also be added. Later ones only remove, so that the repair ends.
constexpr int kAddingRounds = 8;

// The face opposite each slot of a tetrahedron of positive orientation, counter-clockwise seen from outside.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaces = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// The tetrahedra of a diagram, and which of them are selected.
class Tetrahedra {
 public:
  Tetrahedra(const voronoi::Diagram& diagram, std::vector<std::uint8_t>& selected)
      : diagram_(diagram), selected_(selected), offsets_(static_cast<std::size_t>(diagram.siteCount), 0) {
    for (const auto& corners : diagram.vertexSites) {
      for (const Index site : corners) {
        if (diagram.isReal(site)) ++offsets_[static_cast<std::size_t>(site)];
      }
    }
    exclusiveScan(offsets_);
    rows_.resize(static_cast<std::size_t>(offsets_.back()));
    std::vector<Index> next(offsets_.begin(), offsets_.end() - 1);
    for (Index t = 0; t < count(); ++t) {
      for (const Index site : sites(t)) {
        if (!diagram.isReal(site)) continue;
        rows_[static_cast<std::size_t>(next[static_cast<std::size_t>(site)]++)] = t;
      }
    }
  }

  Index count() const { return static_cast<Index>(selected_.size()); }
  bool has(Index t) const { return t != kNone && selected_[static_cast<std::size_t>(t)] != 0; }
  void set(Index t, bool selected) { selected_[static_cast<std::size_t>(t)] = selected ? 1 : 0; }
  const std::array<Index, 4>& sites(Index t) const { return diagram_.vertexSites[static_cast<std::size_t>(t)]; }
  Index neighbor(Index t, std::size_t slot) const {
    return diagram_.vertexNeighbors[static_cast<std::size_t>(t)][slot];
  }
  // All tetrahedra about a real site, ascending.
  std::span<const Index> about(Index site) const {
    const auto i = static_cast<std::size_t>(site);
    return {rows_.data() + offsets_[i], static_cast<std::size_t>(offsets_[i + 1] - offsets_[i])};
  }
  bool isReal(Index t) const {
    return std::all_of(sites(t).begin(), sites(t).end(), [&](Index site) { return diagram_.isReal(site); });
  }
  bool contains(Index t, Index site) const {
    return std::find(sites(t).begin(), sites(t).end(), site) != sites(t).end();
  }
  const Vec3& corner(Index t, std::size_t slot) const {
    return diagram_.sites[static_cast<std::size_t>(sites(t)[slot])];
  }
  TetrahedronQuality quality(Index t) const {
    return tetrahedronQuality(corner(t, 0), corner(t, 1), corner(t, 2), corner(t, 3));
  }
  double volume(Index t) const {
    const Vec3& a = corner(t, 0);
    return (corner(t, 1) - a).dot((corner(t, 2) - a).cross(corner(t, 3) - a)) / 6;
  }

 private:
  const voronoi::Diagram& diagram_;
  std::vector<std::uint8_t>& selected_;
  std::vector<Index> offsets_;
  std::vector<Index> rows_;
};

// The tetrahedra about one site in parts that hang together across faces at the site, selected ones and others apart.
struct Star {
  struct Part {
    bool selected = false;
    bool real = true;  // no tetrahedron has a ghost
    double volume = 0;
    std::vector<Index> tetrahedra;
  };
  std::vector<Part> parts;
  Index selectedParts = 0;

  // A triangulated sphere, the site's link, is cut in two by one simple closed curve if and only if both sides hang
  // together across edges: then the boundary is a disk about the site, and its edges there have two faces. If all or
  // none of the star is selected there is no boundary.
  bool isManifold() const { return selectedParts <= 1 && static_cast<Index>(parts.size()) - selectedParts <= 1; }
};

Star starOf(const Tetrahedra& tetrahedra, Index site) {
  const auto about = tetrahedra.about(site);
  std::vector<Index> part(about.size(), kNone);
  std::vector<std::size_t> stack;
  Star star;
  for (std::size_t seed = 0; seed < about.size(); ++seed) {
    if (part[seed] != kNone) continue;
    Star::Part found;
    found.selected = tetrahedra.has(about[seed]);
    part[seed] = static_cast<Index>(star.parts.size());
    stack.assign(1, seed);
    while (!stack.empty()) {
      const std::size_t k = stack.back();
      stack.pop_back();
      const Index t = about[k];
      found.tetrahedra.push_back(t);
      found.volume += tetrahedra.volume(t);
      found.real = found.real && tetrahedra.isReal(t);
      for (std::size_t slot = 0; slot < 4; ++slot) {
        const Index u = tetrahedra.neighbor(t, slot);
        if (tetrahedra.sites(t)[slot] == site || u == kNone || tetrahedra.has(u) != found.selected) continue;
        const auto place = static_cast<std::size_t>(std::lower_bound(about.begin(), about.end(), u) - about.begin());
        if (part[place] != kNone) continue;
        part[place] = part[seed];
        stack.push_back(place);
      }
    }
    if (found.selected) ++star.selectedParts;
    star.parts.push_back(std::move(found));
  }
  return star;
}

// Makes the star of one site manifold by the change of least volume: parts are added or removed until one selected and
// one other part are left.
void repairStar(Tetrahedra& tetrahedra, Star star, bool mayAdd, Selection& selection) {
  std::sort(star.parts.begin(), star.parts.end(),
            [](const Star::Part& a, const Star::Part& b) { return a.volume < b.volume; });
  Index selectedParts = star.selectedParts;
  Index otherParts = static_cast<Index>(star.parts.size()) - selectedParts;
  for (const Star::Part& part : star.parts) {
    if (selectedParts <= 1 && otherParts <= 1) return;
    const bool remove = part.selected && selectedParts > 1;
    const bool add = !part.selected && otherParts > 1 && part.real && mayAdd;
    if (!remove && !add) continue;
    for (const Index t : part.tetrahedra) tetrahedra.set(t, add);
    (add ? selection.repairAdded : selection.repairRemoved) += static_cast<Index>(part.tetrahedra.size());
    // A part that changes sides joins what lies around it. The count after that is found out in the next round.
    return;
  }
  // One selected part with several gaps that cannot be filled: the site leaves the mesh.
  for (const Star::Part& part : star.parts) {
    if (!part.selected) continue;
    for (const Index t : part.tetrahedra) tetrahedra.set(t, false);
    selection.repairRemoved += static_cast<Index>(part.tetrahedra.size());
  }
}

void makeManifold(Tetrahedra& tetrahedra, Index siteCount, Selection& selection, const RunContext& context) {
  for (int round = 0;; ++round) {
    context.throwIfCancelled();
    std::vector<std::uint8_t> singular(static_cast<std::size_t>(siteCount), 0);
    parallelFor(context, singular.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        singular[i] = starOf(tetrahedra, static_cast<Index>(i)).isManifold() ? 0 : 1;
      }
    });
    bool any = false;
    for (std::size_t i = 0; i < singular.size(); ++i) {
      if (singular[i] == 0) continue;
      any = true;
      // Looked at again: a site before it may have changed it.
      Star star = starOf(tetrahedra, static_cast<Index>(i));
      if (!star.isManifold()) repairStar(tetrahedra, std::move(star), round < kAddingRounds, selection);
    }
    if (!any) return;
  }
}

// Takes a flat tetrahedron off the boundary if that flips an edge of the boundary: two of its faces lie there, and the
// edge between the two sites opposite them lies in the interior. The boundary stays manifold and keeps its vertices.
bool peel(Tetrahedra& tetrahedra, Index t, std::span<const std::uint8_t> onSurface) {
  const auto& sites = tetrahedra.sites(t);
  std::vector<Index> opposite;
  for (std::size_t slot = 0; slot < 4; ++slot) {
    if (onSurface[static_cast<std::size_t>(sites[slot])] == 0) return false;
    if (!tetrahedra.has(tetrahedra.neighbor(t, slot))) opposite.push_back(sites[slot]);
  }
  if (opposite.size() != 2 || tetrahedra.quality(t).smallestDihedral >= kSliverAngle) return false;
  for (const Index u : tetrahedra.about(opposite[0])) {
    if (tetrahedra.contains(u, opposite[1]) && !tetrahedra.has(u)) return false;
  }
  tetrahedra.set(t, false);
  return true;
}

void peelFlat(Tetrahedra& tetrahedra, std::span<const std::uint8_t> onSurface, Selection& selection) {
  for (bool any = true; any;) {
    any = false;
    for (Index t = 0; t < tetrahedra.count(); ++t) {
      if (!tetrahedra.has(t) || !peel(tetrahedra, t, onSurface)) continue;
      ++selection.flatRemoved;
      any = true;
    }
  }
}

}  // namespace

Selection selectTetrahedra(const voronoi::Diagram& diagram, std::span<const std::uint8_t> onSurface,
                           const implicit::ImplicitFunction& f, const RunContext& context) {
  Selection selection;
  selection.selected.assign(diagram.vertices.size(), 0);
  Tetrahedra tetrahedra(diagram, selection.selected);
  parallelFor(context, selection.selected.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      if (!tetrahedra.isReal(static_cast<Index>(t))) continue;
      const double clearance = f.clearance(diagram.vertices[t]);
      const bool inside = clearance < 0 || (clearance == 0 && f.value(diagram.vertices[t]) < 0);
      selection.selected[t] = inside ? 1 : 0;
    }
  });
  makeManifold(tetrahedra, diagram.siteCount, selection, context);
  peelFlat(tetrahedra, onSurface, selection);
  return selection;
}

std::vector<std::uint8_t> boundarySites(const voronoi::Diagram& diagram, const Selection& selection) {
  std::vector<std::uint8_t> onBoundary(static_cast<std::size_t>(diagram.siteCount), 0);
  for (std::size_t t = 0; t < selection.selected.size(); ++t) {
    if (selection.selected[t] == 0) continue;
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const Index neighbor = diagram.vertexNeighbors[t][slot];
      if (neighbor != kNone && selection.selected[static_cast<std::size_t>(neighbor)] != 0) continue;
      for (const std::size_t k : kFaces[slot]) onBoundary[static_cast<std::size_t>(diagram.vertexSites[t][k])] = 1;
    }
  }
  return onBoundary;
}

mesh::PolyhedralComplex tetrahedralComplex(const voronoi::Diagram& diagram, const Selection& selection,
                                           const implicit::ImplicitFunction& f, const Frame& frame) {
  mesh::PolyhedralComplex complex;
  complex.frame = frame;
  std::vector<Index> cellOf(selection.selected.size(), kNone);
  std::vector<Index> vertexOf(static_cast<std::size_t>(diagram.siteCount), kNone);
  for (std::size_t t = 0; t < selection.selected.size(); ++t) {
    if (selection.selected[t] == 0) continue;
    cellOf[t] = complex.cellCount++;
    for (const Index site : diagram.vertexSites[t]) vertexOf[static_cast<std::size_t>(site)] = 0;
  }
  for (std::size_t i = 0; i < vertexOf.size(); ++i) {
    if (vertexOf[i] == kNone) continue;
    vertexOf[i] = static_cast<Index>(complex.vertices.size());
    complex.vertices.push_back(diagram.sites[i]);
  }
  for (std::size_t t = 0; t < cellOf.size(); ++t) {
    if (cellOf[t] == kNone) continue;
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const Index neighbor = diagram.vertexNeighbors[t][slot];
      const Index ahead = neighbor == kNone ? kNone : cellOf[static_cast<std::size_t>(neighbor)];
      if (ahead != kNone && neighbor < static_cast<Index>(t)) continue;
      std::array<Index, 3> loop{};
      Vec3 centroid = Vec3::Zero();
      for (std::size_t k = 0; k < 3; ++k) {
        const auto site = static_cast<std::size_t>(diagram.vertexSites[t][kFaces[slot][k]]);
        loop[k] = vertexOf[site];
        centroid += diagram.sites[site] / 3;
      }
      const bool envelope = ahead == kNone && f.onEnvelope(centroid);
      complex.addFace(loop, cellOf[t], ahead, envelope ? mesh::FaceTag::envelope : mesh::FaceTag::surface);
    }
  }
  return complex;
}

}  // namespace voroform::metrics
