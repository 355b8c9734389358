// The cut of a cube against the topology of the trilinear function itself, certified by subdivision, and closed
// surfaces on random grids.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cube_patch.hpp"
#include "cube_topology.hpp"
#include "voroform/baselines/marching_cubes.hpp"
#include "voroform/core/random.hpp"
#include "voroform/mesh/validate.hpp"

namespace voroform::baselines {
namespace {

using ::testing::ElementsAreArray;
using ::testing::IsEmpty;

using Corners = std::array<double, 8>;

class UnionFind {
 public:
  explicit UnionFind(std::size_t size) : parent_(size) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t find(std::size_t a) {
    while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
    return a;
  }
  void join(std::size_t a, std::size_t b) { parent_[std::max(find(a), find(b))] = std::min(find(a), find(b)); }

 private:
  std::vector<std::size_t> parent_;
};

double trilinear(const Corners& v, const Vec3& p) {
  double sum = 0;
  for (std::size_t c = 0; c < 8; ++c) {
    sum +=
        v[c] * ((c & 1) != 0 ? p[0] : 1 - p[0]) * ((c & 2) != 0 ? p[1] : 1 - p[1]) * ((c & 4) != 0 ? p[2] : 1 - p[2]);
  }
  return sum;
}

// What is compared.
struct Topology {
  int insideParts = 0;
  int loops = 0;                        // in which the zero set meets the cube's border
  std::int64_t euler = 0;               // of the zero set
  std::array<int, 12> edgePieces = {};  // for each cut edge the least cut edge on the same piece of the zero set, or −1

  bool operator==(const Topology&) const = default;
};

int cutEdgesOf(const Corners& v, int edge) {
  return (v[static_cast<std::size_t>(lowerCorner(edge))] < 0) != (v[static_cast<std::size_t>(upperCorner(edge))] < 0);
}

// The topology of a trilinear function's zero set in the unit cube. The cube is cut by planes into boxes until in each
// box (a) all corners have one sign, so that the function has no zero, for its bounds on a box are taken at corners, or
// (b) one partial derivative has one sign, likewise by its bounds, and no face's signs alternate. Then {f < 0} and
// {f > 0} meet each box, and each of its faces and edges, in a contractible set or not at all: in case (b) they retract
// along the axis onto a face, where a bilinear function without alternating signs leaves each sign one contractible
// part. Connections follow corners; Euler numbers from inclusion and exclusion over the boxes.
class CertifiedTopology {
 public:
  explicit CertifiedTopology(const Corners& values) : corners_(values) {
    for (auto& planes : planes_) planes = {0, 0.4718, 1};
  }

  std::optional<Topology> compute() {
    constexpr std::size_t kMostPlanes = 48;
    while (!certified()) {
      for (const auto& planes : planes_) {
        if (planes.size() > kMostPlanes) return std::nullopt;
      }
    }
    return read();
  }

