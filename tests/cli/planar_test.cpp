// Regions of the plane: tessellate and info on them, and what other commands say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "program.hpp"

namespace voroform::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kHoles =
    "MULTIPOLYGON (((0 0, 10 0, 10 6, 0 6, 0 0), (4 2, 4 4, 6 4, 6 2, 4 2)),\n"
    " ((12 0, 15 0, 13.5 5, 12 0)))\n";
constexpr const char* kCorner = "0 0\n4 0\n4 1\n1 1\n1 4\n0 4\n";

const std::vector<std::string> kFiles = {"cells.svg", "cells.vtu", "sites.ply"};

class Planar : public testing::Test {
 protected:
  std::filesystem::path made(const std::string& name, const std::string& input,
                             const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"tessellate", input, "-o", folder_ / name, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return folder_ / name;
  }

  // metrics.json without what may differ between equal runs.
  static std::string comparableMetrics(const std::filesystem::path& folder) {
    auto metrics = readJson(folder / "metrics.json");
    for (const char* key : {"seconds", "peak_memory_bytes", "threads"}) {
      EXPECT_EQ(metrics.erase(key), 1U) << key;
    }
    return metrics.dump(2);
  }

  static void expectSameFiles(const std::filesystem::path& a, const std::filesystem::path& b) {
    // Compared as a truth value, because the files are too long to be printed.
    for (const std::string& name : kFiles) EXPECT_TRUE(readFile(a / name) == readFile(b / name)) << name;
  }

  TemporaryFolder folder_;
  std::vector<std::string> few_ = {"--sites", "300", "--seed", "3"};
};

