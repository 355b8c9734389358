#include "surface_cvt_cells.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "surface_cvt_grid.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::metrics {

namespace {

constexpr std::size_t kGrain = 1024;
constexpr std::size_t kChunks = 256;
// Lists of neighbors reach so many spacings: about 14 sites on a smooth surface, enough for the cells of most.
constexpr double kListSpacings = 2;
// A triangle goes to sites on its own side of a thin sheet; the cosine lets cells bend around sharp edges.
constexpr double kLeastCosine = -0.5;
constexpr double kOwnSheetSpacings = 2;

// The neighbors of each site within a radius, nearest first.
struct NeighborLists {
  double radius = 0;
  std::vector<std::size_t> offsets;
  std::vector<Index> neighbors;
};

using Candidate = std::pair<double, Index>;  // squared distance, site

NeighborLists neighborLists(const PointGrid& grid, const std::vector<Vec3>& points, double radius,
                            const RunContext& context) {
  NeighborLists lists;
  lists.radius = radius;
  lists.offsets.assign(points.size(), 0);
  std::vector<std::vector<Index>> parts((points.size() + kGrain - 1) / kGrain);
  parallelFor(context, points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Candidate> found;
    std::vector<Index>& part = parts[begin / kGrain];
    for (std::size_t i = begin; i < end; ++i) {
      found.clear();
      grid.forEachWithin(points[i], radius, [&](Index j, double squaredDistance) {
        if (static_cast<std::size_t>(j) != i) found.emplace_back(squaredDistance, j);
      });
      std::sort(found.begin(), found.end());
      for (const Candidate& candidate : found) part.push_back(candidate.second);
      lists.offsets[i] = found.size();
    }
  });
  exclusiveScan(lists.offsets);
  lists.neighbors.reserve(lists.offsets.back());
  for (const std::vector<Index>& part : parts) lists.neighbors.insert(lists.neighbors.end(), part.begin(), part.end());
  return lists;
}

// A convex polygon in a triangle's plane, relative to a site; edge k runs from corner k to the next, and came from the
// bisector with site labels[k], or from the triangle (kNone).
class Polygon {
 public:
  void reset(const Vec3& a, const Vec3& b, const Vec3& c) {
    corners_ = {a, b, c};
    labels_ = {kNone, kNone, kNone};
    updateReach();
  }
  bool empty() const { return corners_.empty(); }
  // The largest squared distance of a corner from the site.
  double squaredReach() const { return squaredReach_; }
  const std::vector<Vec3>& corners() const { return corners_; }
  const std::vector<Index>& labels() const { return labels_; }

  void clear() {
    corners_.clear();
    labels_.clear();
    squaredReach_ = 0;
  }

  // Keeps what is no nearer to the site at `other` (relative, at the squared distance given) than to the polygon's own.
  void clip(const Vec3& other, double squaredDistance, Index label) {
    const double half = squaredDistance / 2;
    heights_.clear();
    bool cut = false;
    for (const Vec3& corner : corners_) {
      heights_.push_back(other.dot(corner) - half);
      cut = cut || heights_.back() > 0;
    }
    if (!cut) return;
    nextCorners_.clear();
    nextLabels_.clear();
    const std::size_t count = corners_.size();
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t next = k + 1 == count ? 0 : k + 1;
      const double from = heights_[k];
      const double to = heights_[next];
      if (from <= 0) add(corners_[k], labels_[k]);
      if ((from <= 0) == (to <= 0)) continue;
      const double share = from / (from - to);
      // Leaving, the new edge along the bisector begins here; entering, what is left of the old one.
      add(corners_[k] + share * (corners_[next] - corners_[k]), from <= 0 ? label : labels_[k]);
    }
    corners_.swap(nextCorners_);
    labels_.swap(nextLabels_);
    if (corners_.size() < 3) clear();
    updateReach();
  }

 private:
  void add(const Vec3& corner, Index label) {
    nextCorners_.push_back(corner);
    nextLabels_.push_back(label);
  }
  void updateReach() {
    squaredReach_ = 0;
    for (const Vec3& corner : corners_) squaredReach_ = std::max(squaredReach_, corner.squaredNorm());
  }

  std::vector<Vec3> corners_;
  std::vector<Index> labels_;
  std::vector<double> heights_;
  std::vector<Vec3> nextCorners_;
  std::vector<Index> nextLabels_;
  double squaredReach_ = 0;
};

