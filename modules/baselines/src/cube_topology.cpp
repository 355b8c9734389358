#include "cube_topology.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

namespace voroform::baselines {

namespace {

// The corners' classes under "joined": inside corners and outside corners alike.
class Regions {
 public:
  Regions() { std::iota(parent_.begin(), parent_.end(), 0); }

  int find(int corner) const {
    while (parent_[static_cast<std::size_t>(corner)] != corner) corner = parent_[static_cast<std::size_t>(corner)];
    return corner;
  }
  void join(int a, int b) {
    const auto [low, high] = std::minmax({find(a), find(b)});
    parent_[static_cast<std::size_t>(high)] = low;
  }

 private:
  std::array<int, 8> parent_{};
};

bool isInside(const CubeTopology& cube, int corner) { return (cube.insideCorners >> corner & 1) != 0; }

// Joins corners along edges and across faces, and notes which segment follows which cut edge.
void cutFaces(std::span<const double, 8> values, CubeTopology& cube, Regions& regions, std::array<int, 12>& next) {
  for (int edge = 0; edge < 12; ++edge) {
    const int a = lowerCorner(edge);
    const int b = upperCorner(edge);
    if (isInside(cube, a) == isInside(cube, b)) regions.join(a, b);
  }
  for (std::size_t face = 0; face < 6; ++face) {
    const auto& ring = kFaceCorners[face];
    // Going around the face, the border of the solid is entered and left at these edges in turn.
    std::array<int, 2> entered{};
    std::array<int, 2> left{};
    std::size_t pieces = 0;
    for (std::size_t s = 0; s < 4; ++s) {
      if (isInside(cube, ring[s]) || !isInside(cube, ring[(s + 1) % 4])) continue;
      std::size_t last = s + 1;
      while (isInside(cube, ring[(last + 1) % 4])) ++last;
      entered[pieces] = edgeBetween(ring[s], ring[(s + 1) % 4]);
      left[pieces] = edgeBetween(ring[last % 4], ring[(last + 1) % 4]);
      ++pieces;
    }
    if (pieces == 2) {
      cube.ambiguousFaces = static_cast<std::uint8_t>(cube.ambiguousFaces | 1U << face);
      const std::size_t first = isInside(cube, ring[0]) ? 0 : 1;
      const std::array<int, 4> c = {ring[first], ring[first + 1], ring[first + 2], ring[(first + 3) % 4]};
      if (insideJoined(values[static_cast<std::size_t>(c[0])], values[static_cast<std::size_t>(c[2])],
                       values[static_cast<std::size_t>(c[1])], values[static_cast<std::size_t>(c[3])])) {
        cube.joinedFaces = static_cast<std::uint8_t>(cube.joinedFaces | 1U << face);
        regions.join(c[0], c[2]);
        std::swap(left[0], left[1]);
      } else {
        regions.join(c[1], c[3]);
      }
    }
    for (std::size_t piece = 0; piece < pieces; ++piece) next[static_cast<std::size_t>(entered[piece])] = left[piece];
  }
}

void traceLoops(std::array<int, 12>& next, CubeTopology& cube) {
  std::uint8_t size = 0;
  for (std::size_t start = 0; start < 12; ++start) {
    if (next[start] < 0) continue;
    for (std::size_t edge = start; next[edge] >= 0;) {
      cube.loopEdges[size++] = static_cast<std::uint8_t>(edge);
      edge = static_cast<std::size_t>(std::exchange(next[edge], -1));
    }
    cube.loopOffsets[++cube.loopCount] = size;
  }
}

// Whether two corners on opposite edges of the cube along z are joined through its interior; −1, −1 if none are.
//
// In the plane at height z the function is bilinear with corner values a, b, c, d (a opposite d) that are linear in z.
// Where a and d have one sign and b and c the other, the sign of ad − bc tells which pair is joined in that plane. A
// part of {f < 0} or {f > 0} in the cube is connected through planes and along z, so all connections are known once
// this quadratic's signs are. At the ends of an interval of alternating signs they are those of the faces; in its
// interior they can differ only at the quadratic's extremum (cf. Chernyaev 1995, section 4; Custodio et al. 2013).
std::array<int, 2> joinedThroughInterior(std::span<const double, 8> v) {
  const double da = v[4] - v[0];
  const double db = v[5] - v[1];
  const double dc = v[6] - v[2];
  const double dd = v[7] - v[3];
  const double quadratic = da * dd - db * dc;
  const double linear = v[0] * dd + v[3] * da - v[1] * dc - v[2] * db;
  const double z = -linear / (2 * quadratic);
  if (!(z > 0 && z < 1)) return {-1, -1};
  const double a = v[0] + z * da;
  const double b = v[1] + z * db;
  const double c = v[2] + z * dc;
  const double d = v[3] + z * dd;
  if ((a < 0) != (d < 0) || (b < 0) != (c < 0) || (a < 0) == (b < 0)) return {-1, -1};
  // 4q·(γ − β²/4q) with γ = a₀d₀ − b₀c₀: exact for small integers, unlike ad − bc at a rounded z.
  const double discriminant = 4 * quadratic * (v[0] * v[3] - v[1] * v[2]) - linear * linear;
  const double extremum = quadratic > 0 ? discriminant : -discriminant;
  if (extremum == 0) return {-1, -1};
  const std::size_t first = extremum > 0 ? 0 : 1;
  const std::size_t second = 3 - first;
  const auto endOf = [&](std::size_t column, double value) {
    return static_cast<int>((v[column] < 0) == (value < 0) ? column : column + 4);
  };
  return {endOf(first, first == 0 ? a : b), endOf(second, first == 0 ? d : c)};
}

// The loops that get the same two regions on their sides if the regions of two corners become one: one piece of the
// surface bounds each pair of regions, for the cube is simply connected.
void joinLoops(int cornerA, int cornerB, CubeTopology& cube, Regions& regions) {
  if (regions.find(cornerA) == regions.find(cornerB)) return;
  Regions joined = regions;
  joined.join(cornerA, cornerB);
  std::array<std::array<int, 2>, 5> sides{};
  for (int l = 0; l < cube.loopCount; ++l) {
    const int edge = cube.loop(l)[0];
    const int a = joined.find(lowerCorner(edge));
    const int b = joined.find(upperCorner(edge));
    sides[static_cast<std::size_t>(l)] = {std::min(a, b), std::max(a, b)};
    for (int k = 0; k < l; ++k) {
      if (sides[static_cast<std::size_t>(k)] != sides[static_cast<std::size_t>(l)]) continue;
      cube.tunnelLoops = {static_cast<std::int8_t>(k), static_cast<std::int8_t>(l)};
      cube.tunnelInside = isInside(cube, cornerA);
      regions = joined;
      return;
    }
  }
  // Regions that are no neighbors across a third cannot be joined: only rounding on the verge of a tie says so.
}

}  // namespace

CubeTopology analyzeCube(std::span<const double, 8> values) {
  CubeTopology cube;
  for (std::size_t c = 0; c < 8; ++c) {
    if (values[c] < 0) cube.insideCorners = static_cast<std::uint8_t>(cube.insideCorners | 1U << c);
  }
  Regions regions;
  std::array<int, 12> next{};
  next.fill(-1);
  cutFaces(values, cube, regions, next);
  traceLoops(next, cube);
  if (cube.loopCount > 1) {
    const auto [a, b] = joinedThroughInterior(values);
    if (a >= 0) joinLoops(a, b, cube, regions);
  }
  for (int c = 0; c < 8; ++c) {
    if (isInside(cube, c) && regions.find(c) == c) ++cube.insideParts;
  }
  return cube;
}

int baseCase(unsigned insideCorners) {
  unsigned set = insideCorners & 0xFFU;
  if (std::popcount(set) > 4) set = ~set & 0xFFU;
  const int corners = std::popcount(set);
  const auto has = [&](int c) { return (set >> c & 1U) != 0; };
  int edges = 0;
  int degree = 0;
  for (int c = 0; c < 8; ++c) {
    if (!has(c)) continue;
    const int neighbors = static_cast<int>(has(c ^ 1)) + static_cast<int>(has(c ^ 2)) + static_cast<int>(has(c ^ 4));
    edges += neighbors;
    degree = std::max(degree, neighbors);
  }
  edges /= 2;
  switch (corners) {
    case 0:
      return 0;
    case 1:
      return 1;
    case 2: {
      if (edges == 1) return 2;
      const int low = std::countr_zero(set);
      return has(low ^ 7) ? 4 : 3;
    }
    case 3:
      return edges == 2 ? 5 : (edges == 1 ? 6 : 7);
    default:
      break;
  }
  if (edges == 4) return 8;
  if (edges == 0) return 13;
  if (edges == 2) return degree == 1 ? 10 : 12;
  if (degree == 3) return 9;
  // A path along three axes in turn; cases 11 and 14 are each other's mirror images.
  int start = 0;
  while (!has(start) ||
         static_cast<int>(has(start ^ 1)) + static_cast<int>(has(start ^ 2)) + static_cast<int>(has(start ^ 4)) != 1) {
    ++start;
  }
  std::array<int, 3> axes{};
  int from = -1;
  int at = start;
  for (int& axis : axes) {
    axis = 0;
    while (!has(at ^ 1 << axis) || (at ^ 1 << axis) == from) ++axis;
    from = at;
    at ^= 1 << axis;
  }
  // The triple product of the path's three steps.
  const bool evenAxes = (axes[0] + 1) % 3 == axes[1];
  const bool evenSteps = std::popcount(static_cast<unsigned>(start)) % 2 == 0;
  return evenAxes == evenSteps ? 11 : 14;
}

}  // namespace voroform::baselines
