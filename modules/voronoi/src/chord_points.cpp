// The extra points of cvt3: each chord is bent to the surface within its facet's plane.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "facet_clipping.hpp"
#include "facet_frame.hpp"
#include "projection.hpp"
#include "thin_parts.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 256;
// First step of the search for S, in units of the chord's length: what the sagitta of a resolved surface takes.
constexpr double kFirstStep = 0.05;
// The search goes no farther than this, in units of the chord's half length (twice the loop's radius is the rule for
// caps; a chord is a loop's piece).
constexpr double kReach = 2;
// Where S is higher than kTall over a chord, or not met, the facet may cut the end of a thin part. Its tip is searched;
// what is farther than kLong is one. In units of the chord's length.
constexpr double kTall = 0.25;
constexpr double kLong = 0.75;

// The chords of one facet and the points found for them.
class FacetChords {
 public:
  FacetChords(const Diagram& diagram, const ClippedDiagram& clipped, Index facet)
      : diagram_(diagram), clipped_(clipped) {
    frame_ = facetFrame(diagram, facet);
    for (const Index v : diagram.facet(facet))
      corners_.push_back(frame_(diagram.vertices[static_cast<std::size_t>(v)]));
  }

  // Where S meets the facet's plane, along the chord's perpendicular through its middle; or a thin part's tip, which
  // adds to `tips`.
  std::optional<Vec3> find(const Chord& chord, const implicit::ImplicitFunction& f, const ClipOptions& options,
                           Index& tips, std::int64_t& evaluations) const {
    const Vec3& leave = clipped_.position(diagram_, chord.leave);
    const Vec3& enter = clipped_.position(diagram_, chord.enter);
    const Vec3 middle = 0.5 * (leave + enter);
    const double length = (enter - leave).norm();
    const Eigen::Vector2d along = frame_(enter) - frame_(leave);
    if (!(along.norm() > 0)) return std::nullopt;
    // The polygon lies to the left of leave → enter.
    const Eigen::Vector2d out = Eigen::Vector2d(along.y(), -along.x()).normalized();
    const double reach = kReach * 0.5 * length;
    Ray ray;
    ray.origin = middle;
    ray.direction = out.x() * frame_.u + out.y() * frame_.v;
    ray.outward = std::min(reach, (1 - kBorderShare) * reachInFacet(corners_, frame_(middle), out));
    ray.inward = std::min(reach, (1 - kBorderShare) * reachInFacet(corners_, frame_(middle), -out));
    const std::optional<double> distance =
        projectOnSurface(f, ray, kFirstStep * length, options.rootTolerance * length, options.rootFinder, evaluations);
    if (!distance || *distance > kTall * length) {
      if (const auto tip = findTip(chord, middle, length, f, options, evaluations)) {
        ++tips;
        return tip;
      }
    }
    if (!distance) return std::nullopt;
    return middle + *distance * ray.direction;
  }

  Eigen::Vector2d inPlane(const Vec3& p) const { return frame_(p); }

 private:
  // The farthest that the solid reaches within the facet beyond the chord, if that is far.
  std::optional<Vec3> findTip(const Chord& chord, const Vec3& middle, double length,
                              const implicit::ImplicitFunction& f, const ClipOptions& options,
                              std::int64_t& evaluations) const {
    std::optional<Vec3> tip;
    double farthest = kLong * length;
    for (const Vec3& point : facetTongue(diagram_, chord.facet, clipped_.position(diagram_, chord.enter),
                                         clipped_.position(diagram_, chord.leave), f, options, evaluations)) {
      if (!((point - middle).norm() > farthest)) continue;
      farthest = (point - middle).norm();
      tip = point;
    }
    return tip;
  }

  const Diagram& diagram_;
  const ClippedDiagram& clipped_;
  FacetFrame frame_;
  std::vector<Eigen::Vector2d> corners_;
};

// The chords [begin, end) of one facet and its polygons, as ranges.
struct FacetRange {
  std::size_t chordBegin;
  std::size_t chordEnd;
  std::size_t polygonBegin;
  std::size_t polygonEnd;
};

std::vector<FacetRange> facetRanges(const ClippedDiagram& clipped) {
  std::vector<FacetRange> ranges;
  std::size_t polygon = 0;
  for (std::size_t chord = 0; chord < clipped.chords.size();) {
    const Index facet = clipped.chords[chord].facet;
    FacetRange range{chord, chord, polygon, polygon};
    while (range.chordEnd < clipped.chords.size() && clipped.chords[range.chordEnd].facet == facet) ++range.chordEnd;
    while (range.polygonEnd < clipped.polygonFacets.size() && clipped.polygonFacets[range.polygonEnd] == facet) {
      ++range.polygonEnd;
    }
    ranges.push_back(range);
    chord = range.chordEnd;
    polygon = range.polygonEnd;
  }
  return ranges;
}

