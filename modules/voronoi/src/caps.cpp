#include "caps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "facet_frame.hpp"
#include "projection.hpp"
#include "thin_parts.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 64;
// Reach of a cap point's projection, in units of the loop's radius.
constexpr double kReach = 2;
// First step of the search for S, in units of the loop's radius.
constexpr double kFirstStep = 0.1;
// A cap over a loop in a facet's plane encloses a volume if its point is at least this high, in units of the radius.
constexpr double kPlanarHeight = 1e-6;
// Where S is higher than kTall over a loop, or not met, the cell may hold the end of a thin part. Its tip is searched;
// what is farther than kLong is one. In units of the loop's width.
constexpr double kTall = 0.5;
constexpr double kLong = 1.5;
// Where caps of one cell cross, their points are tried at these heights over the loops' centroids, in units of radius.
constexpr double kOtherHeights[] = {0.0, 0.1, -0.1, 0.25, -0.25, 0.5, -0.5, 0.75, -0.75};

using Triangle = std::array<Index, 3>;

// Size and attitude of a loop.
struct LoopFrame {
  Vec3 centroid;
  Vec3 normal;  // unit, out of the solid; zero if the loop encloses no area
  double radius;
  double width;  // radius of a disk of its vector area: what reaches out of the loop's plane does not add to it
};

// A cap in the making: its apex, if it is a fan, and its triangles; the apex is numbered kNone. A cap may instead fall
// into a facet of the cell: onto one of its polygons, or as a patch beside them.
struct Cap {
  std::optional<Vec3> apex;
  std::vector<Triangle> triangles;
  Index collapsedPolygon = kNone;
  std::optional<Caps::Patch> patch;

  bool planar() const { return collapsedPolygon != kNone || patch; }
};

struct CapChunk {
  std::vector<Vec3> points;
  std::vector<std::uint32_t> counts;
  std::vector<Triangle> triangles;  // the chunk's own points numbered −1, −2, …
  std::vector<Index> apexes;        // of each loop: its number in points, or kNone
  std::vector<Caps::Collapsed> collapsed;
  std::vector<Caps::Patch> patches;
  ClipSummary summary;
};

class CellCapper {
 public:
  CellCapper(const Diagram& diagram, const ClippedDiagram& clipped, const implicit::ImplicitFunction& f,
             const ClipOptions& options, CapChunk& chunk)
      : diagram_(diagram), clipped_(clipped), f_(f), options_(options), chunk_(chunk) {}

  // Caps the loops [first, last) of one cell.
  void cap(Index first, Index last) {
    site_ = clipped_.loopSites[static_cast<std::size_t>(first)];
    caps_.clear();
    for (Index l = first; l < last; ++l) {
      const auto loop = clipped_.loop(l);
      const Index neighbor = neighborInPlane(loop);
      caps_.push_back(neighbor == kNone ? makeCap(loop, last - first == 1) : makePlanarCap(loop, neighbor));
    }
    if (caps_.size() > 1 && cross()) separate(first, last);
    for (const Cap& cap : caps_) emit(cap);
  }

 private:
  const Vec3& position(Index point) const { return clipped_.position(diagram_, point); }

  LoopFrame frameOf(std::span<const Index> loop) const {
    LoopFrame frame{Vec3::Zero(), Vec3::Zero(), 0, 0};
    for (const Index point : loop) frame.centroid += position(point);
    frame.centroid /= static_cast<double>(loop.size());
    Vec3 previous = position(loop.back()) - frame.centroid;
    for (const Index point : loop) {
      const Vec3 current = position(point) - frame.centroid;
      frame.normal += previous.cross(current);
      frame.radius = std::max(frame.radius, current.norm());
      previous = current;
    }
    const double area = frame.normal.norm();
    frame.width = std::sqrt(area / (2 * std::numbers::pi));
    frame.normal = area > 0 ? Vec3(frame.normal / area) : Vec3(Vec3::Zero());
    if (options_.cap == CapKind::cvt2 || options_.cap == CapKind::cvt3) frame.centroid = centroidByArea(loop, frame);
    return frame;
  }

