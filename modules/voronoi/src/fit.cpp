#include "fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "facet_frame.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::voronoi {

namespace {

constexpr std::size_t kGrain = 256;
// Vertices move by no more than this, in units of the square root of the area around them.
constexpr double kMostShift = 0.25;
// Roots keep this share of the way to their neighbors on the edge clear.
constexpr double kRootShare = 0.05;

// The movable points: the clipped diagram's own, then the caps'. Numbered without the diagram's vertices.
class CapFit {
 public:
  CapFit(const Diagram& diagram, ClippedDiagram& clipped, Caps& caps, std::span<const mesh::FaceTag> tags,
         const RunContext& context)
      : diagram_(diagram), clipped_(clipped), caps_(caps), tags_(tags), context_(context) {
    positions_ = clipped.points;
    positions_.insert(positions_.end(), caps.points.begin(), caps.points.end());
    directions_.assign(positions_.size(), Vec3::Zero());
    ranges_.assign(positions_.size(), {0.0, 0.0});
    selectTriangles();
    aimRoots();
    aimChordPoints();
    aimApexes();
  }

  void run(const implicit::ImplicitFunction& f, const implicit::FitOptions& options) {
    implicit::FitProblem problem;
    problem.positions = positions_;
    problem.directions = directions_;
    problem.ranges = ranges_;
    problem.triangles = triangles_;
    shifts_ = implicit::fitShifts(problem, f, options, context_, clipped_.summary.fit);
    wanted_ = shifts_;
    move();
    // Taking back one shift may break a rule for another; with all of them taken back none is broken.
    while (takeBack()) move();
    for (std::size_t p = 0; p < shifts_.size(); ++p) {
      if (shifts_[p] != 0) ++clipped_.summary.fittedPoints;
      if (shifts_[p] != wanted_[p]) ++clipped_.summary.unfittedPoints;
    }
  }

 private:
  std::size_t slot(Index point) const { return static_cast<std::size_t>(point - diagram_.vertexCount()); }

  // The triangles that follow S, and of each point the area around it. Points of other triangles stay where they are.
  void selectTriangles() {
    area_.assign(positions_.size(), 0.0);
    fixed_.assign(positions_.size(), 0);
    for (std::size_t t = 0; t < caps_.triangles.size(); ++t) {
      std::array<Index, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = static_cast<Index>(slot(caps_.triangles[t][k]));
      if (tags_[t] == mesh::FaceTag::surface) {
        triangles_.push_back(triangle);
        const auto at = [&](std::size_t k) -> const Vec3& { return positions_[static_cast<std::size_t>(triangle[k])]; };
        const double area = 0.5 * (at(1) - at(0)).cross(at(2) - at(0)).norm();
        for (const Index p : triangle) area_[static_cast<std::size_t>(p)] += area;
      } else {
        for (const Index p : triangle) fixed_[static_cast<std::size_t>(p)] = 1;
      }
    }
    // What has no volume must stay in its plane.
    for (const Caps::Patch& patch : caps_.patches) {
      for (const Index point : patch.loop) fixed_[slot(point)] = 1;
    }
    for (const Caps::Collapsed& collapsed : caps_.collapsed) {
      for (const Index point : clipped_.polygon(collapsed.polygon)) {
        if (point >= diagram_.vertexCount()) fixed_[slot(point)] = 1;
      }
    }
  }

  void aim(std::size_t p, const Vec3& direction, double backward, double forward) {
    if (fixed_[p] != 0 || !(area_[p] > 0)) return;
    const double most = kMostShift * std::sqrt(area_[p]);
    directions_[p] = direction;
    ranges_[p] = {-std::clamp(backward, 0.0, most), std::clamp(forward, 0.0, most)};
  }

  void aimRoots() {
    const auto roots = static_cast<std::size_t>(clipped_.rootCount);
    for (std::size_t r = 0; r < roots; ++r) {
      const auto& [v, w] = clipped_.rootEnds[r];
      const bool first = r == 0 || clipped_.rootEnds[r - 1] != clipped_.rootEnds[r];
      const bool last = r + 1 == roots || clipped_.rootEnds[r + 1] != clipped_.rootEnds[r];
      const Vec3& from = diagram_.vertices[static_cast<std::size_t>(v)];
      const Vec3& to = diagram_.vertices[static_cast<std::size_t>(w)];
      const double length = (to - from).norm();
      if (!(length > 0)) continue;
      // Two roots that may both move share the way between them.
      const double backward = first ? (positions_[r] - from).norm() : 0.5 * (positions_[r] - positions_[r - 1]).norm();
      const double forward = last ? (to - positions_[r]).norm() : 0.5 * (positions_[r + 1] - positions_[r]).norm();
      aim(r, (to - from) / length, (1 - kRootShare) * backward, (1 - kRootShare) * forward);
    }
  }

