#include "voroform/mesh/planar_region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_2/Segment_2_Segment_2.h>

#include "edge_tree.hpp"

namespace voroform::mesh {

class PlanarRegion::EdgeTree : public RingEdgeTree {
  using RingEdgeTree::RingEdgeTree;
};

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using Segment = Kernel::Segment_2;

Point toPoint(const Vec2& p) { return {p.x(), p.y()}; }

using Rings = std::span<const std::vector<Vec2>>;

std::vector<RingEdge> edgesOf(Rings rings) {
  std::vector<RingEdge> edges;
  for (const auto& ring : rings) {
    for (std::size_t k = 0; k < ring.size(); ++k) edges.push_back({ring[k], ring[(k + 1) % ring.size()]});
  }
  return edges;
}

std::optional<RingFault> findPointFault(Rings rings) {
  if (rings.empty()) return RingFault{"a region needs at least one ring of points", 0, 0};
  for (std::size_t r = 0; r < rings.size(); ++r) {
    const auto& ring = rings[r];
    for (std::size_t k = 0; k < ring.size(); ++k) {
      if (!ring[k].allFinite()) return RingFault{"a coordinate is not a finite number", r, k};
    }
    if (ring.size() < 3) {
      return RingFault{"expected a ring of 3 or more points, found " + std::to_string(ring.size()), r, 0};
    }
    for (std::size_t k = 0; k < ring.size(); ++k) {
      if (ring[k] == ring[(k + 1) % ring.size()]) return RingFault{"the point equals the next one of its ring", r, k};
    }
  }
  return std::nullopt;
}

// Do two edges meet elsewhere than in the end that they share as neighbors in a ring?
bool edgesMeet(const RingEdge& a, const RingEdge& b, bool bFollowsA, bool aFollowsB) {
  const auto foldBack = [](const RingEdge& first, const RingEdge& second) {
    const Point p = toPoint(first.from);
    const Point q = toPoint(first.to);
    const Point r = toPoint(second.to);
    return CGAL::collinear(p, q, r) && !CGAL::collinear_are_ordered_along_line(p, q, r);
  };
  if (bFollowsA) return foldBack(a, b);
  if (aFollowsB) return foldBack(b, a);
  return CGAL::do_intersect(Segment(toPoint(a.from), toPoint(a.to)), Segment(toPoint(b.from), toPoint(b.to)));
}

std::optional<RingFault> findCrossing(Rings rings) {
  const RingEdgeTree tree(edgesOf(rings));
  std::size_t first = 0;
  for (std::size_t r = 0; r < rings.size(); first += rings[r].size(), ++r) {
    for (std::size_t k = 0; k < rings[r].size(); ++k) {
      const std::size_t a = first + k;
      const RingEdge& edge = tree.edges()[a];
      const Box2 box = Box2(edge.from).extend(edge.to);
      std::size_t met = std::numeric_limits<std::size_t>::max();
      tree.forEachEdge([&](const Box2& other) { return box.intersects(other); },
                       [&](std::size_t b) {
                         if (b <= a || b > met) return;
                         const std::size_t last = first + rings[r].size() - 1;
                         if (edgesMeet(edge, tree.edges()[b], b == a + 1 && a != last, a == first && b == last)) {
                           met = b;
                         }
                       });
      if (met == std::numeric_limits<std::size_t>::max()) continue;
      std::size_t ring = r;
      std::size_t begin = first;
      while (met - begin >= rings[ring].size()) begin += rings[ring++].size();
      return RingFault{"the edge that begins here crosses or touches the edge that begins at ring " +
                           std::to_string(ring + 1) + ", point " + std::to_string(met - begin + 1),
                       r, k};
    }
  }
  return std::nullopt;
}

// Whether the ray from p to the right crosses the edge, ends counted half-open so that rings are crossed consistently.
enum class RayCrossing { none, crosses, onEdge };
RayCrossing crossRay(const RingEdge& edge, const Vec2& p) {
  const bool rises = edge.from.y() <= edge.to.y();
  const Vec2& low = rises ? edge.from : edge.to;
  const Vec2& high = rises ? edge.to : edge.from;
  if (p.y() < low.y() || p.y() > high.y()) return RayCrossing::none;
  if (low.y() == high.y()) {
    const auto [left, right] = std::minmax({low.x(), high.x()});
    return left <= p.x() && p.x() <= right ? RayCrossing::onEdge : RayCrossing::none;
  }
  const auto side = CGAL::orientation(toPoint(low), toPoint(high), toPoint(p));
  if (side == CGAL::COLLINEAR) return RayCrossing::onEdge;
  return side == CGAL::LEFT_TURN && p.y() < high.y() ? RayCrossing::crosses : RayCrossing::none;
}

bool rayMeets(const Box2& box, const Vec2& p) {
  return box.min().y() <= p.y() && p.y() <= box.max().y() && p.x() <= box.max().x();
}

double signedArea(std::span<const Vec2> ring) {
  double sum = 0;
  for (std::size_t k = 2; k < ring.size(); ++k) {
    const Vec2 a = ring[k - 1] - ring[0];
    const Vec2 b = ring[k] - ring[0];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * sum;
}

// Whether a simple ring runs counter-clockwise, exactly: by the turn at its lowest, then leftmost point.
bool runsCounterClockwise(std::span<const Vec2> ring) {
  const auto lowest =
      static_cast<std::size_t>(std::min_element(ring.begin(), ring.end(),
                                                [](const Vec2& a, const Vec2& b) {
                                                  return a.y() < b.y() || (a.y() == b.y() && a.x() < b.x());
                                                }) -
                               ring.begin());
  const std::size_t n = ring.size();
  // Both neighbors lie above it, or at its height to its right; not in one direction, or the edges would overlap.
  return CGAL::orientation(toPoint(ring[(lowest + n - 1) % n]), toPoint(ring[lowest]),
                           toPoint(ring[(lowest + 1) % n])) == CGAL::LEFT_TURN;
}

}  // namespace

InvalidRegion::InvalidRegion(RingFault what)
    : InputError("ring " + std::to_string(what.ring + 1) + ", point " + std::to_string(what.point + 1) + ": " +
                 what.message),
      fault(std::move(what)) {}

std::optional<RingFault> findFault(Rings rings) {
  if (auto fault = findPointFault(rings)) return fault;
  return findCrossing(rings);
}

PlanarRegion::PlanarRegion(Rings rings) {
  if (auto fault = findFault(rings)) throw InvalidRegion(std::move(*fault));
  const RingEdgeTree tree(edgesOf(rings));

  std::vector<std::size_t> ringOf;
  for (std::size_t r = 0; r < rings.size(); ++r) ringOf.insert(ringOf.end(), rings[r].size(), r);
  std::vector<std::size_t> met;
  for (std::size_t r = 0; r < rings.size(); ++r) {
    // Rings do not touch: ring r lies within those that a ray from any of its points crosses an odd number of times.
    met.clear();
    const Vec2& p = rings[r][0];
    tree.forEachEdge([&](const Box2& box) { return rayMeets(box, p); },
                     [&](std::size_t e) {
                       if (ringOf[e] != r && crossRay(tree.edges()[e], p) == RayCrossing::crosses) {
                         met.push_back(ringOf[e]);
                       }
                     });
    Index depth = 0;
    for (std::size_t i = 0; i < met.size();) {  // edges come in ascending order, so rings do
      std::size_t j = i;
      while (j < met.size() && met[j] == met[i]) ++j;
      depth += static_cast<Index>((j - i) % 2);
      i = j;
    }
    depths_.push_back(depth);

    const auto begin = static_cast<std::ptrdiff_t>(points_.size());
    points_.insert(points_.end(), rings[r].begin(), rings[r].end());
    if (runsCounterClockwise(rings[r]) != (depth % 2 == 0)) std::reverse(points_.begin() + begin + 1, points_.end());
    for (std::size_t k = 0; k < rings[r].size(); ++k) {
      next_.push_back(static_cast<Index>(static_cast<std::size_t>(begin) + (k + 1) % rings[r].size()));
    }
    ringOffsets_.push_back(static_cast<std::uint32_t>(points_.size()));
    area_ += signedArea(ring(r));
  }
  std::vector<RingEdge> edges;
  edges.reserve(points_.size());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    edges.push_back({points_[k], points_[static_cast<std::size_t>(next_[k])]});
  }
  edges_ = std::make_shared<const EdgeTree>(std::move(edges));
  bounds_ = edges_->bounds();
  if (!(area_ > 0) || !std::isfinite(area_ * area_)) {
    throw InvalidRegion({"double precision does not hold the region's area; scale the coordinates", 0, 0});
  }
}

