// rank: files, rankings that add up, resuming, failures, experiments.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "program.hpp"

namespace voroform::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

const std::vector<std::string> kShapes = {"torus", "sphere", "ellipsoid"};

std::vector<std::string> rankArguments(const fs::path& out, const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments = {
      "rank", "-o", out, "--methods", "mc,cvt1,cvt3", "--resolution", "10", "--no-dual", "--delaunay-time-limit", "60"};
  for (const std::string& shape : kShapes) arguments.push_back("shape:" + shape);
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::map<std::string, fs::file_time_type> comparisonTimes(const fs::path& out) {
  std::map<std::string, fs::file_time_type> times;
  for (const std::string& shape : kShapes) times[shape] = fs::last_write_time(out / shape / "comparison.json");
  return times;
}

TEST(Rank, WritesRankingsThatAddUp) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  const Outcome outcome = run(rankArguments(out));
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(namesIn(out), ElementsAre("ellipsoid", "rankings.csv", "rankings.json", "rankings.md", "rankings.svg",
                                        "sphere", "torus"));
  EXPECT_THAT(namesIn(out / "torus"), ElementsAre("comparison-equal-triangles.csv", "comparison.csv", "comparison.json",
                                                  "comparison.md", "ranked.json"));
  EXPECT_THAT(outcome.out, HasSubstr("cvt3 first on"));

  const auto rankings = readJson(out / "rankings.json");
  EXPECT_EQ(rankings["schema"], "voroform.rankings/1");
  std::vector<std::string> rules;
  for (const auto& table : rankings["tables"]) {
    rules.push_back(table["rule"]);
    EXPECT_THAT(table["inputs"], ElementsAre("torus", "sphere", "ellipsoid"));
    for (const auto& criterion : table["criteria"]) {
      const std::size_t methods = criterion["methods"].size();
      double meanRanks = 0;
      for (const auto& method : criterion["methods"]) {
        int placed = 0;
        for (const auto& count : method["places"]) placed += count.get<int>();
        EXPECT_EQ(placed, 3) << criterion["criterion"] << ' ' << method["method"];
        EXPECT_EQ(method["values"].size(), 3U);
        meanRanks += method["mean_rank"].get<double>();
      }
      EXPECT_NEAR(meanRanks, 0.5 * static_cast<double>(methods * (methods + 1)), 1e-12);
    }
  }
  EXPECT_THAT(rules, ElementsAre("equal resolution", "equal triangles, cvt1", "equal triangles, cvt3"));

  // The values are those of the comparisons; on smooth shapes cvt3 is the most accurate.
  const auto& dmean = rankings["tables"][0]["criteria"][0];
  ASSERT_EQ(dmean["criterion"], "dmean");
  for (const auto& method : dmean["methods"]) {
    const auto comparison = readJson(out / "torus/comparison.json");
    EXPECT_EQ(method["values"][0], comparison["methods"][method["method"].get<std::string>()]["accuracy"]["dmean"]);
  }
  EXPECT_EQ(dmean["methods"][2]["places"], nlohmann::ordered_json({3, 0, 0}));
  EXPECT_THAT(readFile(out / "rankings.csv"), HasSubstr("equal resolution,all,10,dmean,cvt3,3,0,1,"));
  EXPECT_THAT(readFile(out / "rankings.md"), AllOf(HasSubstr("Friedman"), HasSubstr("| cvt3 | 3 | 0 | 0 |")));
}