// Chords along a diagram edge (S leaves the solid and enters it again on the same edge) stay straight: their facet is
// not the only one they belong to.
bool staysStraight(const ClippedDiagram& clipped, const Chord& chord) {
  // A tongue's border has points enough.
  const std::size_t afterRoots = clipped.inside.size() + static_cast<std::size_t>(clipped.rootCount);
  if (static_cast<std::size_t>(std::max(chord.leave, chord.enter)) >= afterRoots) return true;
  const auto root = [&](Index point) {
    return clipped.rootSites[static_cast<std::size_t>(point) - clipped.inside.size()];
  };
  return root(chord.leave) == root(chord.enter);
}

// Calls visit(point) for the polygon's points, and chordPoint(chord's number) between the ends of each of the facet's
// chords.
template <class Visit, class ChordPoint>
void walkPolygon(const ClippedDiagram& clipped, const FacetRange& range, std::size_t polygonNumber, const Visit& visit,
                 const ChordPoint& chordPoint) {
  const auto polygon = clipped.polygon(static_cast<Index>(polygonNumber));
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    visit(polygon[k]);
    const Index next = polygon[(k + 1) % polygon.size()];
    for (std::size_t c = range.chordBegin; c < range.chordEnd; ++c) {
      if (clipped.chords[c].leave == polygon[k] && clipped.chords[c].enter == next &&
          !staysStraight(clipped, clipped.chords[c])) {
        chordPoint(c);
      }
    }
  }
}

struct Counts {
  Index tried = 0;
  Index failed = 0;
  Index tips = 0;
  std::int64_t evaluations = 0;
};

// Finds the points of one facet's chords. Its polygons must stay simple and apart; else its chords stay straight.
void bendFacet(const Diagram& diagram, const ClippedDiagram& clipped, const FacetRange& range,
               const implicit::ImplicitFunction& f, const ClipOptions& options, std::vector<std::optional<Vec3>>& found,
               Counts& counts) {
  const FacetChords facet(diagram, clipped, clipped.chords[range.chordBegin].facet);
  std::vector<std::vector<Eigen::Vector2d>> rings;
  Index points = 0;
  Index tips = 0;
  for (std::size_t p = range.polygonBegin; p < range.polygonEnd; ++p) {
    auto& ring = rings.emplace_back();
    walkPolygon(
        clipped, range, p, [&](Index point) { ring.push_back(facet.inPlane(clipped.position(diagram, point))); },
        [&](std::size_t c) {
          ++counts.tried;
          found[c] = facet.find(clipped.chords[c], f, options, tips, counts.evaluations);
          if (found[c]) {
            ring.push_back(facet.inPlane(*found[c]));
            ++points;
          } else {
            ++counts.failed;
          }
        });
  }
  if (points == 0 || simpleAndApart(rings)) {
    counts.tips += tips;
    return;
  }
  for (std::size_t c = range.chordBegin; c < range.chordEnd; ++c) found[c].reset();
  counts.failed += points;
}

}  // namespace

void addChordPoints(const Diagram& diagram, const implicit::ImplicitFunction& f, const ClipOptions& options,
                    ClippedDiagram& clipped, const RunContext& context) {
  const std::vector<FacetRange> ranges = facetRanges(clipped);
  std::vector<std::optional<Vec3>> found(clipped.chords.size());
  const Counts counts = parallelReduce(
      context, ranges.size(), kGrain, Counts{},
      [&](std::size_t begin, std::size_t end, Counts count) {
        for (std::size_t r = begin; r < end; ++r) bendFacet(diagram, clipped, ranges[r], f, options, found, count);
        return count;
      },
      [](const Counts& a, const Counts& b) {
        return Counts{a.tried + b.tried, a.failed + b.failed, a.tips + b.tips, a.evaluations + b.evaluations};
      });
  clipped.summary.chordPoints = counts.tried;
  clipped.summary.tips += counts.tips;
  clipped.summary.unprojectedPoints += counts.failed;
  clipped.summary.evaluations += counts.evaluations;

  for (std::size_t c = 0; c < clipped.chords.size(); ++c) {
    if (!found[c]) continue;
    clipped.chords[c].point = diagram.vertexCount() + static_cast<Index>(clipped.points.size());
    clipped.points.push_back(*found[c]);
    clipped.chordPointFacets.push_back(clipped.chords[c].facet);
  }

  std::vector<std::uint32_t> sizes;
  std::vector<Index> points;
  sizes.reserve(clipped.polygonFacets.size() + 1);
  points.reserve(clipped.polygonPoints.size() + clipped.chords.size());
  for (const FacetRange& range : ranges) {
    for (std::size_t p = range.polygonBegin; p < range.polygonEnd; ++p) {
      const std::size_t before = points.size();
      walkPolygon(
          clipped, range, p, [&](Index point) { points.push_back(point); },
          [&](std::size_t c) {
            if (clipped.chords[c].point != kNone) points.push_back(clipped.chords[c].point);
          });
      sizes.push_back(static_cast<std::uint32_t>(points.size() - before));
    }
  }
  exclusiveScan(sizes);
  clipped.polygonOffsets = std::move(sizes);
  clipped.polygonPoints = std::move(points);
}

}  // namespace voroform::voronoi