 private:
  std::size_t number(std::size_t i, std::size_t j, std::size_t k) const {
    return (k * planes_[1].size() + j) * planes_[0].size() + i;
  }
  template <class Visit>
  void forEachBox(const Visit& visit) const {
    for (std::size_t k = 0; k + 1 < planes_[2].size(); ++k) {
      for (std::size_t j = 0; j + 1 < planes_[1].size(); ++j) {
        for (std::size_t i = 0; i + 1 < planes_[0].size(); ++i) visit(i, j, k);
      }
    }
  }
  std::array<std::size_t, 8> boxCorners(std::size_t i, std::size_t j, std::size_t k) const {
    std::array<std::size_t, 8> result{};
    for (std::size_t c = 0; c < 8; ++c) result[c] = number(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
    return result;
  }

  // Above the rounding of values of this size.
  static constexpr double kSure = 1e-10;

  static bool trivial(const Corners& v) {
    const bool positive = std::all_of(v.begin(), v.end(), [](double x) { return x > kSure; });
    const bool negative = std::all_of(v.begin(), v.end(), [](double x) { return x < -kSure; });
    if (positive || negative) return true;
    if (std::any_of(v.begin(), v.end(), [](double x) { return std::abs(x) <= kSure; })) return false;
    for (const auto& ring : kFaceCorners) {
      if ((v[ring[0]] < 0) == (v[ring[2]] < 0) && (v[ring[1]] < 0) == (v[ring[3]] < 0) &&
          (v[ring[0]] < 0) != (v[ring[1]] < 0)) {
        return false;
      }
    }
    for (std::size_t axis = 1; axis < 8; axis *= 2) {
      int rising = 0;
      int falling = 0;
      for (std::size_t c = 0; c < 8; ++c) {
        if ((c & axis) != 0) continue;
        rising += v[c | axis] - v[c] > kSure ? 1 : 0;
        falling += v[c | axis] - v[c] < -kSure ? 1 : 0;
      }
      if (rising == 4 || falling == 4) return true;
    }
    return false;
  }

  // Refines where a box is not trivial; true if all are.
  bool certified() {
    values_.clear();
    for (const double z : planes_[2]) {
      for (const double y : planes_[1]) {
        for (const double x : planes_[0]) values_.push_back(trilinear(corners_, {x, y, z}));
      }
    }
    std::array<std::set<double>, 3> added;
    forEachBox([&](std::size_t i, std::size_t j, std::size_t k) {
      const auto box = boxCorners(i, j, k);
      Corners v{};
      for (std::size_t c = 0; c < 8; ++c) v[c] = values_[box[c]];
      if (trivial(v)) return;
      const std::array<std::size_t, 3> place = {i, j, k};
      double longest = 0;
      for (std::size_t a = 0; a < 3; ++a) longest = std::max(longest, planes_[a][place[a] + 1] - planes_[a][place[a]]);
      for (std::size_t a = 0; a < 3; ++a) {
        const double length = planes_[a][place[a] + 1] - planes_[a][place[a]];
        if (length > 0.6 * longest) added[a].insert(planes_[a][place[a]] + 0.4836 * length);
      }
    });
    bool done = true;
    for (std::size_t a = 0; a < 3; ++a) {
      if (added[a].empty()) continue;
      done = false;
      planes_[a].insert(planes_[a].end(), added[a].begin(), added[a].end());
      std::sort(planes_[a].begin(), planes_[a].end());
    }
    return done;
  }

  // Euler number of the part of one sign: over open boxes and the faces, edges and vertices between them.
  std::int64_t euler(bool inside) const {
    const auto hasSign = [&](std::size_t vertex) { return (values_[vertex] < 0) == inside; };
    std::int64_t sum = 0;
    // An element spans an interval (twice the position plus one) or stands at an inner plane (twice it) on each axis.
    for (std::size_t k = 1; k + 2 < 2 * planes_[2].size(); ++k) {
      for (std::size_t j = 1; j + 2 < 2 * planes_[1].size(); ++j) {
        for (std::size_t i = 1; i + 2 < 2 * planes_[0].size(); ++i) {
          const bool meets = [&] {
            for (std::size_t c = 0; c < 8; ++c) {
              if (hasSign(number((i + (c & 1)) / 2, (j + (c >> 1 & 1)) / 2, (k + (c >> 2)) / 2))) return true;
            }
            return false;
          }();
          if (meets) sum += (i + j + k) % 2 == 1 ? 1 : -1;
        }
      }
    }
    return sum;
  }

  Topology read() const {
    UnionFind regions(values_.size());
    UnionFind border(values_.size());
    forEachBox([&](std::size_t i, std::size_t j, std::size_t k) {
      const auto box = boxCorners(i, j, k);
      for (const std::size_t a : box) {
        for (const std::size_t b : box) {
          if ((values_[a] < 0) == (values_[b] < 0)) regions.join(a, b);
        }
      }
      const std::array<bool, 6> onBorder = {i == 0, i + 2 == planes_[0].size(), j == 0, j + 2 == planes_[1].size(),
                                            k == 0, k + 2 == planes_[2].size()};
      for (std::size_t face = 0; face < 6; ++face) {
        if (!onBorder[face]) continue;
        for (const std::size_t a : kFaceCorners[face]) {
          for (const std::size_t b : kFaceCorners[face]) {
            if ((values_[box[a]] < 0) == (values_[box[b]] < 0)) border.join(box[a], box[b]);
          }
        }
      }
    });
    Topology result;
    int borderRegions = 0;
    for (std::size_t n = 0; n < values_.size(); ++n) {
      const std::size_t i = n % planes_[0].size();
      const std::size_t j = n / planes_[0].size() % planes_[1].size();
      const std::size_t k = n / planes_[0].size() / planes_[1].size();
      const bool inner = i > 0 && i + 1 < planes_[0].size() && j > 0 && j + 1 < planes_[1].size() && k > 0 &&
                         k + 1 < planes_[2].size();
      if (!inner && border.find(n) == n) ++borderRegions;
      if (values_[n] < 0 && regions.find(n) == n) ++result.insideParts;
    }
    // On a sphere, loops are one less than the regions they separate.
    result.loops = borderRegions - 1;
    result.euler = euler(true) + euler(false) - 1;
    // In a cube, a piece of the zero set separates a pair of regions that no other piece separates.
    const auto regionOf = [&](int corner) {
      return regions.find(number((corner & 1) != 0 ? planes_[0].size() - 1 : 0,
                                 (corner & 2) != 0 ? planes_[1].size() - 1 : 0,
                                 (corner & 4) != 0 ? planes_[2].size() - 1 : 0));
    };
    std::map<std::pair<std::size_t, std::size_t>, int> pieces;
    for (int edge = 0; edge < 12; ++edge) {
      result.edgePieces[static_cast<std::size_t>(edge)] = -1;
      if (cutEdgesOf(corners_, edge) == 0) continue;
      const auto sides = std::minmax({regionOf(lowerCorner(edge)), regionOf(upperCorner(edge))});
      result.edgePieces[static_cast<std::size_t>(edge)] =
          pieces.try_emplace({sides.first, sides.second}, edge).first->second;
    }
    return result;
  }

  Corners corners_;
  std::array<std::vector<double>, 3> planes_;
  std::vector<double> values_;
};

// The same of the triangles that the baseline puts into a cube.
Topology topologyOf(const CubeTopology& cube, const CubePatch& patch) {
  Topology result;
  result.insideParts = cube.insideParts;
  UnionFind pieces(12 + patch.interior.size());
  std::set<std::pair<int, int>> edges;
  std::set<int> vertices;
  std::map<int, int> next;  // along the border
  for (const auto& t : patch.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      pieces.join(t[i], t[(i + 1) % 3]);
      vertices.insert(t[i]);
      EXPECT_TRUE(edges.insert({t[i], t[(i + 1) % 3]}).second) << "two triangles run alike through an edge";
    }
  }
  std::int64_t undirected = 0;
  for (const auto& [a, b] : edges) {
    const bool paired = edges.count({b, a}) != 0;
    undirected += !paired || a < b ? 1 : 0;
    if (!paired) next[a] = b;
  }
  result.euler =
      static_cast<std::int64_t>(vertices.size()) - undirected + static_cast<std::int64_t>(patch.triangles.size());
  while (!next.empty()) {
    ++result.loops;
    for (auto entry = next.begin(); entry != next.end();) {
      const int to = entry->second;
      next.erase(entry);
      entry = next.find(to);
    }
  }
  result.edgePieces.fill(-1);
  for (const std::uint8_t edge : cube.loopEdges) {
    if (vertices.count(edge) == 0) continue;
    for (int other = 0; other < 12; ++other) {
      if (vertices.count(other) != 0 && pieces.find(static_cast<std::size_t>(other)) == pieces.find(edge)) {
        result.edgePieces[edge] = other;
        break;
      }
    }
  }
  return result;
}

// Chernyaev's name of the case (1995, table 1; 12.2 and 12.3 mirror each other, as do 11 and 14).
std::string caseName(const CubeTopology& cube) {
  const int base = baseCase(cube.insideCorners);
  const int corners = std::popcount(cube.insideCorners);
  const int ambiguous = std::popcount(cube.ambiguousFaces);
  int joined = std::popcount(cube.joinedFaces);
  // Joined from the side of the fewer corners.
  if (corners > 4) joined = ambiguous - joined;
  const std::string name = std::to_string(base);
  const std::string ending = cube.hasTunnel() ? ".2" : ".1";
  switch (base) {
    case 3:
      return name + (joined == 1 ? ".2" : ".1");
    case 4:
      return name + ending;
    case 6:
      return joined == 1 ? name + ".2" : name + ".1" + ending;
    case 7:
      return name + "." + std::to_string(joined + 1) + (joined == 3 ? ending : "");
    case 10:
      return joined == 1 ? name + ".2" : name + ".1" + ending;
    case 12: {
      if (joined != 1) return name + ".1" + ending;
      const int first = std::countr_zero(cube.ambiguousFaces) / 2;
      const int second = (std::bit_width(cube.ambiguousFaces) - 1) / 2;
      const bool firstJoined = (cube.joinedFaces & 1U << std::countr_zero(cube.ambiguousFaces)) != 0;
      // Orientation of the two faces' axes and the one left, at the corner where the faces meet the third.
      int common = 0;
      for (int c = 0; c < 8; ++c) {
        const unsigned faces = 1U << (c & 1) | 1U << (2 + (c >> 1 & 1)) | 1U << (4 + (c >> 2));
        const bool isolated = ((cube.insideCorners >> c ^ cube.insideCorners >> (c ^ 1)) & 1) != 0 &&
                              ((cube.insideCorners >> c ^ cube.insideCorners >> (c ^ 2)) & 1) != 0 &&
                              ((cube.insideCorners >> c ^ cube.insideCorners >> (c ^ 4)) & 1) != 0;
        if (isolated && (cube.insideCorners >> c & 1) != 0 && (faces & cube.ambiguousFaces) == cube.ambiguousFaces) {
          common = c;
        }
      }
      const bool even = (first + 1) % 3 == second;
      const bool evenCorner = std::popcount(static_cast<unsigned>(common)) % 2 == 0;
      return name + ((even == evenCorner) == firstJoined ? ".2" : ".3");
    }
    case 13: {
      joined = std::min(joined, 6 - joined);
      if (joined < 3) return name + "." + std::to_string(joined + 1);
      return cube.loopCount == 1 ? name + ".4" : name + ".5" + ending;
    }
    default:
      return name;
  }
}

Corners randomCorners(std::uint64_t seed, std::uint64_t index, int range) {
  Corners values{};
  for (std::size_t c = 0; c < 8; ++c) {
    const double unit = randomUnit(seed, RandomStream::test, 8 * index + c);
    const int value = static_cast<int>(unit * 2 * range) - range;  // −range … range − 1
    values[c] = value >= 0 ? value + 1 : value;
  }
  return values;
}

// Imposes a set of inside corners.
Corners withSigns(Corners values, unsigned inside) {
  for (std::size_t c = 0; c < 8; ++c) values[c] = (inside >> c & 1U) != 0 ? -std::abs(values[c]) : std::abs(values[c]);
  return values;
}

struct Comparison {
  int compared = 0;
  int rejected = 0;
  std::set<std::string> cases;
};

void compare(const Corners& values, Comparison& comparison) {
  const std::optional<Topology> expected = CertifiedTopology(values).compute();
  if (!expected) {
    ++comparison.rejected;
    return;
  }
  ++comparison.compared;
  const CubeTopology cube = analyzeCube(values);
  std::array<double, 12> parameters{};
  for (int edge = 0; edge < 12; ++edge) {
    const double a = values[static_cast<std::size_t>(lowerCorner(edge))];
    const double b = values[static_cast<std::size_t>(upperCorner(edge))];
    parameters[static_cast<std::size_t>(edge)] = a / (a - b);
  }
  CubePatch patch;
  triangulateCut(cube, parameters, patch);
  const Topology found = topologyOf(cube, patch);
  const std::string name = caseName(cube);
  comparison.cases.insert(name);
  SCOPED_TRACE("case " + name + ", corners " + ::testing::PrintToString(values));
  EXPECT_EQ(found.insideParts, expected->insideParts);
  EXPECT_EQ(found.loops, expected->loops);
  EXPECT_EQ(found.euler, expected->euler);
  EXPECT_EQ(found.edgePieces, expected->edgePieces);
}

// Small integers make ties on faces, which have no topology of their own to compare with: at this range they are few.
constexpr int kRange = 60;

TEST(CubeTopology, IsThatOfTheTrilinearFunction) {
  Comparison comparison;
  constexpr int kUniform = 10000;
  for (std::uint64_t n = 0; n < kUniform && !HasFailure(); ++n) compare(randomCorners(1, n, kRange), comparison);
  EXPECT_LE(comparison.rejected, kUniform / 100);
  EXPECT_GE(comparison.compared, kUniform * 99 / 100);
}

TEST(CubeTopology, IsThatOfTheTrilinearFunctionInAllOfChernyaevsCases) {
  Comparison comparison;
  int tried = 0;
  for (unsigned signs = 0; signs < 256 && !HasFailure(); ++signs) {
    // More of those whose cases are many.
    const int base = baseCase(signs);
    const int repetitions =
        base == 13 ? 1500 : (base == 4 || base == 6 || base == 7 || base == 10 || base == 12 ? 30 : 2);
    for (int n = 0; n < repetitions; ++n, ++tried) {
      const auto index = static_cast<std::uint64_t>(tried);
      compare(withSigns(randomCorners(2, index, kRange), signs), comparison);
    }
  }
  EXPECT_LE(comparison.rejected, tried / 100);
  EXPECT_THAT(comparison.cases,
              ElementsAreArray(std::set<std::string>{
                  "0",      "1",      "2",    "3.1",   "3.2",   "4.1",  "4.2",  "5",      "6.1.1",  "6.1.2",  "6.2",
                  "7.1",    "7.2",    "7.3",  "7.4.1", "7.4.2", "8",    "9",    "10.1.1", "10.1.2", "10.2",   "11",
                  "12.1.1", "12.1.2", "12.2", "12.3",  "13.1",  "13.2", "13.3", "13.4",   "13.5.1", "13.5.2", "14"}));
}

TEST(CubeTopology, KeepsItsCaseUnderTheSymmetriesOfTheCube) {
  for (unsigned signs = 0; signs < 256; ++signs) {
    EXPECT_EQ(baseCase(~signs & 0xFFU), baseCase(signs));
    unsigned turned = 0;   // about the axis (1, 1, 1)
    unsigned quarter = 0;  // about z
    unsigned mirrored = 0;
    for (unsigned c = 0; c < 8; ++c) {
      if ((signs >> c & 1U) == 0) continue;
      const unsigned x = c & 1U;
      const unsigned y = c >> 1 & 1U;
      const unsigned z = c >> 2;
      turned |= 1U << (z | x << 1 | y << 2);
      quarter |= 1U << ((1 - y) | x << 1 | z << 2);
      mirrored |= 1U << ((1 - x) | y << 1 | z << 2);
    }
    EXPECT_EQ(baseCase(turned), baseCase(signs));
    EXPECT_EQ(baseCase(quarter), baseCase(signs));
    const int base = baseCase(signs);
    EXPECT_EQ(baseCase(mirrored), base == 11 ? 14 : (base == 14 ? 11 : base));
  }
}

// Six decisions that no trilinear function takes, but that rounding may: corners 0 and 3 joined on z = 0, 5 and 6 on
// z = 1, and nothing else.
TEST(CubePatch, KeepsTwoHexagonsApartWhereverTheirVerticesLie) {
  CubeTopology cube;
  cube.insideCorners = 1U << 0 | 1U << 3 | 1U << 5 | 1U << 6;
  cube.ambiguousFaces = 0x3F;
  cube.joinedFaces = 0x30;
  constexpr std::array<std::array<int, 2>, 12> kLoops = {
      {{0, 4}, {0, 2}, {3, 2}, {3, 7}, {3, 1}, {0, 1}, {5, 1}, {5, 4}, {6, 4}, {6, 2}, {6, 7}, {5, 7}}};
  for (std::size_t n = 0; n < 12; ++n) {
    cube.loopEdges[n] = static_cast<std::uint8_t>(edgeBetween(kLoops[n][0], kLoops[n][1]));
  }
  cube.loopCount = 2;
  cube.loopOffsets = {0, 6, 12};
  CubePatch patch;
  for (std::uint64_t sample = 0; sample < 300; ++sample) {
    std::array<double, 12> parameters{};
    for (std::size_t edge = 0; edge < 12; ++edge) {
      const double u = randomUnit(3, RandomStream::test, 12 * sample + edge);
      parameters[edge] = u < 0.2 ? 1e-6 : (u > 0.8 ? 1 - 1e-6 : u);
    }
    triangulateCut(cube, parameters, patch);
    mesh::PolyhedralComplex surface;
    for (int edge = 0; edge < 12; ++edge) {
      surface.vertices.push_back(pointOnEdge(edge, parameters[static_cast<std::size_t>(edge)]));
    }
    surface.vertices.insert(surface.vertices.end(), patch.interior.begin(), patch.interior.end());
    surface.cellCount = 1;
    for (const auto& t : patch.triangles) surface.addFace(std::array<Index, 3>{t[0], t[1], t[2]}, 0, kNone);
    mesh::ValidateOptions options;
    options.pointSamples = 0;
    ASSERT_EQ(mesh::validate(surface, options, {}).selfIntersections, 0) << "sample " << sample;
  }
}

// Random integers at the corners of 8³ cubes with a layer of outside corners around them. Between corners the function
// is linear along the grid's edges, or its root is at a random place of the edge: topology comes from the corners only.
class RandomGrid final : public implicit::ImplicitFunction {
 public:
  static constexpr int kCorners = 9;  // along an axis, without the layer