std::size_t PlanarRegion::holeCount() const {
  std::size_t holes = 0;
  for (std::size_t r = 0; r < ringCount(); ++r) holes += isHole(r) ? 1U : 0U;
  return holes;
}

bool PlanarRegion::contains(const Vec2& point) const {
  bool inside = false;
  bool onBoundary = false;
  edges_->forEachEdge([&](const Box2& box) { return rayMeets(box, point); },
                      [&](std::size_t e) {
                        const RayCrossing crossing = crossRay(edges_->edges()[e], point);
                        if (crossing == RayCrossing::crosses) inside = !inside;
                        if (crossing == RayCrossing::onEdge) onBoundary = true;
                      });
  return inside && !onBoundary;
}

double PlanarRegion::signedDistance(const Vec2& point) const {
  const double distance = std::sqrt(edges_->squaredDistance(point));
  return contains(point) ? -distance : distance;
}

namespace {

PlanarRegion fromRing(std::vector<Vec2> ring) {
  const std::vector<std::vector<Vec2>> rings = {std::move(ring)};
  return PlanarRegion(rings);
}

// The point at `turns` of a full turn counter-clockwise from the y axis.
Vec2 onCircle(double radius, double turns) {
  const double angle = 2 * std::numbers::pi * turns;
  return {-radius * std::sin(angle), radius * std::cos(angle)};
}

double sinDegrees(double angle) { return std::sin(angle * std::numbers::pi / 180); }

struct NamedRegion {
  std::string_view name;
  PlanarRegion (*make)();
};
constexpr NamedRegion kNamedRegions[] = {{"square", squareRegion}, {"star", starRegion}, {"disc", discRegion}};

}  // namespace