SurfacePiece measure(const Polygon& polygon, const Vec3& normal) {
  SurfacePiece piece;
  const std::vector<Vec3>& corners = polygon.corners();
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const Vec3& a = corners[0];
    const Vec3& b = corners[k - 1];
    const Vec3& c = corners[k];
    const double area = 0.5 * normal.dot((b - a).cross(c - a));
    const Vec3 sum = a + b + c;
    piece.area += area;
    piece.moment += area / 3 * sum;
    piece.energy += area / 12 * (a.squaredNorm() + b.squaredNorm() + c.squaredNorm() + sum.squaredNorm());
  }
  return piece;
}

// What all threads share.
struct Diagram {
  const mesh::TriangleMesh& mesh;
  const Facets& facets;
  const std::vector<Vec3>& points;
  std::vector<Vec3> siteNormals;
  PointGrid grid;
  NeighborLists lists;
  double spacing;
};

// Divides triangles one after the other; each thread's chunk has its own.
class TriangleDivider {
 public:
  explicit TriangleDivider(const Diagram& diagram) : diagram_(diagram), stamps_(diagram.points.size(), 0) {}

  void divide(std::size_t triangle, std::vector<SurfacePiece>& pieces) {
    normal_ = diagram_.facets.normals[triangle];
    if (diagram_.facets.areas[triangle] <= 0) return;
    for (std::size_t k = 0; k < 3; ++k) {
      corners_[k] = diagram_.mesh.vertices[static_cast<std::size_t>(diagram_.mesh.triangles[triangle][k])];
    }
    ++stamp_;
    queue_.clear();
    push(firstSite());
    // Cells meet the triangle in convex pieces that fill it, so all are found across the edges between them.
    for (std::size_t k = 0; k < queue_.size(); ++k) {
      const Index site = queue_[k];
      clipToCell(site);
      if (polygon_.empty()) continue;
      for (const Index label : polygon_.labels()) push(label);
      SurfacePiece piece = measure(polygon_, normal_);
      piece.site = site;
      piece.triangle = static_cast<Index>(triangle);
      pieces.push_back(piece);
    }
  }

 private:
  bool mayOwn(Index site) const {
    return allSites_ || diagram_.siteNormals[static_cast<std::size_t>(site)].dot(normal_) >= kLeastCosine;
  }

  Index firstSite() {
    const Vec3 centroid = (corners_[0] + corners_[1] + corners_[2]) / 3;
    const auto accept = [&](Index site) { return mayOwn(site); };
    allSites_ = false;
    const Index own = diagram_.grid.nearest(centroid, diagram_.spacing, kOwnSheetSpacings * diagram_.spacing, accept);
    if (own != kNone) return own;
    allSites_ = true;
    return diagram_.grid.nearest(centroid, kOwnSheetSpacings * diagram_.spacing,
                                 std::numeric_limits<double>::infinity(), accept);
  }

  void push(Index site) {
    if (site == kNone || stamps_[static_cast<std::size_t>(site)] == stamp_) return;
    stamps_[static_cast<std::size_t>(site)] = stamp_;
    queue_.push_back(site);
  }

  // Clips the polygon by the bisector with a neighbor, unless that is too far to cut it (the security radius of Lévy &
  // Bonneel 2012): then no farther one does either, and the result is false.
  bool clipBy(Index site, Index neighbor) {
    const Vec3 other =
        diagram_.points[static_cast<std::size_t>(neighbor)] - diagram_.points[static_cast<std::size_t>(site)];
    const double squaredDistance = other.squaredNorm();
    if (squaredDistance > 4 * polygon_.squaredReach()) return false;
    if (!mayOwn(neighbor)) return true;
    if (squaredDistance > 0) {
      polygon_.clip(other, squaredDistance, neighbor);
    } else if (neighbor < site) {
      polygon_.clear();
    }
    return !polygon_.empty();
  }

  void clipToCell(Index site) {
    const auto i = static_cast<std::size_t>(site);
    const Vec3& origin = diagram_.points[i];
    polygon_.reset(corners_[0] - origin, corners_[1] - origin, corners_[2] - origin);
    const NeighborLists& lists = diagram_.lists;
    for (std::size_t k = lists.offsets[i]; k < lists.offsets[i + 1]; ++k) {
      if (!clipBy(site, lists.neighbors[k])) return;
    }
    const double needed = 2 * std::sqrt(polygon_.squaredReach());
    if (needed <= lists.radius) return;
    candidates_.clear();
    diagram_.grid.forEachWithin(origin, needed, [&](Index j, double squaredDistance) {
      if (squaredDistance > lists.radius * lists.radius) candidates_.emplace_back(squaredDistance, j);
    });
    std::sort(candidates_.begin(), candidates_.end());
    for (const Candidate& candidate : candidates_) {
      if (!clipBy(site, candidate.second)) return;
    }
  }

