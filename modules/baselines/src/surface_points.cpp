#include "surface_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "voroform/core/random.hpp"
#include "voroform/implicit/roots.hpp"

namespace voroform::baselines {

namespace {

// A piece gets so many points however small it is: three points of a plane, and one to tell inside from outside.
constexpr std::size_t kFewestPointsPerPiece = 4;

// Signs at the corners of a grid of cubes that covers the box.
class SignGrid {
 public:
  SignGrid(const implicit::ImplicitFunction& f, const SurfaceSearch& search) : spacing_(search.spacing) {
    // A grid at a random place is not symmetric to the solid: no corner on S, no sets of points on one sphere.
    for (int axis = 0; axis < 3; ++axis) {
      const double shift = randomUnit(search.seed, RandomStream::sampling, static_cast<std::uint64_t>(axis));
      origin_[axis] = search.box.min()[axis] - shift * spacing_;
      count_[static_cast<std::size_t>(axis)] =
          static_cast<std::size_t>(std::ceil(search.box.sizes()[axis] / spacing_ + shift)) + 1;
    }
    inside_.reserve(count_[0] * count_[1] * count_[2]);
    for (std::size_t k = 0; k < count_[2]; ++k) {
      for (std::size_t j = 0; j < count_[1]; ++j) {
        for (std::size_t i = 0; i < count_[0]; ++i) inside_.push_back(inside(f, corner({i, j, k})) ? 1 : 0);
      }
    }
  }

  using Corner = std::array<std::size_t, 3>;
  const Corner& count() const { return count_; }
  std::size_t number(const Corner& c) const { return c[0] + count_[0] * (c[1] + count_[1] * c[2]); }
  bool isInside(std::size_t cornerNumber) const { return inside_[cornerNumber] != 0; }
  Vec3 corner(const Corner& c) const {
    return origin_ + spacing_ * Vec3(static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2]));
  }

 private:
  double spacing_;
  Vec3 origin_ = Vec3::Zero();
  Corner count_ = {};
  std::vector<std::uint8_t> inside_;
};

// Disjoint sets of crossings.
class Pieces {
 public:
  std::size_t add() {
    parents_.push_back(parents_.size());
    return parents_.size() - 1;
  }
  std::size_t root(std::size_t crossing) {
    while (parents_[crossing] != crossing) crossing = parents_[crossing] = parents_[parents_[crossing]];
    return crossing;
  }
  // The lower root stays.
  void join(std::size_t a, std::size_t b) {
    const std::size_t rootA = root(a);
    const std::size_t rootB = root(b);
    parents_[std::max(rootA, rootB)] = std::min(rootA, rootB);
  }

 private:
  std::vector<std::size_t> parents_;
};

struct Crossing {
  std::size_t edge;  // 3·corner + axis
  SignGrid::Corner corner;
};

std::vector<Crossing> crossings(const SignGrid& grid) {
  std::vector<Crossing> found;
  const auto& count = grid.count();
  for (std::size_t k = 0; k < count[2]; ++k) {
    for (std::size_t j = 0; j < count[1]; ++j) {
      for (std::size_t i = 0; i < count[0]; ++i) {
        const SignGrid::Corner corner{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis) {
          SignGrid::Corner next = corner;
          if (++next[axis] == count[axis]) continue;
          if (grid.isInside(grid.number(corner)) == grid.isInside(grid.number(next))) continue;
          found.push_back({3 * grid.number(corner) + axis, corner});
        }
      }
    }
  }
  return found;
}

// Joins the crossings of each cube: those on the edges that start at a cut edge's corner, in the cubes around it.
Pieces joinPieces(const SignGrid& grid, const std::vector<Crossing>& found) {
  Pieces pieces;
  for (std::size_t i = 0; i < found.size(); ++i) pieces.add();
  // One crossing of each cube, known by the cube's lowest corner.
  std::vector<std::pair<std::size_t, std::size_t>> cubes;  // cube, crossing
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::size_t axis = found[i].edge % 3;
    for (const std::size_t back : {0, 1}) {
      for (const std::size_t backAgain : {0, 1}) {
        SignGrid::Corner cube = found[i].corner;
        const std::size_t first = (axis + 1) % 3;
        const std::size_t second = (axis + 2) % 3;
        if (cube[first] < back || cube[second] < backAgain) continue;
        cube[first] -= back;
        cube[second] -= backAgain;
        cubes.emplace_back(grid.number(cube), i);
      }
    }
  }
  std::sort(cubes.begin(), cubes.end());
  for (std::size_t k = 1; k < cubes.size(); ++k) {
    if (cubes[k].first == cubes[k - 1].first) pieces.join(cubes[k].second, cubes[k - 1].second);
  }
  return pieces;
}

// Farthest-point sampling: each point next is the one farthest from those before, until they lie closer than `spacing`.
std::vector<std::size_t> spread(const std::vector<Vec3>& points, const std::vector<std::size_t>& members,
                                double spacing, std::size_t most) {
  std::vector<std::size_t> chosen;
  std::vector<double> squaredDistance(members.size(), std::numeric_limits<double>::infinity());
  std::size_t next = 0;
  while (chosen.size() < std::min(most, members.size())) {
    if (chosen.size() >= kFewestPointsPerPiece && squaredDistance[next] < spacing * spacing) break;
    chosen.push_back(members[next]);
    const Vec3& point = points[members[next]];
    for (std::size_t m = 0; m < members.size(); ++m) {
      squaredDistance[m] = std::min(squaredDistance[m], (points[members[m]] - point).squaredNorm());
    }
    next = static_cast<std::size_t>(std::max_element(squaredDistance.begin(), squaredDistance.end()) -
                                    squaredDistance.begin());
    if (!(squaredDistance[next] > 0)) break;
  }
  return chosen;
}

}  // namespace

bool inside(const implicit::ImplicitFunction& f, const Vec3& p) {
  const double clearance = f.clearance(p);
  return clearance != 0 ? clearance < 0 : f.value(p) < 0;
}

Vec3 surfacePoint(const implicit::ImplicitFunction& f, const Vec3& a, const Vec3& b, double tolerance) {
  std::int64_t evaluations = 0;
  const double t = implicit::findRoot(f, a, b, f.value(a), f.value(b), tolerance / (b - a).norm(),
                                      implicit::RootFinder::itp, evaluations);
  return a + t * (b - a);
}

std::vector<Vec3> initialSurfacePoints(const implicit::ImplicitFunction& f, const SurfaceSearch& search) {
  const SignGrid grid(f, search);
  const std::vector<Crossing> found = crossings(grid);
  Pieces pieces = joinPieces(grid, found);
  // The middles of the edges serve to spread the points; roots are found for those chosen alone.
  std::vector<Vec3> middles;
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (std::size_t i = 0; i < found.size(); ++i) {
    Vec3 middle = grid.corner(found[i].corner);
    middle[static_cast<Eigen::Index>(found[i].edge % 3)] += search.spacing / 2;
    middles.push_back(middle);
    members[pieces.root(i)].push_back(i);
  }
  std::vector<Vec3> points;
  for (const auto& [root, piece] : members) {
    for (const std::size_t i : spread(middles, piece, 2 * search.spacing, search.pointsPerPiece)) {
      SignGrid::Corner next = found[i].corner;
      ++next[found[i].edge % 3];
      points.push_back(surfacePoint(f, grid.corner(found[i].corner), grid.corner(next), search.tolerance));
    }
  }
  return points;
}

}  // namespace voroform::baselines