  void aimChordPoints() {
    parallelFor(context_, clipped_.chords.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<Eigen::Vector2d> corners;
      for (std::size_t c = begin; c < end; ++c) {
        const Chord& chord = clipped_.chords[c];
        if (chord.point == kNone) continue;
        const FacetFrame frame = facetFrame(diagram_, chord.facet);
        corners.clear();
        for (const Index v : diagram_.facet(chord.facet)) {
          corners.push_back(frame(diagram_.vertices[static_cast<std::size_t>(v)]));
        }
        const Eigen::Vector2d along =
            frame(clipped_.position(diagram_, chord.enter)) - frame(clipped_.position(diagram_, chord.leave));
        if (!(along.norm() > 0)) continue;
        // The polygon lies to the left of leave → enter.
        const Eigen::Vector2d out = Eigen::Vector2d(along.y(), -along.x()).normalized();
        const std::size_t p = slot(chord.point);
        const Eigen::Vector2d place = frame(positions_[p]);
        aim(p, out.x() * frame.u + out.y() * frame.v, (1 - kBorderShare) * reachInFacet(corners, place, -out),
            (1 - kBorderShare) * reachInFacet(corners, place, out));
      }
    });
  }

  void aimApexes() {
    parallelFor(context_, caps_.apexes.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t l = begin; l < end; ++l) {
        if (caps_.apexes[l] == kNone) continue;
        Vec3 normal = Vec3::Zero();
        for (std::size_t t = caps_.triangleOffsets[l]; t < caps_.triangleOffsets[l + 1]; ++t) {
          const auto at = [&](std::size_t k) -> const Vec3& { return positions_[slot(caps_.triangles[t][k])]; };
          normal += (at(1) - at(0)).cross(at(2) - at(0));
        }
        if (!(normal.norm() > 0)) continue;
        normal.normalize();
        const std::size_t p = slot(caps_.apexes[l]);
        const Index site = clipped_.loopSites[l];
        aim(p, normal, (1 - kBorderShare) * reachInCell(diagram_, site, positions_[p], -normal),
            (1 - kBorderShare) * reachInCell(diagram_, site, positions_[p], normal));
      }
    });
  }

  void move() {
    for (std::size_t p = 0; p < positions_.size(); ++p) {
      Vec3& target = p < clipped_.points.size() ? clipped_.points[p] : caps_.points[p - clipped_.points.size()];
      target = positions_[p] + shifts_[p] * directions_[p];
    }
  }

  // Sets the shifts to 0 that break an embedding rule; whether there was one.
  bool takeBack() {
    std::vector<Index> points;
    collect(brokenFacets(), [&](std::size_t facet) { polygonPoints(static_cast<Index>(facet), points); });
    collect(brokenCells(), [&](std::size_t group) { cellPoints(group, points); });
    bool any = false;
    for (const Index point : points) {
      double& shift = shifts_[slot(point)];
      any = any || shift != 0;
      shift = 0;
    }
    return any;
  }

  template <class Visit>
  static void collect(const std::vector<std::uint8_t>& marked, const Visit& visit) {
    for (std::size_t i = 0; i < marked.size(); ++i) {
      if (marked[i] != 0) visit(i);
    }
  }

  // The first polygon of each cut facet.
  std::vector<std::size_t> facetStarts() const {
    std::vector<std::size_t> starts;
    for (std::size_t p = 0; p < clipped_.polygonFacets.size(); ++p) {
      if (p == 0 || clipped_.polygonFacets[p] != clipped_.polygonFacets[p - 1]) starts.push_back(p);
    }
    starts.push_back(clipped_.polygonFacets.size());
    return starts;
  }

  // The cut facets, by their number in facetStarts(), whose polygons cross each other or themselves.
  std::vector<std::uint8_t> brokenFacets() {
    if (starts_.empty()) starts_ = facetStarts();
    std::vector<std::uint8_t> broken(starts_.size() - 1, 0);
    parallelFor(context_, broken.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<std::vector<Eigen::Vector2d>> rings;
      for (std::size_t i = begin; i < end; ++i) {
        const FacetFrame frame = facetFrame(diagram_, clipped_.polygonFacets[starts_[i]]);
        rings.clear();
        for (std::size_t p = starts_[i]; p < starts_[i + 1]; ++p) {
          auto& ring = rings.emplace_back();
          for (const Index point : clipped_.polygon(static_cast<Index>(p))) {
            ring.push_back(frame(clipped_.position(diagram_, point)));
          }
        }
        broken[i] = simpleAndApart(rings) ? 0 : 1;
      }
    });
    return broken;
  }

  void polygonPoints(Index facet, std::vector<Index>& points) const {
    for (std::size_t p = starts_[static_cast<std::size_t>(facet)]; p < starts_[static_cast<std::size_t>(facet) + 1];
         ++p) {
      for (const Index point : clipped_.polygon(static_cast<Index>(p))) {
        if (point >= diagram_.vertexCount()) points.push_back(point);
      }
    }
  }

  // Loops of one cell stand in a row: the first of each cell that has several.
  std::vector<std::array<std::size_t, 2>> loopGroups() const {
    std::vector<std::array<std::size_t, 2>> groups;
    for (std::size_t l = 0; l < clipped_.loopSites.size();) {
      std::size_t end = l + 1;
      while (end < clipped_.loopSites.size() && clipped_.loopSites[end] == clipped_.loopSites[l]) ++end;
      if (end - l > 1) groups.push_back({l, end});
      l = end;
    }
    return groups;
  }

  std::vector<std::array<Vec3, 3>> corners(std::size_t loop) const {
    std::vector<std::array<Vec3, 3>> result;
    for (std::size_t t = caps_.triangleOffsets[loop]; t < caps_.triangleOffsets[loop + 1]; ++t) {
      std::array<Vec3, 3> triangle;
      for (std::size_t k = 0; k < 3; ++k) triangle[k] = current(caps_.triangles[t][k]);
      result.push_back(triangle);
    }
    return result;
  }

  const Vec3& current(Index point) const {
    const std::size_t p = slot(point);
    return p < clipped_.points.size() ? clipped_.points[p] : caps_.points[p - clipped_.points.size()];
  }

  // The cells of several loops, by their number in loopGroups(), whose caps cross.
  std::vector<std::uint8_t> brokenCells() {
    if (groups_.empty()) groups_ = loopGroups();
    std::vector<std::uint8_t> broken(groups_.size(), 0);
    parallelFor(context_, broken.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t g = begin; g < end; ++g) {
        for (std::size_t i = groups_[g][0]; i < groups_[g][1] && broken[g] == 0; ++i) {
          for (std::size_t j = i + 1; j < groups_[g][1] && broken[g] == 0; ++j) {
            if (trianglesMeet(corners(i), corners(j))) broken[g] = 1;
          }
        }
      }
    });
    return broken;
  }

  void cellPoints(std::size_t group, std::vector<Index>& points) const {
    for (std::size_t l = groups_[group][0]; l < groups_[group][1]; ++l) {
      for (const Index point : clipped_.loop(static_cast<Index>(l))) points.push_back(point);
      if (caps_.apexes[l] != kNone) points.push_back(caps_.apexes[l]);
    }
  }

  const Diagram& diagram_;
  ClippedDiagram& clipped_;
  Caps& caps_;
  std::span<const mesh::FaceTag> tags_;
  const RunContext& context_;

  std::vector<Vec3> positions_;
  std::vector<Vec3> directions_;
  std::vector<std::array<double, 2>> ranges_;
  std::vector<double> area_;
  std::vector<std::uint8_t> fixed_;
  std::vector<std::array<Index, 3>> triangles_;
  std::vector<double> shifts_;
  std::vector<double> wanted_;
  std::vector<std::size_t> starts_;
  std::vector<std::array<std::size_t, 2>> groups_;
};

}  // namespace

void fitCaps(const Diagram& diagram, ClippedDiagram& clipped, Caps& caps, std::span<const mesh::FaceTag> tags,
             const implicit::ImplicitFunction& f, const ClipOptions& options, const RunContext& context) {
  CapFit(diagram, clipped, caps, tags, context).run(f, options.fitOptions);
}

}  // namespace voroform::voronoi
