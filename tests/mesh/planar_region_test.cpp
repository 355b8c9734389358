// Regions of the plane: geometry against brute force, faults, files.
#include "voroform/mesh/planar_region.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

#include "file_support.hpp"
#include "support/planar.hpp"
#include "voroform/core/error.hpp"

namespace voroform::mesh {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Rings;
using testing::TemporaryFolder;

constexpr double kRounding = 1e-12;

std::vector<Vec2> squareRing(double half, const Vec2& center = Vec2(0, 0)) {
  return {center + Vec2(-half, -half), center + Vec2(half, -half), center + Vec2(half, half),
          center + Vec2(-half, half)};
}

// By the angle that each ring turns about the point.
bool windsAround(const Rings& rings, const Vec2& p) {
  bool inside = false;
  for (const auto& ring : rings) {
    double angle = 0;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const Vec2 a = ring[k] - p;
      const Vec2 b = ring[(k + 1) % ring.size()] - p;
      angle += std::atan2(testing::cross(a, b), a.dot(b));
    }
    if (std::abs(angle) > 3) inside = !inside;
  }
  return inside;
}

double distanceToSegment(const Vec2& p, const Vec2& a, const Vec2& b) {
  const double along = (p - a).dot(b - a);
  if (along <= 0) return (p - a).norm();
  if (along >= (b - a).squaredNorm()) return (p - b).norm();
  return std::abs(testing::cross(p - a, b - a)) / (b - a).norm();
}

TEST(PlanarRegion, NamedRegionsHaveTheirAreas) {
  const PlanarRegion square = namedRegion("square");
  EXPECT_EQ(square.area(), 400);
  EXPECT_EQ(square.bounds().min(), Vec2(-10, -10));
  EXPECT_EQ(square.bounds().max(), Vec2(10, 10));

  const PlanarRegion star = namedRegion("star");
  ASSERT_EQ(star.points().size(), 10U);
  EXPECT_NEAR(star.area(), 117.6, 117.6 * kRounding);
  EXPECT_NEAR(star.points()[0].norm(), 10.235, 5e-4);
  // In a pentagram the edges of neighboring branches lie on one line.
  EXPECT_NEAR(testing::cross(star.points()[1] - star.points()[0], star.points()[4] - star.points()[0]), 0, 1e-12);

  const PlanarRegion disc = namedRegion("disc");
  EXPECT_NEAR(disc.area(), std::numbers::pi, std::numbers::pi * kRounding);
  EXPECT_NEAR(disc.points()[0].norm(), 1, 1e-5);

  EXPECT_EQ(namedRegion("square").area(), squareRegion().area());
  EXPECT_EQ(namedRegion("star").area(), starRegion().area());
  EXPECT_EQ(namedRegion("disc").area(), discRegion().area());
  try {
    namedRegion("heart");
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_STREQ(error.what(), "unknown planar region 'heart'; the regions are square, star, disc");
  }
}

TEST(PlanarRegion, TurnsRingsSoThatTheInteriorLiesOnTheLeft) {
  // Outline, hole, island in the hole; each in both directions.
  for (int directions = 0; directions < 8; ++directions) {
    Rings rings = {squareRing(3), squareRing(2), squareRing(1)};
    for (std::size_t r = 0; r < 3; ++r) {
      if (directions & (1 << r)) std::reverse(rings[r].begin(), rings[r].end());
    }
    const PlanarRegion region(rings);
    EXPECT_EQ(region.area(), 36 - 16 + 4);
    ASSERT_EQ(region.ringCount(), 3U);
    EXPECT_EQ(region.holeCount(), 1U);
    for (std::size_t r = 0; r < 3; ++r) {
      EXPECT_EQ(region.isHole(r), r == 1);
      const std::vector<Vec2> ring(region.ring(r).begin(), region.ring(r).end());
      EXPECT_EQ(testing::signedArea(ring) > 0, r != 1);
    }
    EXPECT_TRUE(region.contains({2.5, 0}));
    EXPECT_FALSE(region.contains({1.5, 0}));
    EXPECT_TRUE(region.contains({0.5, 0}));
  }
}