PlanarRegion squareRegion() { return fromRing({{-10, -10}, {10, -10}, {10, 10}, {-10, 10}}); }

PlanarRegion starRegion() {
  constexpr double kArea = 117.6;
  const double ratio = sinDegrees(18) / sinDegrees(54);
  const double outer = std::sqrt(kArea / (5 * ratio * sinDegrees(36)));
  std::vector<Vec2> ring;
  for (int k = 0; k < 10; ++k) ring.push_back(onCircle(k % 2 == 0 ? outer : ratio * outer, k / 10.0));
  return fromRing(std::move(ring));
}

PlanarRegion discRegion() {
  constexpr int kCorners = 720;
  const double turn = 2 * std::numbers::pi / kCorners;
  const double radius = std::sqrt(turn / std::sin(turn));
  std::vector<Vec2> ring;
  for (int k = 0; k < kCorners; ++k) ring.push_back(onCircle(radius, static_cast<double>(k) / kCorners));
  return fromRing(std::move(ring));
}

PlanarRegion namedRegion(std::string_view name) {
  std::string known;
  for (const NamedRegion& region : kNamedRegions) {
    if (region.name == name) return region.make();
    known += (known.empty() ? "" : ", ") + std::string(region.name);
  }
  throw UsageError("unknown planar region '" + std::string(name) + "'; the regions are " + known);
}

}  // namespace voroform::mesh