TEST(Rank, DrawsWellFormedSvgWithoutOutsideResources) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  const std::string toml = folder.write("e.toml",
                                        "name = \"<a & \\\"b\\\">\"\nresolutions = [8]\nmethods = [\"mc\", \"cvt1\"]\n"
                                        "equal-triangles = false\n[[input]]\nshape = \"sphere\"\n");
  const Outcome outcome = run({"rank", "--experiment", toml, "-o", out, "--no-dual"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const std::string svg = readFile(out / "rankings.svg");
  EXPECT_THAT(svg,
              AllOf(HasSubstr("&lt;a &amp;"), HasSubstr("<text "), Not(HasSubstr("href")), Not(HasSubstr("url("))));
  const Outcome parsed = runCommand(
      {"python3", "-c", "import sys, xml.dom.minidom as m; print(m.parse(sys.argv[1]).documentElement.tagName)",
       out / "rankings.svg"});
  EXPECT_EQ(parsed.exitCode, 0) << parsed.err;
  EXPECT_EQ(parsed.out, "svg\n");
}

TEST(Rank, TakesFinishedRunsAndMakesTheOthersAnew) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  ASSERT_EQ(run(rankArguments(out, {"--no-equal-triangles"})).exitCode, 0);
  const auto first = comparisonTimes(out);
  const std::string rankings = readJson(out / "rankings.json")["tables"].dump();
  fs::remove(out / "sphere/comparison.json");
  const Outcome again = run(rankArguments(out, {"--no-equal-triangles", "--verbose"}));
  ASSERT_EQ(again.exitCode, 0) << again.err;
  EXPECT_THAT(again.err,
              AllOf(HasSubstr("torus: taken"), HasSubstr("sphere: comparing"), HasSubstr("ellipsoid: taken")));
  const auto second = comparisonTimes(out);
  EXPECT_EQ(second.at("torus"), first.at("torus"));
  EXPECT_EQ(second.at("ellipsoid"), first.at("ellipsoid"));
  EXPECT_GT(second.at("sphere"), first.at("sphere"));
  const auto after = readJson(out / "rankings.json");
  EXPECT_EQ(after["runs"][0]["resumed"], true);
  EXPECT_EQ(after["runs"][1]["resumed"], false);
  // The accuracy is the same as before; times are not.
  EXPECT_EQ(after["tables"][0]["criteria"][0], nlohmann::ordered_json::parse(rankings)[0]["criteria"][0]);

  // Other options: all anew.
  ASSERT_EQ(run(rankArguments(out, {"--no-equal-triangles", "--iterations", "2"})).exitCode, 0);
  const auto third = comparisonTimes(out);
  for (const std::string& shape : kShapes) EXPECT_GT(third.at(shape), second.at(shape)) << shape;
}

TEST(Rank, MakesARunAnewWhoseComparisonOrInputChanged) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  const std::string cloud = folder.write("cloud.xyz", xyzText(torusPoints(800)));
  const std::vector<std::string> arguments = {"rank",    cloud,       "-o",           out, "--methods",
                                              "mc,cvt1", "--no-dual", "--resolution", "8", "--no-equal-triangles"};
  ASSERT_EQ(run(arguments).exitCode, 0);
  EXPECT_EQ(readJson(out / "rankings.json")["runs"][0]["sha256"].get<std::string>().size(), 64U);
  std::ofstream(out / "cloud/comparison.json", std::ios::app) << ' ';
  const Outcome damaged = run(arguments);
  ASSERT_EQ(damaged.exitCode, 0);
  EXPECT_THAT(damaged.err, HasSubstr("was changed"));
  EXPECT_EQ(readJson(out / "rankings.json")["runs"][0]["resumed"], false);
  ASSERT_EQ(run(arguments).exitCode, 0);
  EXPECT_EQ(readJson(out / "rankings.json")["runs"][0]["resumed"], true);
  folder.write("cloud.xyz", xyzText(torusPoints(900)));
  ASSERT_EQ(run(arguments).exitCode, 0);
  EXPECT_EQ(readJson(out / "rankings.json")["runs"][0]["resumed"], false);
}

TEST(Rank, GoesOnAfterAFailureAndSaysSo) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  // Open: it lacks a face.
  const std::string open =
      folder.write("open.off", "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n");
  const Outcome outcome = run({"rank", open, "shape:sphere", "-o", out, "--methods", "mc,cvt1", "--resolution", "8",
                               "--no-dual", "--no-equal-triangles"});
  EXPECT_EQ(outcome.exitCode, 4);
  EXPECT_THAT(outcome.err, HasSubstr("1 of 2 runs failed"));
  const auto rankings = readJson(out / "rankings.json");
  EXPECT_THAT(rankings["runs"][0]["failure"].get<std::string>(), HasSubstr("open.off"));
  EXPECT_THAT(rankings["tables"][0]["inputs"], ElementsAre("sphere"));
  EXPECT_THAT(readFile(out / "rankings.md"), HasSubstr("open.off"));
}

TEST(Rank, KeepsTessellationsOnRequest) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  std::vector<std::string> arguments = {"rank",    "shape:sphere", "-o", out,         "--methods",
                                        "mc,cvt1", "--resolution", "8",  "--no-dual", "--no-equal-triangles"};
  ASSERT_EQ(run(arguments).exitCode, 0);
  EXPECT_FALSE(fs::exists(out / "sphere/cvt1"));
  arguments.emplace_back("--keep-tessellations");
  ASSERT_EQ(run(arguments).exitCode, 0);
  EXPECT_THAT(namesIn(out / "sphere/cvt1"), ElementsAre("cells.vtu", "surface.ply"));
}