  struct Kind {
    bool moveRoots = false;
    bool checkered = false;  // signs alternate along every axis
  };

  RandomGrid(std::uint64_t seed, int range, const Kind& kind) : seed_(seed), range_(range), kind_(kind) {}

  double value(const Vec3& p) const override {
    Eigen::Array3d low = p.array().floor();
    const Eigen::Array3d t = p.array() - low;
    const int fractional = static_cast<int>((t != 0).count());
    if (kind_.moveRoots && fractional == 1) {
      const auto axis = static_cast<Eigen::Index>((t != 0).select(Eigen::Array3d(0, 1, 2), 0).sum());
      Eigen::Array3d high = low;
      high[axis] += 1;
      const double a = atCorner(low);
      const double b = atCorner(high);
      if ((a < 0) != (b < 0)) {
        const double root = rootOf(low, axis);
        return t[axis] < root ? a * (1 - t[axis] / root) : b * (t[axis] - root) / (1 - root);
      }
    }
    Corners v{};
    for (int c = 0; c < 8; ++c) {
      v[static_cast<std::size_t>(c)] = atCorner(low + Eigen::Array3d(c & 1, c >> 1 & 1, c >> 2));
    }
    return trilinear(v, t.matrix());
  }
  Vec3 gradient(const Vec3&) const override { return Vec3::UnitX(); }
  Box3 bounds() const override { return {Vec3::Zero(), Vec3::Constant(kCorners + 1)}; }