  // The centroid of the fan about the mean of the loop's points: these crowd where the cell has short edges, and a fan
  // about the one has larger triangles than a fan about the other.
  Vec3 centroidByArea(std::span<const Index> loop, const LoopFrame& frame) const {
    double total = 0;
    Vec3 moment = Vec3::Zero();
    Vec3 previous = position(loop.back()) - frame.centroid;
    for (const Index point : loop) {
      const Vec3 current = position(point) - frame.centroid;
      const double area = previous.cross(current).norm();
      total += area;
      moment += area * (previous + current) / 3;
      previous = current;
    }
    return total > 0 ? Vec3(frame.centroid + moment / total) : frame.centroid;
  }

  double reachInCell(const Vec3& p, const Vec3& d) const { return voronoi::reachInCell(diagram_, site_, p, d); }

  static Cap fan(std::span<const Index> loop, const Vec3& apex) {
    Cap cap;
    cap.apex = apex;
    for (std::size_t k = 0; k < loop.size(); ++k)
      cap.triangles.push_back({loop[k], loop[(k + 1) % loop.size()], kNone});
    return cap;
  }

  Cap makeCap(std::span<const Index> loop, bool onlyLoop) {
    if (options_.cap == CapKind::cvt1) {
      if (std::optional<Cap> hull = onlyLoop ? hullOf(loop) : std::nullopt) return *std::move(hull);
      ++chunk_.summary.fallbackCaps;
      return fan(loop, frameOf(loop).centroid);
    }
    const LoopFrame frame = frameOf(loop);
    if (options_.cap == CapKind::flat) return fan(loop, frame.centroid);
    return fan(loop, projected(frame));
  }

  // The sites on the other side of the facets that a loop's point lies on; kNone fills up.
  std::array<Index, 2> neighborsAt(Index point) const {
    std::array<Index, 2> others = {kNone, kNone};
    const Index extra = point - diagram_.vertexCount();
    if (extra < clipped_.rootCount) {
      const auto& sites = clipped_.rootSites[static_cast<std::size_t>(extra)];
      std::copy_if(sites.begin(), sites.end(), others.begin(), [&](Index s) { return s != site_; });
    } else {
      const Index facet = clipped_.chordPointFacets[static_cast<std::size_t>(extra - clipped_.rootCount)];
      const auto& [a, b] = diagram_.facetSites[static_cast<std::size_t>(facet)];
      others[0] = a == site_ ? b : a;
    }
    return others;
  }

  // The neighbor whose facet holds the whole loop, or kNone.
  Index neighborInPlane(std::span<const Index> loop) const {
    for (const Index neighbor : neighborsAt(loop[0])) {
      if (neighbor != kNone && std::all_of(loop.begin(), loop.end(), [&](Index point) {
            const auto others = neighborsAt(point);
            return others[0] == neighbor || others[1] == neighbor;
          })) {
        return neighbor;
      }
    }
    return kNone;
  }

  // The cap of a loop in a facet's plane: a fan if S bulges into the cell there. Else, where the loop goes around a
  // polygon of the facet, the cell's piece falls into the facet; where it goes around a hole, a patch closes the hole.
  Cap makePlanarCap(std::span<const Index> loop, Index neighbor) {
    const LoopFrame frame = frameOf(loop);
    if (options_.cap == CapKind::cvt2 || options_.cap == CapKind::cvt3) {
      const std::optional<double> height = projection(frame);
      if (height && std::abs(*height) > kPlanarHeight * frame.radius) {
        return fan(loop, frame.centroid + *height * frame.normal);
      }
    }
    ++chunk_.summary.fallbackCaps;
    Cap cap;
    const Vec3 across =
        diagram_.sites[static_cast<std::size_t>(neighbor)] - diagram_.sites[static_cast<std::size_t>(site_)];
    if (frame.normal.dot(across) > 0) {
      cap.patch = Caps::Patch{site_, neighbor, {loop.begin(), loop.end()}};
    } else {
      cap.collapsedPolygon = polygonAround(loop, neighbor);
    }
    return cap;
  }

