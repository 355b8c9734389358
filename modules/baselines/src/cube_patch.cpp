#include "cube_patch.hpp"

#include <algorithm>
#include <bit>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace voroform::baselines {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangle = std::array<std::uint8_t, 3>;

constexpr std::uint8_t kFirstInterior = 12;

constexpr std::array<unsigned, 12> kFacesOfEdge = [] {
  std::array<unsigned, 12> faces{};
  for (int edge = 0; edge < 12; ++edge) faces[static_cast<std::size_t>(edge)] = facesOfEdge(edge);
  return faces;
}();

// The position in a loop from which a fan reaches no face of the cube but along the loop's own segments; −1 if there is
// none. The cube being convex, such a fan cannot cross itself.
int fanCorner(std::span<const std::uint8_t> loop) {
  const std::size_t n = loop.size();
  for (std::size_t v = 0; v < n; ++v) {
    bool clear = true;
    for (std::size_t w = 2; w + 1 < n; ++w) {
      if ((kFacesOfEdge[loop[v]] & kFacesOfEdge[loop[(v + w) % n]]) != 0) clear = false;
    }
    if (clear) return static_cast<int>(v);
  }
  return -1;
}

void fanAboutPoint(std::span<const std::uint8_t> loop, const Vec3& center, CubePatch& patch) {
  const auto apex = static_cast<std::uint8_t>(kFirstInterior + patch.interior.size());
  patch.interior.push_back(center);
  for (std::size_t i = 0; i < loop.size(); ++i) {
    patch.triangles.push_back({apex, loop[i], loop[(i + 1) % loop.size()]});
  }
}

// Two hexagons in one cube each join a diagonal of one of two opposite faces. This point keeps a fan on its side of
// the cone from the cube's center over the skew quadrilateral of the four other faces' diagonals between the two,
// wherever on their edges the vertices lie. (The products compared on the six faces exclude this case but for
// rounding: only values within a few units in the last place of ties get here.)
Vec3 centerNearJoinedFace(std::span<const std::uint8_t> loop) {
  std::array<int, 6> visits{};
  for (const std::uint8_t edge : loop) {
    for (std::size_t face = 0; face < 6; ++face) visits[face] += static_cast<int>(kFacesOfEdge[edge] >> face & 1U);
  }
  const auto face = static_cast<Eigen::Index>(std::max_element(visits.begin(), visits.end()) - visits.begin());
  Vec3 center = Vec3::Constant(0.5);
  center[face / 2] = face % 2 == 0 ? 0.25 : 0.75;
  return center;
}

void addDisk(std::span<const std::uint8_t> loop, bool twoHexagons, const std::array<Vec3, 12>& points,
             CubePatch& patch) {
  if (twoHexagons) return fanAboutPoint(loop, centerNearJoinedFace(loop), patch);
  const int corner = fanCorner(loop);
  if (corner < 0) {
    // A loop that visits a face twice: a vertex in the middle, as in Lewiner et al. 2003.
    Vec3 center = Vec3::Zero();
    for (const std::uint8_t edge : loop) center += points[edge] / static_cast<double>(loop.size());
    return fanAboutPoint(loop, center, patch);
  }
  const auto first = static_cast<std::size_t>(corner);
  for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
    patch.triangles.push_back({loop[first], loop[(first + i) % loop.size()], loop[(first + i + 1) % loop.size()]});
  }
}

