// How one level's sites become the next one's: by midpoints, insertion and removal.
#include "subdivision.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <set>
#include <span>
#include <vector>

#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/planar_domain.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::cvt {
namespace {

// The integer coordinates of a point within rounding of the lattice that the columns of `basis` span around `origin`.
template <int M>
std::array<long, M> latticeCoordinates(const Vec<M>& p, const Eigen::Matrix<double, M, M>& basis,
                                       const Vec<M>& origin) {
  const Vec<M> coordinates = basis.inverse() * (p - origin);
  std::array<long, M> result;
  for (Index i = 0; i < M; ++i) {
    result[static_cast<std::size_t>(i)] = std::lround(coordinates[i]);
    EXPECT_NEAR(coordinates[i], static_cast<double>(result[static_cast<std::size_t>(i)]), 1e-9);
  }
  return result;
}

template <int M>
std::vector<Vec<M>> latticePoints(const Eigen::Matrix<double, M, M>& basis, const Vec<M>& origin, double halfEdge,
                                  long range) {
  std::vector<Vec<M>> result;
  for (long i = -range; i <= range; ++i) {
    for (long j = -range; j <= range; ++j) {
      for (long k = M == 3 ? -range : 0; k <= (M == 3 ? range : 0); ++k) {
        Vec<M> coordinates;
        coordinates[0] = static_cast<double>(i);
        coordinates[1] = static_cast<double>(j);
        if constexpr (M == 3) coordinates[2] = static_cast<double>(k);
        const Vec<M> p = origin + basis * coordinates;
        if (p.cwiseAbs().maxCoeff() < halfEdge) result.push_back(p);
      }
    }
  }
  return result;
}

// The lattice in a cube or square of edge 4, subdivided, is the lattice half as wide, farther than 1 from the boundary.
template <int M>
void expectHalvedLattice(const Domain<M>& domain, const Eigen::Matrix<double, M, M>& basis) {
  const Vec<M> origin = 0.013 * Vec<M>::LinSpaced(1, 2);
  const std::vector<Vec<M>> sites = latticePoints<M>(basis, origin, 2, 20);
  const std::vector<Vec<M>> fine = subdivide<M>(domain, sites, domain.graph(sites, {}), {});
  std::set<std::array<long, M>> found;
  std::size_t inner = 0;
  for (const Vec<M>& p : fine) {
    if (p.cwiseAbs().maxCoeff() > 1) continue;
    ++inner;
    found.insert(latticeCoordinates<M>(p, 0.5 * basis, origin));
  }
  EXPECT_EQ(found.size(), inner) << "two sites at one place";
  EXPECT_EQ(inner, latticePoints<M>(0.5 * basis, origin, 1, 40).size());
  EXPECT_GT(inner, 200U);
}

TEST(Subdivision, HalvesTheHexagonalLattice) {
  const mesh::PlanarRegion region(std::array{std::vector<Vec2>{{-2, -2}, {2, -2}, {2, 2}, {-2, 2}}});
  Eigen::Matrix2d basis;
  basis << 0.2, 0.1, 0, 0.1 * std::numbers::sqrt3;
  expectHalvedLattice<2>(PlanarDomain(region), basis);
}

TEST(Subdivision, HalvesTheBodyCenteredCubicLattice) {
  const auto form = implicit::box(Vec3(4, 4, 4));
  Eigen::Matrix3d basis;
  basis << -0.2, 0.2, 0.2, 0.2, -0.2, 0.2, 0.2, 0.2, -0.2;
  expectHalvedLattice<3>(ImplicitDomain(*form), basis);
}

TEST(Subdivision, LeavesOutWhatLiesOutside) {
  // Around the notch of an L the midpoint of two neighbors lies outside.
  const mesh::PlanarRegion region(std::array{std::vector<Vec2>{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}});
  const PlanarDomain domain(region);
  const std::vector<Vec2> sites = {{0.5, 0.4}, {1.9, 0.9}, {0.9, 1.9}};
  const SiteGraph graph{{{0, 1}, {0, 2}, {1, 2}}, {1, 1, 1}};
  const auto fine = subdivide<2>(domain, sites, graph, {});
  ASSERT_EQ(fine.size(), 5U);
  EXPECT_EQ(fine[3], Vec2(1.2, 0.65));
  EXPECT_EQ(fine[4], Vec2(0.7, 1.15));
}

template <int M>
std::size_t nearest(const std::vector<Vec<M>>& sites, const Vec<M>& p) {
  return static_cast<std::size_t>(
      std::min_element(sites.begin(), sites.end(),
                       [&](const Vec<M>& a, const Vec<M>& b) { return (a - p).norm() < (b - p).norm(); }) -
      sites.begin());
}

// The sites whose cells took one, each once.
template <int M>
std::set<std::size_t> hosts(const Domain<M>& domain, const std::vector<Vec<M>>& sites, Index count,
                            Placement placement) {
  std::vector<Vec<M>> more = sites;
  insertSites<M>(domain, more, count, placement, 1, 5, {});
  EXPECT_EQ(more.size(), sites.size() + static_cast<std::size_t>(count));
  std::set<std::size_t> result;
  for (std::size_t i = 0; i < more.size(); ++i) {
    EXPECT_TRUE(domain.contains(more[i]));
    if (i < sites.size()) {
      EXPECT_EQ(more[i], sites[i]);
    } else {
      EXPECT_TRUE(result.insert(nearest<M>(sites, more[i])).second) << "two sites in one cell";
    }
  }
  return result;
}

TEST(InsertSites, FillsBoundaryCellsWithOneEach) {
  const auto form = implicit::torus(1, 0.4);
  const ImplicitDomain domain(*form);
  const auto sites = randomSites<3>(domain, 600, 1, {});
  const SiteGraph graph = domain.graph(sites, {});
  const auto boundary = std::count(graph.onBoundary.begin(), graph.onBoundary.end(), 1);
  ASSERT_LT(boundary, 560);
  for (const std::size_t host : hosts<3>(domain, sites, 200, Placement::boundaryAtRandom)) {
    EXPECT_EQ(graph.onBoundary[host], 1);
  }
  // Where those do not suffice, others follow.
  Index onBoundary = 0;
  for (const std::size_t host :
       hosts<3>(domain, sites, static_cast<Index>(boundary) + 20, Placement::boundaryAtRandom)) {
    onBoundary += graph.onBoundary[host];
  }
  EXPECT_GE(onBoundary, boundary - 3) << "but for cells too thin to be hit";
}

TEST(InsertSites, FillsTheLargestCellsThatAreNoNeighbors) {
  const mesh::PlanarRegion star = mesh::starRegion();
  const PlanarDomain domain(star);
  const auto sites = randomSites<2>(domain, 400, 2, {});
  const auto taken = hosts<2>(domain, sites, 30, Placement::largestFirst);
  for (const auto& [a, b] : domain.graph(sites, {}).edges) {
    EXPECT_FALSE(taken.contains(static_cast<std::size_t>(a)) && taken.contains(static_cast<std::size_t>(b)));
  }
  const auto moments = domain.evaluate(sites, {}).moments;
  const double mean = domain.volume() / 400;
  for (const std::size_t host : taken) EXPECT_GT(moments[host].mass, mean);
}

TEST(InsertSites, GoesOnInRounds) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const PlanarDomain domain(square);
  for (const Placement placement : {Placement::boundaryAtRandom, Placement::largestFirst}) {
    std::vector<Vec2> sites = {{1, 2}};
    insertSites<2>(domain, sites, 99, placement, 1, 1, {});
    ASSERT_EQ(sites.size(), 100U);
    std::vector<Vec2> none;
    insertSites<2>(domain, none, 7, placement, 1, 1, {});
    EXPECT_EQ(none.size(), 7U);
  }
}