TEST(Rank, RanksGroupsAndResolutionsApartAndSeedsByTheirMedian) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  const std::string toml = folder.write("e.toml",
                                        "name = \"e\"\nresolutions = [8, 10]\nseeds = [1, 2, 3]\niterations = 2\n"
                                        "methods = [\"mc\", \"cvt1\"]\nequal-triangles = false\n"
                                        "[[input]]\nshape = \"sphere\"\ngroup = \"smooth\"\n"
                                        "[[input]]\nshape = \"box\"\ngroup = \"sharp\"\nname = \"cube\"\n");
  const Outcome outcome = run({"rank", "--experiment", toml, "-o", out, "--no-dual"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(namesIn(out / "cube"), ElementsAre("r10-s1", "r10-s2", "r10-s3", "r8-s1", "r8-s2", "r8-s3"));
  const auto rankings = readJson(out / "rankings.json");
  ASSERT_EQ(rankings["tables"].size(), 4U);
  EXPECT_EQ(rankings["tables"][0]["group"], "smooth");
  EXPECT_EQ(rankings["tables"][1]["group"], "sharp");
  EXPECT_EQ(rankings["tables"][2]["resolution"], 10);
  std::vector<double> values;
  for (const char* run : {"r8-s1", "r8-s2", "r8-s3"}) {
    values.push_back(
        readJson(out / "sphere" / run / "comparison.json")["methods"]["cvt1"]["accuracy"]["dmean"].get<double>());
  }
  std::sort(values.begin(), values.end());
  EXPECT_LT(values[0], values[1]);
  EXPECT_EQ(rankings["tables"][0]["criteria"][0]["methods"][1]["values"][0], values[1]);
}

struct BadExperiment {
  const char* toml;
  const char* place;
  const char* key;
};

TEST(Experiment, MistakesNameLineAndKey) {
  const TemporaryFolder folder;
  const std::string input = "\n[[input]]\nshape = \"sphere\"\n";
  const std::vector<BadExperiment> cases = {
      {"name = \"e\"\ncolor = 3", "e.toml:2:", "color"},
      {"resolutions = [50, 2]", "e.toml:1:", "resolutions: 2 is not in [4, 1000]"},
      {"resolutions = 50", "e.toml:1:", "resolutions: expected a list"},
      {"\nseeds = [1, 1]", "e.toml:2:", "seeds: a value stands there twice"},
      {"methods = [\"mc\", \"cvt9\"]", "e.toml:1:", "cvt9"},
      {"methods = [\"mc\"]", "e.toml: ", "at least two"},
      {"implicit = \"levelset\"", "e.toml: ", "levelset"},
      {"rotate = \"yes\"", "e.toml:1:", "rotate: expected true or false"},
      {"delaunay-time-limit = -1", "e.toml: ", "delaunay-time-limit"},
      {"name = = 1", "e.toml:1:", ""},
  };
  for (const BadExperiment& bad : cases) {
    const Outcome outcome =
        run({"rank", "--experiment", folder.write("e.toml", bad.toml + input), "-o", folder / "out"});
    EXPECT_EQ(outcome.exitCode, 2) << bad.toml << '\n' << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(bad.place), HasSubstr(bad.key))) << bad.toml;
  }
  const std::vector<BadExperiment> inputs = {
      {"", "e.toml:", "[[input]]"},
      {"[[input]]\ngroup = \"a\"\n", "e.toml:1:", "either file or shape"},
      {"[[input]]\nshape = \"cone\"\n", "e.toml:2:", "cone"},
      {"[[input]]\nshape = \"box\"\nsize = 3\n", "e.toml:3:", "size"},
      {"[[input]]\nshape = \"box\"\n[[input]]\nshape = \"box\"\n", "e.toml:1:", "both be called"},
      {"[[input]]\nshape = \"box\"\nname = \"../b\"\n", "e.toml:3:", "../b"},
  };
  for (const BadExperiment& bad : inputs) {
    const Outcome outcome = run({"rank", "--experiment", folder.write("e.toml", bad.toml), "-o", folder / "out"});
    EXPECT_EQ(outcome.exitCode, 2) << bad.toml << '\n' << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(bad.place), HasSubstr(bad.key))) << bad.toml;
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(Rank, RefusesWhatHasNoMeaningAndFindsMissingInputsAtOnce) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  EXPECT_EQ(run({"rank", "-o", out}).exitCode, 2);
  EXPECT_EQ(run({"rank", "shape:box", "-o", out, "--methods", "mc"}).exitCode, 2);
  EXPECT_EQ(run({"rank", "shape:box", "-o", out, "--rotation-seed", "3"}).exitCode, 2);
  EXPECT_EQ(run({"rank", "shape:box", "shape:box", "-o", out}).exitCode, 2);
  const Outcome missing = run({"rank", "shape:sphere", folder / "none.off", "-o", out});
  EXPECT_EQ(missing.exitCode, 3);
  EXPECT_THAT(missing.err, AllOf(HasSubstr("none.off"), Not(HasSubstr("comparing"))));
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace voroform::test