TEST_F(Planar, TheSquareIsTessellatedAndMeasured) {
  const Outcome outcome =
      run({"tessellate", "shape2d:square", "-o", folder_ / "square", "--sites", "1033", "--iterations", "30"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("region: square, 1 ring of 4 points, area 400"));
  EXPECT_THAT(outcome.out, HasSubstr("valid: yes"));
  EXPECT_THAT(namesIn(folder_ / "square"), ElementsAre("cells.svg", "cells.vtu", "metrics.json", "sites.ply"));
  const auto metrics = readJson(folder_ / "square" / "metrics.json");
  EXPECT_EQ(metrics["schema"], "voroform.metrics/1");
  EXPECT_EQ(metrics["dimension"], 2);
  EXPECT_EQ(metrics["input"]["kind"], "region");
  EXPECT_EQ(metrics["counts"]["sites"], 1033);
  EXPECT_EQ(metrics["counts"]["cells"], 1033);
  // Euler: vertices − edges + cells = 1 for a disc.
  EXPECT_EQ(metrics["counts"]["vertices"].get<int>() - metrics["counts"]["edges"].get<int>() + 1033, 1);
  EXPECT_EQ(metrics["validity"]["valid"], true);
  EXPECT_EQ(metrics["validity"]["closed"], true);
  EXPECT_LT(metrics["validity"]["area_error"].get<double>(), 1e-12);
  EXPECT_NEAR(metrics["validity"]["area"].get<double>(), 400, 1e-9);
  EXPECT_EQ(metrics["regularity"]["optimal"].get<double>(), 5 / (36 * std::sqrt(3.0)));
  const auto& regularity = metrics["regularity"];
  // The thesis has 0.08101 at the end (table 4.1); all cells but those at the boundary are at least the hexagon's.
  EXPECT_LT(regularity["all"]["mean"].get<double>(), 0.0816);
  EXPECT_GT(regularity["interior"]["mean"].get<double>(), 5 / (36 * std::sqrt(3.0)));
  EXPECT_EQ(regularity["interior"]["cells"].get<int>() + regularity["boundary"]["cells"].get<int>(), 1033);
  // E ≈ m·n·(V/n)²·Ḡ where cells are alike.
  EXPECT_NEAR(metrics["energy"]["value"].get<double>(),
              2 * 400.0 * 400.0 / 1033 * regularity["all"]["mean"].get<double>(), 0.3);
  for (const std::string& name : kFiles) EXPECT_EQ(metrics["sha256"][name].get<std::string>().size(), 64U) << name;
}

TEST_F(Planar, OneAndTwoThreadsGiveTheSameFiles) {
  for (const std::string& input : {std::string("shape2d:star"), folder_.write("holes.wkt", kHoles)}) {
    std::vector<std::string> arguments = few_;
    arguments.insert(arguments.end(), {"--threads", "1"});
    const auto one = made("one", input, arguments);
    arguments.back() = "2";
    const auto two = made("two", input, arguments);
    expectSameFiles(one, two);
    EXPECT_EQ(comparableMetrics(one), comparableMetrics(two));
  }
}

TEST_F(Planar, AnotherSeedGivesOtherCells) {
  const auto a = made("a", "shape2d:disc", few_);
  const auto b = made("b", "shape2d:disc", {"--sites", "300", "--seed", "4"});
  EXPECT_FALSE(readFile(a / "cells.vtu") == readFile(b / "cells.vtu"));
}

TEST_F(Planar, SitesWrittenCanBeGivenAgain) {
  const std::string corner = folder_.write("corner.xy", kCorner);
  const auto first = made("first", corner, few_);
  const auto again = made("again", corner, {"--init", first / "sites.ply", "--iterations", "0"});
  expectSameFiles(first, again);
  EXPECT_EQ(readJson(again / "metrics.json")["options"]["sites"], 300);
  EXPECT_EQ(readJson(again / "metrics.json")["options"]["initialization"], "given");
}

TEST_F(Planar, EveryInitializationFillsTheRegion) {
  const std::string holes = folder_.write("holes.wkt", kHoles);
  // Of a lattice no placement may have just so many points inside.
  const std::vector<std::string> exact = {
      "random", "hammersley", "farthest-point", "greedy-edge-collapse", "hierarchical-random", "hierarchical-lattice"};
  for (const std::string& init : exact) {
    const auto folder = made(init, holes, {"--sites", "100", "--init", init, "--iterations", "3"});
    const auto metrics = readJson(folder / "metrics.json");
    EXPECT_EQ(metrics["options"]["initialization"], init);
    EXPECT_EQ(metrics["counts"]["cells"], 100) << init;
    EXPECT_EQ(metrics["validity"]["valid"], true) << init;
    EXPECT_NEAR(metrics["validity"]["area"].get<double>(), 63.5, 1e-10) << init;
  }
  const auto metrics =
      readJson(made("lattice", holes, {"--sites", "100", "--init", "lattice", "--iterations", "3"}) / "metrics.json");
  EXPECT_NEAR(metrics["counts"]["cells"].get<int>(), 100, 3);
  EXPECT_NEAR(metrics["validity"]["area"].get<double>(), 63.5, 1e-10);
}

// In space, too.
TEST_F(Planar, OnlyHierarchicalSitesHaveLevels) {
  for (const std::string input : {"shape2d:star", "shape:torus"}) {
    for (const std::string init : {"hierarchical-random", "hierarchical-lattice"}) {
      const auto metrics = readJson(
          made("levels", input, {"--sites", "700", "--init", init, "--subdivisions", "2", "--iterations", "3"}) /
          "metrics.json");
      ASSERT_TRUE(metrics.contains("hierarchy")) << input << init;
      const auto& levels = metrics["hierarchy"];
      ASSERT_EQ(levels.size(), 2U) << input << init;
      EXPECT_GT(levels[0]["sites"].get<int>(), 0);
      // The coarsest first; each level gives the sites of the next.
      for (std::size_t level = 0; level < 2; ++level) {
        const int next = level == 0 ? levels[1]["sites"].get<int>() : 700;
        EXPECT_EQ(levels[level]["subdivided"].get<int>() + levels[level]["inserted"].get<int>(), next) << input << init;
        EXPECT_GT(next, 2 * levels[level]["sites"].get<int>()) << input << init;
        EXPECT_GT(levels[level]["iterations"].get<int>(), 0) << input << init;
        EXPECT_GT(levels[level]["relative_error"].get<double>(), 0) << input << init;
        EXPECT_TRUE(levels[level]["stop"].is_string()) << input << init;
      }
      EXPECT_EQ(metrics["counts"]["cells"], 700) << input << init;
    }
    const auto plain = readJson(made("plain", input, {"--sites", "100", "--iterations", "1"}) / "metrics.json");
    EXPECT_FALSE(plain.contains("hierarchy")) << input;
  }
}

TEST_F(Planar, CellsGradedByADensity) {
  const auto folder =
      made("graded", "shape2d:disc", {"--sites", "300", "--density", "boundary", "--density-ratio", "2"});
  const auto metrics = readJson(folder / "metrics.json");
  EXPECT_EQ(metrics["options"]["density"]["kind"], "boundary");
  EXPECT_EQ(metrics["options"]["density"]["ratio"], 2);
  const auto uniform = readJson(made("uniform", "shape2d:disc", {"--sites", "300"}) / "metrics.json");
  EXPECT_GT(metrics["counts"]["boundary_cells"].get<int>(), 1.2 * uniform["counts"]["boundary_cells"].get<int>());
}

TEST_F(Planar, RegionsWithHolesAndParts) {
  // Few sites, so that a cell has the hole within it or holds parts of both polygons.
  const auto folder = made("few", folder_.write("holes.wkt", kHoles), {"--sites", "1", "--iterations", "0"});
  const auto metrics = readJson(folder / "metrics.json");
  EXPECT_EQ(metrics["region"]["rings"], 3);
  EXPECT_EQ(metrics["region"]["holes"], 1);
  EXPECT_EQ(metrics["counts"]["cells"], 1);
  EXPECT_EQ(metrics["validity"]["boundary_loops"], 3);
  EXPECT_EQ(metrics["validity"]["valid"], true);
}

TEST_F(Planar, RegionsFarFromTheOrigin) {
  const std::string far = folder_.write("far.xy", "500000 4500000\n500001 4500000\n500001 4500001\n500000 4500001\n");
  const auto metrics = readJson(made("far", far, few_) / "metrics.json");
  EXPECT_EQ(metrics["validity"]["valid"], true);
  EXPECT_NEAR(metrics["validity"]["area"].get<double>(), 1, 1e-9);
}

TEST_F(Planar, CellsThatDoublesCannotHoldFailTheCertificate) {
  // There the next double is 1/8 away: a hundred cells of this square have no room for their corners.
  const std::string far = folder_.write("far.xy", "1e15 0\n1000000000000001 0\n1000000000000001 1\n1e15 1\n");
  const Outcome outcome = run({"tessellate", far, "-o", folder_ / "far", "--sites", "100", "--iterations", "0"});
  EXPECT_EQ(outcome.exitCode, 4) << outcome.err;
}

TEST_F(Planar, InfoDescribesRegionsAndTheirCells) {
  const std::string holes = folder_.write("holes.wkt", kHoles);
  const Outcome text = run({"info", holes});
  EXPECT_EQ(text.exitCode, 0) << text.err;
  for (const char* line : {"kind: region", "format: WKT", "rings: 3", "holes: 1", "points: 11", "area: 63.5"}) {
    EXPECT_THAT(text.out, HasSubstr(line));
  }
  const Outcome json = run({"info", folder_.write("corner.xy", kCorner), "--json"});
  const auto parsed = nlohmann::ordered_json::parse(json.out);
  EXPECT_EQ(parsed["area"], 7);
  EXPECT_EQ(parsed["points"], 6);
  EXPECT_EQ(parsed["bounds"]["max"], nlohmann::ordered_json({4, 4}));
  const auto folder = made("cells", holes, few_);
  EXPECT_THAT(run({"info", folder / "cells.vtu"}).out, HasSubstr("cells of a region of the plane"));
}

TEST_F(Planar, MistakesOfUsage) {
  const std::string corner = folder_.write("corner.xy", kCorner);
  const std::string out = folder_ / "out";
  const auto folder = made("cells", corner, few_);
  const struct {
    std::vector<std::string> arguments;
    const char* message;
  } cases[] = {
      {{"tessellate", "shape2d:circle", "-o", out}, "square, star, disc"},
      {{"tessellate", "shape2d:disc", "-o", out, "--method", "cvt1"}, "--method: has no meaning for shape2d:disc"},
      {{"tessellate", "shape2d:disc", "-o", out, "--fit"}, "--fit: has no meaning"},
      {{"tessellate", "shape2d:disc", "-o", out, "--formats", "obj"}, "--formats: has no meaning"},
      {{"tessellate", corner, "-o", out, "--envelope", "none"}, "--envelope: has no meaning"},
      {{"tessellate", corner, "-o", out, "--root-finder", "itp"}, "--root-finder: has no meaning"},
      {{"tessellate", corner, "-o", out, "--no-accuracy"}, "--no-accuracy: has no meaning"},
      {{"tessellate", corner, "-o", out, "--as", "points"}, "--as: has no meaning"},
      {{"tessellate", corner, "-o", out, "--density", "curvature"}, "a polygon's edges are straight"},
      {{"tessellate", corner, "-o", out, "--sites", "0"}, "--sites"},
      {{"reconstruct", corner, "-o", out}, "is a region of the plane; reconstruct is for solids"},
      {{"compare", "shape2d:square", "-o", out}, "is a region of the plane; compare is for solids"},
      {{"implicit", corner, "-o", out}, "is a region of the plane; implicit is for solids"},
      {{"points", corner, "-o", out + ".ply"}, "is a region of the plane; points is for solids"},
      {{"rank", "shape:torus", corner, "-o", out}, "is a region of the plane; rank is for solids"},
      {{"evaluate", folder}, "holds cells of a region of the plane; evaluate measures those of solids"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 2) << message;
    EXPECT_THAT(outcome.err, HasSubstr(message));
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Planar, BadInputs) {
  const std::string out = folder_ / "out";
  const std::string crossing = folder_.write("crossing.wkt", "POLYGON ((0 0,\n 2 2, 2 0,\n 0 2, 0 0))\n");
  const std::string corner = folder_.write("corner.xy", kCorner);
  const struct {
    std::vector<std::string> arguments;
    const char* message;
  } cases[] = {
      {{"tessellate", crossing, "-o", out}, "crossing.wkt:1: ring 1, point 1"},
      {{"info", crossing}, "crossing.wkt:1: ring 1, point 1"},
      {{"tessellate", folder_ / "none.wkt", "-o", out}, "none.wkt: no such file"},
      {{"tessellate", corner, "-o", out, "--init", folder_.write("outside.xyz", "0.5 0.5 0\n2 2 0\n")},
       "outside.xyz: site 2 lies outside the region"},
      {{"tessellate", corner, "-o", out, "--init", folder_.write("above.xyz", "0.5 0.5 0.25\n")},
       "above.xyz: site 1 lies off the plane: its z is 0.25"},
      {{"tessellate", corner, "-o", out, "--init", folder_.write("twice.xyz", "0.5 0.5 0\n0.25 0.5 0\n0.5 0.5 0\n")},
       "sites 1 and 3 coincide"},
      {{"tessellate", corner, "-o", out, "--init", "no-such-kind"}, "no-such-kind"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 3) << message << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(message));
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Planar, TooLittleMemoryIsFoundBeforehand) {
  const Outcome outcome =
      run({"tessellate", "shape2d:square", "-o", folder_ / "out", "--sites", "100000", "--memory-limit", "10MB"});
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.err, HasSubstr("use fewer sites"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  // Less by far suffices for 300 random sites, but not for the samples of edge-collapsing.
  EXPECT_EQ(run({"tessellate", "shape2d:square", "-o", folder_ / "out", "--sites", "300", "--memory-limit", "1MB",
                 "--init", "greedy-edge-collapse"})
                .exitCode,
            1);
  EXPECT_EQ(
      run({"tessellate", "shape2d:square", "-o", folder_ / "out", "--sites", "300", "--memory-limit", "1MB"}).exitCode,
      0);
}

}  // namespace
}  // namespace voroform::test