TEST(PlanarRegion, ContainsAndSignedDistanceAgreeWithBruteForce) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const Rings rings = testing::jaggedRings(seed);
    const PlanarRegion region(rings);
    double area = 0;
    for (std::size_t r = 0; r < rings.size(); ++r) {
      area += (region.isHole(r) ? -1 : 1) * std::abs(testing::signedArea(rings[r]));
    }
    EXPECT_NEAR(region.area(), area, area * kRounding);
    for (const Vec2& p : testing::sitesInBox(200, seed + 100, Box2(Vec2(-8, -8), Vec2(8, 8)))) {
      double distance = std::numeric_limits<double>::infinity();
      for (const auto& ring : rings) {
        for (std::size_t k = 0; k < ring.size(); ++k) {
          distance = std::min(distance, distanceToSegment(p, ring[k], ring[(k + 1) % ring.size()]));
        }
      }
      const bool inside = windsAround(rings, p);
      EXPECT_EQ(region.contains(p), inside) << seed << " " << p.transpose();
      EXPECT_NEAR(region.signedDistance(p), inside ? -distance : distance, 1e-12);
    }
  }
}

TEST(PlanarRegion, CountsItsBoundaryAsOutside) {
  const PlanarRegion region(Rings{{{0, 0}, {4, 0}, {4, 2}, {2, 1}, {0, 2}}});
  for (std::size_t k = 0; k < region.points().size(); ++k) {
    const Vec2& a = region.points()[k];
    const Vec2& b = region.points()[static_cast<std::size_t>(region.next(k))];
    EXPECT_FALSE(region.contains(a));
    EXPECT_FALSE(region.contains(0.5 * (a + b)));  // exact for these coordinates
    EXPECT_EQ(region.signedDistance(a), 0);
  }
  // One ulp beside the slanted edge, and on the rays through corners.
  const double half = 0.5;
  EXPECT_TRUE(region.contains({1, std::nextafter(1.5, 0)}));
  EXPECT_FALSE(region.contains({1, std::nextafter(1.5, 2)}));
  EXPECT_TRUE(region.contains({half, 1}));
  EXPECT_FALSE(region.contains({-half, 1}));
  EXPECT_FALSE(region.contains({-half, 2}));
  EXPECT_FALSE(region.contains({-half, 0}));
  EXPECT_FALSE(region.contains({std::numeric_limits<double>::quiet_NaN(), 1}));
  // Rays through corners where the boundary goes on upwards.
  const PlanarRegion hexagon(Rings{{{0, 0}, {4, 0}, {5, 1}, {4, 2}, {0, 2}, {-1, 1}}});
  EXPECT_TRUE(hexagon.contains({0, 1}));
  EXPECT_FALSE(hexagon.contains({-2, 1}));
  EXPECT_FALSE(hexagon.contains({6, 1}));
}

struct FaultCase {
  Rings rings;
  std::string text;
};