// The convex hull of at most 12 points on the cube's edges as outward triangles, by insertion with exact predicates.
// Every point is a vertex of it, for no two share an edge of the cube.
class Hull {
 public:
  Hull(std::span<const std::uint8_t> vertices, const std::array<Vec3, 12>& points) : points_(points) {
    std::vector<std::uint8_t> rest(vertices.begin(), vertices.end());
    const auto take = [&](std::size_t i) {
      const std::uint8_t vertex = rest[i];
      rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(i));
      return vertex;
    };
    const std::uint8_t a = take(0);
    const std::uint8_t b = take(0);
    const std::uint8_t c = take(0);
    std::size_t apex = 0;
    while (side({a, b, c}, rest[apex]) == 0) ++apex;
    const bool above = side({a, b, c}, rest[apex]) > 0;
    const std::uint8_t d = take(apex);
    const Triangle base = above ? Triangle{a, c, b} : Triangle{a, b, c};
    triangles_ = {base, {base[1], base[0], d}, {base[2], base[1], d}, {base[0], base[2], d}};
    for (const std::uint8_t vertex : rest) insert(vertex);
  }

  const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  int side(const Triangle& t, std::uint8_t vertex) const {
    const auto point = [&](std::uint8_t v) { return Kernel::Point_3(points_[v][0], points_[v][1], points_[v][2]); };
    return static_cast<int>(CGAL::orientation(point(t[0]), point(t[1]), point(t[2]), point(vertex)));
  }

  void insert(std::uint8_t vertex) {
    std::array<std::array<bool, 12>, 12> edge{};  // directed edges of the triangles that see the vertex
    std::vector<Triangle> kept;
    for (const Triangle& t : triangles_) {
      if (side(t, vertex) <= 0) {
        kept.push_back(t);
        continue;
      }
      for (std::size_t i = 0; i < 3; ++i) edge[t[i]][t[(i + 1) % 3]] = true;
    }
    for (std::uint8_t a = 0; a < 12; ++a) {
      for (std::uint8_t b = 0; b < 12; ++b) {
        if (edge[a][b] && !edge[b][a]) kept.push_back({a, b, vertex});
      }
    }
    triangles_ = std::move(kept);
  }

  const std::array<Vec3, 12>& points_;
  std::vector<Triangle> triangles_;
};

// The annulus between two loops: the part between them of the convex hull of their vertices, drawn inward where it
// touches a face of the cube. Such a part is a quadrilateral with two sides on the loops; it gets a point below its
// center, and each of its other sides one below its middle. Points move towards the hull's middle, so that every
// direction from there still meets the hull's surface once: it cannot cross itself however far they move.
class Tunnel {
 public:
  Tunnel(const CubeTopology& cube, const std::array<Vec3, 12>& points, CubePatch& patch)
      : cube_(cube), points_(points), patch_(patch) {
    for (const std::int8_t l : cube.tunnelLoops) {
      const auto loop = cube.loop(l);
      vertices_.insert(vertices_.end(), loop.begin(), loop.end());
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::uint8_t a = loop[i];
        const std::uint8_t b = loop[(i + 1) % loop.size()];
        onLoop_[a][b] = onLoop_[b][a] = true;
      }
    }
    for (const std::uint8_t v : vertices_) middle_ += points[v] / static_cast<double>(vertices_.size());
  }

  void add() {
    const std::size_t first = patch_.triangles.size();
    std::array<std::vector<Triangle>, 6> flat;
    std::vector<Triangle> others;
    for (const Triangle& t : band()) {
      const unsigned common = kFacesOfEdge[t[0]] & kFacesOfEdge[t[1]] & kFacesOfEdge[t[2]];
      (common == 0 ? others : flat[static_cast<std::size_t>(std::countr_zero(common))]).push_back(t);
    }
    for (const std::vector<Triangle>& triangles : flat) {
      if (!triangles.empty()) addDent(triangles);
    }
    for (const Triangle& t : others) addTriangle(t);
    if (cube_.tunnelInside) return;
    for (std::size_t t = first; t < patch_.triangles.size(); ++t) {
      std::swap(patch_.triangles[t][1], patch_.triangles[t][2]);
    }
  }

 private:
  // How far points are drawn inward: below the center of a quadrilateral, and below its sides.
  static constexpr double kCenterDepth = 0.5;
  static constexpr double kSideDepth = 0.25;

  using EdgeFlags = std::array<std::array<bool, 12>, 12>;

  // The hull's triangles between the two loops: those reached from the loops' inner sides without crossing a loop.
  std::vector<Triangle> band() const {
    EdgeFlags reached{};
    for (const std::int8_t l : cube_.tunnelLoops) {
      const auto loop = cube_.loop(l);
      for (std::size_t i = 0; i < loop.size(); ++i) {
        std::uint8_t a = loop[i];
        std::uint8_t b = loop[(i + 1) % loop.size()];
        if (!cube_.tunnelInside) std::swap(a, b);
        reached[a][b] = true;
      }
    }
    std::vector<Triangle> result;
    std::vector<Triangle> rest = Hull(vertices_, points_).triangles();
    for (bool grown = true; grown;) {
      grown = false;
      for (std::size_t i = 0; i < rest.size();) {
        const Triangle t = rest[i];
        if (!reached[t[0]][t[1]] && !reached[t[1]][t[2]] && !reached[t[2]][t[0]]) {
          ++i;
          continue;
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const std::uint8_t a = t[k];
          const std::uint8_t b = t[(k + 1) % 3];
          if (!onLoop_[a][b]) reached[b][a] = true;
        }
        result.push_back(t);
        rest[i] = rest.back();
        rest.pop_back();
        grown = true;
      }
    }
    return result;
  }

  std::uint8_t addPoint(const Vec3& onHull, double depth) {
    patch_.interior.push_back(onHull + depth * (middle_ - onHull));
    return static_cast<std::uint8_t>(kFirstInterior + patch_.interior.size() - 1);
  }

  void addDent(const std::vector<Triangle>& quadrilateral) {
    EdgeFlags edge{};
    Vec3 center = Vec3::Zero();
    for (const Triangle& t : quadrilateral) {
      for (std::size_t i = 0; i < 3; ++i) {
        edge[t[i]][t[(i + 1) % 3]] = true;
        center += points_[t[i]] / static_cast<double>(3 * quadrilateral.size());
      }
    }
    const std::uint8_t apex = addPoint(center, kCenterDepth);
    for (std::uint8_t a = 0; a < 12; ++a) {
      for (std::uint8_t b = 0; b < 12; ++b) {
        if (!edge[a][b] || edge[b][a]) continue;
        if (onLoop_[a][b]) {
          patch_.triangles.push_back({a, b, apex});
          continue;
        }
        const std::uint8_t side = addPoint(0.5 * (points_[a] + points_[b]), kSideDepth);
        sides_[a][b] = sides_[b][a] = side;
        patch_.triangles.push_back({a, side, apex});
        patch_.triangles.push_back({side, b, apex});
      }
    }
  }

  // A triangle of the hull off the cube's faces, with the points of the sides it shares with dents.
  void addTriangle(const Triangle& t) {
    std::array<std::uint8_t, 6> polygon{};
    std::size_t size = 0;
    std::size_t apex = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      polygon[size++] = t[k];
      const std::uint8_t side = sides_[t[k]][t[(k + 1) % 3]];
      if (side == 0) continue;
      apex = size;  // a fan from a side's point leaves no triangle flat
      polygon[size++] = side;
    }
    for (std::size_t i = 1; i + 1 < size; ++i) {
      patch_.triangles.push_back({polygon[apex], polygon[(apex + i) % size], polygon[(apex + i + 1) % size]});
    }
  }

  const CubeTopology& cube_;
  const std::array<Vec3, 12>& points_;
  CubePatch& patch_;
  std::vector<std::uint8_t> vertices_;
  EdgeFlags onLoop_{};
  std::array<std::array<std::uint8_t, 12>, 12> sides_{};  // the point below a side; 0 if it has none
  Vec3 middle_ = Vec3::Zero();
};

}  // namespace