// Sites without neighbors: a point inserted for one of them is the site plus a random vector from a cube, whatever the
// other sites. Everything lies inside.
class Unbounded final : public Domain<2> {
 public:
  Box2 bounds() const override { return {Vec2(-1, -1), Vec2(1, 1)}; }
  Box2 siteBox() const override { return bounds(); }
  bool contains(const Vec2& /*p*/) const override { return true; }
  double volume() const override { return 4; }
  Evaluation<2> evaluate(std::span<const Vec2> /*sites*/, const RunContext& /*context*/) const override { return {}; }
  SiteGraph graph(std::span<const Vec2> sites, const RunContext& /*context*/) const override {
    return {{}, std::vector<std::uint8_t>(sites.size(), 0)};
  }
};

TEST(InsertSites, PointsDifferBetweenLevelsRoundsAndSites) {
  constexpr int kLevels = 10;
  // Differences of the sites after three rounds, the vectors from each site to those inserted for it among them.
  std::vector<Vec2> vectors;
  for (int level = 1; level <= kLevels; ++level) {
    std::vector<Vec2> sites = {Vec2::Zero()};
    insertSites<2>(Unbounded(), sites, 7, Placement::boundaryAtRandom, level, 3, {});
    ASSERT_EQ(sites.size(), 8U);
    for (std::size_t i = 0; i < sites.size(); ++i) {
      for (std::size_t j = i + 1; j < sites.size(); ++j) vectors.push_back(sites[j] - sites[i]);
    }
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, (vectors[i] - vectors[j]).norm());
  }
  // Of 280 vectors anywhere in a square of edge 6 two are closer than this with a probability of 1e-5.
  EXPECT_GT(least, 1e-4);
}

TEST(RemoveSites, RemovesTheSmallestCells) {
  const mesh::PlanarRegion star = mesh::starRegion();
  const PlanarDomain domain(star);
  const auto sites = randomSites<2>(domain, 400, 2, {});
  const auto moments = domain.evaluate(sites, {}).moments;
  std::vector<Vec2> left = sites;
  removeSites<2>(domain, left, 20, {});
  ASSERT_EQ(left.size(), 380U);
  std::size_t next = 0;
  std::set<Index> removed;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (next < left.size() && left[next] == sites[i]) {
      ++next;
    } else {
      removed.insert(static_cast<Index>(i));
      EXPECT_LT(moments[i].mass, 0.5 * domain.volume() / 400);
    }
  }
  for (const auto& [a, b] : domain.graph(sites, {}).edges) {
    EXPECT_FALSE(removed.contains(a) && removed.contains(b)) << "neighbors";
  }
  EXPECT_EQ(next, left.size()) << "the order is kept";
  removeSites<2>(domain, left, 379, {});
  EXPECT_EQ(left.size(), 1U);
}

}  // namespace
}  // namespace voroform::cvt