  CubeGrid grid() const { return {Vec3::Zero(), 1, {kCorners + 1, kCorners + 1, kCorners + 1}}; }

 private:
  static std::uint64_t number(const Eigen::Array3d& p) {
    return static_cast<std::uint64_t>((p[2] * 16 + p[1]) * 16 + p[0]);
  }
  double atCorner(const Eigen::Array3d& p) const {
    if ((p < 1).any() || (p > kCorners).any()) return range_;
    int value = static_cast<int>(randomUnit(seed_, RandomStream::test, number(p)) * 2 * range_) - range_;
    if (value >= 0) ++value;
    if (!kind_.checkered) return value;
    return static_cast<int>(p.sum()) % 2 == 0 ? std::abs(value) : -std::abs(value);
  }
  // A third of them at the very ends.
  double rootOf(const Eigen::Array3d& p, Eigen::Index axis) const {
    const double u = randomUnit(seed_, RandomStream::test, 100000 + 3 * number(p) + static_cast<std::uint64_t>(axis));
    return u < 0.17 ? 1e-9 : (u > 0.83 ? 1 - 1e-9 : u);
  }

  std::uint64_t seed_;
  int range_;
  Kind kind_;
};

struct GridTotals {
  Index tunnels = 0;
  Index disconnected = 0;
  Index cut = 0;
};

void expectValid(const RandomGrid& f, GridTotals& totals) {
  const MarchingCubesResult result = marchingCubes(f, {}, f.grid(), {}, {});
  mesh::ValidateOptions options;
  options.pointSamples = 1000;
  const mesh::Certificate certificate = mesh::validate(result.complex, options, {});
  EXPECT_THAT(certificate.problems, IsEmpty());
  EXPECT_TRUE(certificate.valid);
  EXPECT_EQ(certificate.selfIntersections, 0);
  totals.tunnels += result.summary.tunnelledCells;
  totals.disconnected += result.summary.disconnectedCells;
  totals.cut += result.summary.cutCells;
}

class RandomGrids : public ::testing::TestWithParam<bool> {};

TEST_P(RandomGrids, GiveClosedManifoldSurfaces) {
  GridTotals totals;
  for (std::uint64_t seed = 0; seed < 24 && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    // A small range makes ties.
    expectValid(RandomGrid(seed, seed % 2 == 0 ? 2 : 50, {.moveRoots = GetParam(), .checkered = false}), totals);
  }
  EXPECT_GT(totals.cut, 20000);
  EXPECT_GT(totals.disconnected, 2000);
  EXPECT_GT(totals.tunnels, 100);
}

// Case 13 in every cube but those at the border: up to four pieces of the surface in one.
TEST_P(RandomGrids, GiveClosedManifoldSurfacesIfEveryFaceIsAmbiguous) {
  GridTotals totals;
  for (std::uint64_t seed = 0; seed < 12 && !HasFailure(); ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    expectValid(RandomGrid(seed, seed % 4 == 0 ? 3 : 50, {.moveRoots = GetParam(), .checkered = true}), totals);
  }
  EXPECT_GE(totals.cut, 12 * 512);
  EXPECT_GT(totals.tunnels, 20);
}

INSTANTIATE_TEST_SUITE_P(RootsMoved, RandomGrids, ::testing::Bool());

}  // namespace
}  // namespace voroform::baselines