TEST(PlanarRegion, NamesThePlaceOfEachFault) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const std::string meets = "the edge that begins here crosses or touches the edge that begins at ";
  const std::vector<FaultCase> cases = {
      {{}, "ring 1, point 1: a region needs at least one ring of points"},
      {{squareRing(1), {{5, 5}, {6, 6}}}, "ring 2, point 1: expected a ring of 3 or more points, found 2"},
      {{squareRing(1), {}}, "ring 2, point 1: expected a ring of 3 or more points, found 0"},
      {{{{0, 0}, {1, nan}, {1, 1}}}, "ring 1, point 2: a coordinate is not a finite number"},
      {{{{0, 0}, {1, 0}, {inf, 1}}}, "ring 1, point 3: a coordinate is not a finite number"},
      {{{{0, 0}, {1, 0}, {1, 0}, {1, 1}}}, "ring 1, point 2: the point equals the next one of its ring"},
      {{{{0, 0}, {1, 0}, {1, 1}, {0, 0}}}, "ring 1, point 4: the point equals the next one of its ring"},
      // A bow tie.
      {{{{0, 0}, {1, 1}, {1, 0}, {0, 1}}}, "ring 1, point 1: " + meets + "ring 1, point 3"},
      // An edge back along the one before, at every place of the ring.
      {{{{0, 0}, {2, 0}, {1, 0}, {1, 1}}}, "ring 1, point 1: " + meets + "ring 1, point 2"},
      {{{{1, 0}, {1, 1}, {0, 0}, {2, 0}}}, "ring 1, point 1: " + meets + "ring 1, point 3"},
      {{{{2, 0}, {1, 0}, {1, 1}, {0, 0}}}, "ring 1, point 1: " + meets + "ring 1, point 4"},
      {{{{0, 0}, {1, 0}, {2, 0}}}, "ring 1, point 1: " + meets + "ring 1, point 3"},
      // A corner on another edge of the ring, and a corner visited twice.
      {{{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}}, "ring 1, point 1: " + meets + "ring 1, point 3"},
      // Rings that cross, share a corner, are the same.
      {{squareRing(1), squareRing(1, {1, 1})}, "ring 1, point 2: " + meets + "ring 2, point 1"},
      {{squareRing(1), squareRing(1, {2, 2})}, "ring 1, point 2: " + meets + "ring 2, point 1"},
      {{squareRing(3), squareRing(1), squareRing(1)}, "ring 2, point 1: " + meets + "ring 3, point 1"},
      {{squareRing(1e200)}, "ring 1, point 1: double precision does not hold the region's area; scale the coordinates"},
  };
  for (const FaultCase& faulty : cases) {
    try {
      const PlanarRegion region(faulty.rings);
      ADD_FAILURE() << "accepted: " << faulty.text;
    } catch (const InvalidRegion& error) {
      EXPECT_EQ(error.what(), faulty.text);
    }
  }
  EXPECT_FALSE(findFault(testing::jaggedRings(1)).has_value());
}

PlanarRegion readText(const std::string& text, const std::string& format) {
  std::istringstream stream(text);
  return readPlanarRegion(stream, format, "file", RunContext());
}