Vec3 pointOnEdge(int edge, double t) {
  const int corner = lowerCorner(edge);
  Vec3 point(corner & 1, corner >> 1 & 1, corner >> 2);
  point[edge / 4] = t;
  return point;
}

// Why the pieces of one cube do not cross: a disk about one corner lies in the simplex that the corner's neighbors cut
// off, one about an edge in the wedge that the neighboring edges cut off, and no vertex of another piece lies inside
// those; pieces lie in the convex hulls of their vertices. Two pieces of another kind need all twelve edges: they are
// two hexagons, each with its own side of the cube, or an annulus.
void triangulateCut(const CubeTopology& cube, const std::array<double, 12>& edgeParameters, CubePatch& patch) {
  patch.triangles.clear();
  patch.interior.clear();
  std::array<Vec3, 12> points;
  for (std::size_t i = 0; i < cube.loopOffsets[cube.loopCount]; ++i) {
    const std::uint8_t edge = cube.loopEdges[i];
    points[edge] = pointOnEdge(edge, edgeParameters[edge]);
  }
  const bool twoHexagons = cube.loopCount == 2 && cube.loop(0).size() == 6 && cube.loop(1).size() == 6;
  for (int l = 0; l < cube.loopCount; ++l) {
    if (l == cube.tunnelLoops[0] || l == cube.tunnelLoops[1]) continue;
    addDisk(cube.loop(l), twoHexagons, points, patch);
  }
  if (cube.hasTunnel()) Tunnel(cube, points, patch).add();
}

}  // namespace voroform::baselines