  // The polygon, of the facet towards the neighbor, whose border the loop is.
  Index polygonAround(std::span<const Index> loop, Index neighbor) const {
    for (const Index facet : diagram_.facetsOf(site_)) {
      const auto& [a, b] = diagram_.facetSites[static_cast<std::size_t>(facet)];
      if ((a == site_ ? b : a) != neighbor) continue;
      const auto first = std::lower_bound(clipped_.polygonFacets.begin(), clipped_.polygonFacets.end(), facet);
      for (auto polygon = static_cast<Index>(first - clipped_.polygonFacets.begin());
           polygon < clipped_.polygonCount() && clipped_.polygonFacets[static_cast<std::size_t>(polygon)] == facet;
           ++polygon) {
        const auto points = clipped_.polygon(polygon);
        if (std::find(points.begin(), points.end(), loop[0]) != points.end()) return polygon;
      }
    }
    throw MethodError("the planar loop of site " + std::to_string(site_) + " bounds no polygon");
  }

  Vec3 projected(const LoopFrame& frame) {
    const std::optional<double> height = projection(frame);
    // A loop without area has no normal to search about.
    if (frame.width > 0 && (!height || *height > kTall * frame.width)) {
      const TipSearch search{frame.centroid, frame.normal, frame.width, kLong * frame.width,
                             [&](const Vec3& direction) { return reachInCell(frame.centroid, direction); }};
      if (const auto tip = findTip(search, f_, options_, chunk_.summary.evaluations)) {
        ++chunk_.summary.tips;
        return *tip;
      }
    }
    if (!height) ++chunk_.summary.unprojectedPoints;
    return frame.centroid + height.value_or(0.0) * frame.normal;
  }

  // Where S lies over the loop's centroid, along the normal.
  std::optional<double> projection(const LoopFrame& frame) {
    ++chunk_.summary.capPoints;
    Ray ray;
    ray.origin = frame.centroid;
    ray.direction = frame.normal;
    ray.outward = std::min(kReach * frame.radius, (1 - kBorderShare) * reachInCell(frame.centroid, frame.normal));
    ray.inward = std::min(kReach * frame.radius, (1 - kBorderShare) * reachInCell(frame.centroid, -frame.normal));
    return projectOnSurface(f_, ray, kFirstStep * frame.radius, options_.rootTolerance * frame.radius,
                            options_.rootFinder, chunk_.summary.evaluations);
  }

  std::optional<Cap> hullOf(std::span<const Index> loop) const {
    std::vector<Vec3> points;
    std::vector<std::array<Index, 2>> facets;
    for (const Index point : loop) {
      points.push_back(position(point));
      facets.push_back(neighborsAt(point));
    }
    std::vector<Vec3> kept;
    for (const Index facet : diagram_.facetsOf(site_)) {
      for (const Index v : diagram_.facet(facet)) {
        if (clipped_.inside[static_cast<std::size_t>(v)] != 0)
          kept.push_back(diagram_.vertices[static_cast<std::size_t>(v)]);
      }
    }
    const auto triangles = hullCap(points, facets, kept);
    if (triangles.empty()) return std::nullopt;
    Cap cap;
    for (const auto& [a, b, c] : triangles) cap.triangles.push_back({loop[a], loop[b], loop[c]});
    return cap;
  }

  std::vector<std::array<Vec3, 3>> corners(const Cap& cap) const {
    std::vector<std::array<Vec3, 3>> result;
    for (const Triangle& t : cap.triangles) {
      result.push_back({position(t[0]), position(t[1]), t[2] == kNone ? *cap.apex : position(t[2])});
    }
    return result;
  }

  bool cross() const {
    for (std::size_t i = 0; i < caps_.size(); ++i) {
      for (std::size_t j = i + 1; j < caps_.size(); ++j) {
        if (trianglesMeet(corners(caps_[i]), corners(caps_[j]))) return true;
      }
    }
    return false;
  }

  // Caps of one cell cross: tries fans at other heights, cap by cap, until they are apart.
  void separate(Index first, Index last) {
    const std::vector<Cap> asked = caps_;
    std::vector<LoopFrame> frames;
    for (Index l = first; l < last; ++l) frames.push_back(frameOf(clipped_.loop(l)));
    const std::size_t heights = std::size(kOtherHeights);
    const auto fanAt = [&](std::size_t cap, double height) {
      if (asked[cap].planar()) return asked[cap];
      const LoopFrame& frame = frames[cap];
      const double reach =
          (1 - kBorderShare) * reachInCell(frame.centroid, height < 0 ? Vec3(-frame.normal) : frame.normal);
      const double distance = std::copysign(std::min(std::abs(height) * frame.radius, reach), height);
      return fan(clipped_.loop(first + static_cast<Index>(cap)), frame.centroid + distance * frame.normal);
    };
    // All caps at one height; then, for the usual pair, every combination.
    for (std::size_t i = 0; i < heights; ++i) {
      for (std::size_t j = 0; j < (caps_.size() == 2 ? heights : 1); ++j) {
        for (std::size_t cap = 0; cap < caps_.size(); ++cap) {
          const std::size_t height = cap == 0 ? i : (i + j) % heights;
          caps_[cap] = fanAt(cap, kOtherHeights[height]);
        }
        if (!cross()) {
          chunk_.summary.fallbackCaps += static_cast<Index>(caps_.size());
          return;
        }
      }
    }
    caps_ = asked;
    chunk_.summary.crossingCells += 1;
  }