std::string readError(const std::string& text, const std::string& format) {
  try {
    readText(text, format);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PlanarRegionFile, ReadsWellKnownText) {
  const PlanarRegion polygon = readText("POLYGON ((0 0, 4 0, 4 4, 0 4, 0 0), (1 1, 3 1, 3 3, 1 3, 1 1))\n", ".wkt");
  EXPECT_EQ(polygon.area(), 12);
  EXPECT_THAT(polygon.ring(0), ElementsAre(Vec2(0, 0), Vec2(4, 0), Vec2(4, 4), Vec2(0, 4)));
  EXPECT_THAT(polygon.ring(1), ElementsAre(Vec2(1, 1), Vec2(1, 3), Vec2(3, 3), Vec2(3, 1)));  // turned

  const PlanarRegion several = readText(
      "\xEF\xBB\xBFmultiPolygon(\r\n((0 0,0 9,9 9,9 0,0 0),\n (1 1,8 1\t,8 8,1 8,1 1)),\n\n"
      "((2 2,+7 2,7.0 7,2e0 70e-1,2 2))\n)",
      ".wkt");
  EXPECT_EQ(several.ringCount(), 3U);
  EXPECT_EQ(several.area(), 81 - 49 + 25);
}

TEST(PlanarRegionFile, ReadsCoordinates) {
  const PlanarRegion region =
      readText("# outline\n0 0\n4,0\n4 , 4 # corner\n# no new ring\n0\t4\r\n0 0\n\n\n   \n1 1\n3 1\n3 3\n1 3\n", ".xy");
  EXPECT_EQ(region.ringCount(), 2U);
  EXPECT_EQ(region.area(), 12);
  EXPECT_TRUE(region.isHole(1));
  EXPECT_EQ(readText("0 0\n1 0\n0 1", ".txt").area(), 0.5);
}

TEST(PlanarRegionFile, NamesTheLineOfEachFault) {
  const std::string wanted = "file:1: expected ";
  EXPECT_EQ(readError("", ".wkt"), "file: the file is empty");
  EXPECT_EQ(readError(" \n", ".wkt"), "file: the file is empty");
  EXPECT_EQ(readError("POINT (1 2)", ".wkt"), wanted + "POLYGON or MULTIPOLYGON, found \"POINT\"");
  EXPECT_EQ(readError("POLYGON EMPTY", ".wkt"), wanted + "\"(\", found \"EMPTY\"");
  EXPECT_EQ(readError("POLYGON ((0 0, 1 0, 1 1, 0 0)", ".wkt"), wanted + "\",\" or \")\", found the end");
  EXPECT_EQ(readError("POLYGON ((0 0, 1 0,\n1 x, 0 0))", ".wkt"), "file:2: expected a number for y, found \"x\"");
  EXPECT_EQ(readError("POLYGON ((0 0, 1 0,\n1, 0 0))", ".wkt"), "file:2: expected a number for y, found \",\"");
  EXPECT_EQ(readError("POLYGON ((0 0 5, 1 0, 1 1, 0 0))", ".wkt"), wanted + "\",\" or \")\", found \"5\"");
  EXPECT_EQ(readError("POLYGON ((0 0, 1 0, 1 1))", ".wkt"),
            wanted + "a ring whose last point equals its first, found ring 1");
  EXPECT_EQ(readError("POLYGON ((0 0, 1 0, 1 1, 0 0))\nPOLYGON", ".wkt"),
            "file:2: expected the end of the file after one geometry, found \"POLYGON\"");
  EXPECT_EQ(readError("POLYGON ((0 0, 1 0, 0 0))", ".wkt"),
            "file:1: ring 1, point 1: expected a ring of 3 or more points, found 2");
  EXPECT_EQ(readError("POLYGON ((0 0, 1 0,\n1 nan, 0 0))", ".wkt"),
            "file:2: ring 1, point 3: a coordinate is not a finite number");
  EXPECT_EQ(readError("POLYGON ((0 0,\n1 1,\n1 0,\n0 1,\n0 0))", ".wkt"),
            "file:1: ring 1, point 1: the edge that begins here crosses or touches the edge that begins at ring 1, "
            "point 3");
  EXPECT_EQ(readError("POLYGON ((0 0, 1 0, 1 1, 0 0),\n(5 0, 6 0, 6 1, 5 0))", ".wkt"),
            "file:2: ring 2: a hole that does not lie inside of its polygon's outline");
  EXPECT_EQ(readError("MULTIPOLYGON (((0 0, 9 0, 0 9, 0 0)),\n((1 1, 2 1, 1 2, 1 1)))", ".wkt"),
            "file:2: ring 2: the outline of a polygon lies inside of another polygon");
  // The first polygon's hole lies in the second polygon.
  EXPECT_EQ(readError("MULTIPOLYGON (((0 0, 1 0, 0 1, 0 0),\n(6 6, 7 6, 6 7, 6 6)),((5 5, 9 5, 5 9, 5 5)))", ".wkt"),
            "file:2: ring 2: a hole that does not lie inside of its polygon's outline");

  EXPECT_EQ(readError("", ".xy"), "file: the file is empty");
  EXPECT_EQ(readError("# nothing\n\n", ".xy"), "file: the file holds no points");
  EXPECT_EQ(readError("0 0\n1\n", ".xy"), "file:2: expected a number for y, found the end of the line");
  EXPECT_EQ(readError("0 0\n1 0 3\n", ".xy"), "file:2: expected the end of the line after 2 numbers, found \"3\"");
  EXPECT_EQ(readError("0 0\n1,,0\n", ".xy"), "file:2: expected a number for y, found \",\"");
  EXPECT_EQ(readError("0 0\n1 1x\n", ".xy"), "file:2: expected a number for y, found \"1x\"");
  EXPECT_EQ(readError("0 0\n1 0\n1 1\n\n5 5\n6 5\n", ".xy"),
            "file:5: ring 2, point 1: expected a ring of 3 or more points, found 2");
  EXPECT_EQ(readError("0 0\n1 0\n\n", ".obj"), "file: expected the extension .wkt, .xy or .txt, found \".obj\"");
}

TEST(PlanarRegionFile, ReadsLinesAndFilesOfAnySize) {
  // One line of more than two blocks.
  std::string text = "POLYGON ((";
  const int corners = 100'000;
  testing::Draws draws(3);
  const auto ring = testing::jaggedRing({0, 0}, 1, 1.0000001, corners, draws);
  char number[64];
  for (int k = 0; k <= corners; ++k) {
    const Vec2& p = ring[static_cast<std::size_t>(k % corners)];
    std::snprintf(number, sizeof(number), "%s%.17g %.17g", k > 0 ? "," : "", p.x(), p.y());
    text += number;
  }
  text += "))";
  ASSERT_GT(text.size(), std::size_t{3} << 20);
  const PlanarRegion region = readText(text, ".wkt");
  EXPECT_EQ(region.points().size(), static_cast<std::size_t>(corners));
  EXPECT_NEAR(region.area(), std::numbers::pi, 1e-5);
}

TEST(PlanarRegionFile, ReadsFromAPath) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.WKT") << "POLYGON ((0 0, 1 0, 0 1, 0 0))";
  EXPECT_EQ(readPlanarRegion(folder / "a.WKT", RunContext()).area(), 0.5);
  EXPECT_THROW(readPlanarRegion(folder / "missing.wkt", RunContext()), InputError);
}