  const Diagram& diagram_;
  std::vector<std::uint32_t> stamps_;
  std::uint32_t stamp_ = 0;
  std::vector<Index> queue_;
  std::vector<Candidate> candidates_;
  std::array<Vec3, 3> corners_;
  Vec3 normal_ = Vec3::Zero();
  bool allSites_ = false;  // the triangle has no site of its own sheet near
  Polygon polygon_;
};

// Borders of chunks of triangles with about the same work each: large triangles meet many cells.
std::vector<std::size_t> chunksOf(const Facets& facets, std::size_t sites) {
  const double perTriangle = 1 / static_cast<double>(facets.areas.size());
  const double perArea = static_cast<double>(sites) * perTriangle / facets.area();
  const double step = (1 + static_cast<double>(sites) * perTriangle) / static_cast<double>(kChunks);
  std::vector<std::size_t> borders = {0};
  double border = step;
  for (std::size_t t = 0; t < facets.areas.size(); ++t) {
    const double work = static_cast<double>(t + 1) * perTriangle + facets.areaUpTo[t + 1] * perArea;
    if (work < border) continue;
    borders.push_back(t + 1);
    border = work + step;
  }
  if (borders.back() != facets.areas.size()) borders.push_back(facets.areas.size());
  return borders;
}

SurfaceCells sortedBySite(const std::vector<std::vector<SurfacePiece>>& parts, std::size_t sites) {
  SurfaceCells cells;
  cells.offsets.assign(sites, 0);
  for (const auto& part : parts) {
    for (const SurfacePiece& piece : part) ++cells.offsets[static_cast<std::size_t>(piece.site)];
  }
  exclusiveScan(cells.offsets);
  cells.pieces.resize(cells.offsets.back());
  std::vector<std::size_t> next(cells.offsets.begin(), cells.offsets.end() - 1);
  for (const auto& part : parts) {
    for (const SurfacePiece& piece : part) cells.pieces[next[static_cast<std::size_t>(piece.site)]++] = piece;
  }
  return cells;
}

}  // namespace

Facets facetsOf(const mesh::TriangleMesh& mesh, const RunContext& context) {
  const std::size_t count = mesh.triangles.size();
  Facets facets;
  facets.areas.resize(count);
  facets.normals.resize(count);
  parallelFor(context, count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const auto corner = [&](std::size_t k) -> const Vec3& {
        return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k])];
      };
      const Vec3 twice = (corner(1) - corner(0)).cross(corner(2) - corner(0));
      const double length = twice.norm();
      facets.areas[t] = length / 2;
      facets.normals[t] = length > 0 ? Vec3(twice / length) : Vec3::Zero();
    }
  });
  facets.areaUpTo = facets.areas;
  exclusiveScan(facets.areaUpTo);
  return facets;
}

SurfaceCells surfaceCells(const mesh::TriangleMesh& mesh, const Facets& facets, const SurfaceSites& sites,
                          double spacing, const RunContext& context) {
  const std::size_t count = sites.points.size();
  const double listRadius = kListSpacings * spacing;
  Diagram diagram = {mesh, facets, sites.points, {}, PointGrid(sites.points, listRadius), {}, spacing};
  diagram.lists = neighborLists(diagram.grid, sites.points, listRadius, context);
  diagram.siteNormals.reserve(count);
  for (const Index triangle : sites.triangles) {
    diagram.siteNormals.push_back(facets.normals[static_cast<std::size_t>(triangle)]);
  }
  const std::vector<std::size_t> chunks = chunksOf(facets, count);
  std::vector<std::vector<SurfacePiece>> parts(chunks.size() - 1);
  parallelFor(context, parts.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t chunk = begin; chunk < end; ++chunk) {
      TriangleDivider divider(diagram);
      for (std::size_t t = chunks[chunk]; t < chunks[chunk + 1]; ++t) divider.divide(t, parts[chunk]);
    }
  });
  return sortedBySite(parts, count);
}

}  // namespace voroform::metrics