  void emit(const Cap& cap) {
    if (cap.collapsedPolygon != kNone) chunk_.collapsed.push_back({cap.collapsedPolygon, site_});
    if (cap.patch) chunk_.patches.push_back(*cap.patch);
    chunk_.apexes.push_back(cap.apex ? static_cast<Index>(chunk_.points.size()) : kNone);
    if (cap.apex) chunk_.points.push_back(*cap.apex);
    const Index apex = -static_cast<Index>(chunk_.points.size());
    for (Triangle triangle : cap.triangles) {
      if (triangle[2] == kNone) triangle[2] = apex;
      chunk_.triangles.push_back(triangle);
    }
    chunk_.counts.push_back(static_cast<std::uint32_t>(cap.triangles.size()));
  }

  const Diagram& diagram_;
  const ClippedDiagram& clipped_;
  const implicit::ImplicitFunction& f_;
  const ClipOptions& options_;
  CapChunk& chunk_;
  Index site_ = kNone;
  std::vector<Cap> caps_;
};

}  // namespace

Caps buildCaps(const Diagram& diagram, ClippedDiagram& clipped, const implicit::ImplicitFunction& f,
               const ClipOptions& options, const RunContext& context) {
  // The first loop of each cell.
  std::vector<Index> cells;
  for (Index l = 0; l < clipped.loopCount(); ++l) {
    const auto i = static_cast<std::size_t>(l);
    if (l == 0 || clipped.loopSites[i] != clipped.loopSites[i - 1]) cells.push_back(l);
  }
  cells.push_back(clipped.loopCount());

  const std::size_t cellCount = cells.size() - 1;
  std::vector<CapChunk> chunks((cellCount + kGrain - 1) / kGrain);
  parallelFor(context, cellCount, kGrain, [&](std::size_t begin, std::size_t end) {
    CellCapper capper(diagram, clipped, f, options, chunks[begin / kGrain]);
    for (std::size_t c = begin; c < end; ++c) capper.cap(cells[c], cells[c + 1]);
  });

  Caps caps;
  const Index firstPoint = diagram.vertexCount() + static_cast<Index>(clipped.points.size());
  for (const CapChunk& chunk : chunks) {
    const Index base = firstPoint + static_cast<Index>(caps.points.size());
    for (Triangle triangle : chunk.triangles) {
      for (Index& point : triangle) {
        if (point < 0) point = base - point - 1;
      }
      caps.triangles.push_back(triangle);
    }
    for (const Index apex : chunk.apexes) caps.apexes.push_back(apex == kNone ? kNone : base + apex);
    caps.points.insert(caps.points.end(), chunk.points.begin(), chunk.points.end());
    caps.collapsed.insert(caps.collapsed.end(), chunk.collapsed.begin(), chunk.collapsed.end());
    caps.patches.insert(caps.patches.end(), chunk.patches.begin(), chunk.patches.end());
    caps.triangleOffsets.insert(caps.triangleOffsets.end(), chunk.counts.begin(), chunk.counts.end());
    clipped.summary.capPoints += chunk.summary.capPoints;
    clipped.summary.tips += chunk.summary.tips;
    clipped.summary.unprojectedPoints += chunk.summary.unprojectedPoints;
    clipped.summary.fallbackCaps += chunk.summary.fallbackCaps;
    clipped.summary.crossingCells += chunk.summary.crossingCells;
    clipped.summary.evaluations += chunk.summary.evaluations;
  }
  exclusiveScan(caps.triangleOffsets);
  return caps;
}

}  // namespace voroform::voronoi