// Whatever a file holds, it is read or refused by an InputError.
TEST(PlanarRegionFile, SurvivesGarbage) {
  const std::string good[] = {
      "MULTIPOLYGON (((0 0, 9 0, 9 9, 0 9, 0 0), (1 1, 8 1, 8 8, 1 8, 1 1)), ((2 2, 7 2, 7 7, 2 7, 2 2)))",
      "0 0\n9 0\n9 9\n0 9\n\n1 1\n8 1\n8 8\n1 8\n"};
  const std::string formats[] = {".wkt", ".xy"};
  const std::string bytes = std::string(" \n\t(),.-+eE0123456789#naif\r", 27) + '\0' + '\xff';
  int refused = 0;
  for (std::uint64_t seed = 0; seed < 4000; ++seed) {
    testing::Draws draws(seed);
    const std::size_t kind = seed % 2;
    std::string text = good[kind];
    const auto place = [&] { return static_cast<std::size_t>(draws.next() * static_cast<double>(text.size())); };
    for (int change = 0; change < 1 + static_cast<int>(3 * draws.next()) && !text.empty(); ++change) {
      const auto byte = bytes[static_cast<std::size_t>(draws.next() * static_cast<double>(bytes.size()))];
      const double what = draws.next();
      if (what < 0.5) {
        text[place()] = byte;
      } else if (what < 0.7) {
        text.insert(place(), 1, byte);
      } else if (what < 0.9) {
        text.erase(place(), 1);
      } else {
        text.resize(place());
      }
    }
    try {
      const PlanarRegion region = readText(text, formats[kind]);
      EXPECT_GT(region.area(), 0);
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_LT(refused, 4000);
}

}  // namespace
}  // namespace voroform::mesh
