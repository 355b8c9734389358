// The command compare: files, records, and what it does with methods that fail.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "program.hpp"

namespace voroform::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using Json = nlohmann::ordered_json;

std::vector<std::string> keysOf(const Json& json) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  return keys;
}

double dmean(const Json& comparison, const std::string& method) {
  return comparison["methods"][method]["accuracy"]["dmean"].get<double>();
}

// Without what differs from run to run.
void removeCost(Json& json) {
  if (!json.is_structured()) return;
  if (json.is_object()) {
    for (const char* key : {"seconds", "peak_memory_bytes", "threads"}) json.erase(key);
  }
  for (Json& value : json) removeCost(value);
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> parts;
  std::stringstream stream(line);
  for (std::string part; std::getline(stream, part, separator);) parts.push_back(part);
  return parts;
}

class Compare : public testing::Test {
 protected:
  // All methods, on one thread: what several tests look at.
  struct FullRun {
    TemporaryFolder folder;
    Outcome outcome = run({"compare", "shape:sphere", "-o", folder / "out", "--resolution", "12", "--lloyd-iterations",
                           "3", "--threads", "1"});
  };
  static const FullRun& fullRun() {
    static const FullRun instance;
    return instance;
  }

  Outcome compare(const std::string& input, const std::string& name, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {"compare", input, "-o", folder_ / name, "--resolution", "12"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  Json record(const std::string& name) { return readJson(folder_ / name / "comparison.json"); }

  TemporaryFolder folder_;
};

TEST_F(Compare, MeasuresAllMethodsAlike) {
  const FullRun& full = fullRun();
  ASSERT_EQ(full.outcome.exitCode, 0) << full.outcome.err;
  EXPECT_THAT(namesIn(full.folder / "out"),
              ElementsAre("comparison-equal-triangles.csv", "comparison.csv", "comparison.json", "comparison.md",
                          "cvt1", "cvt1@0", "cvt2", "cvt3", "cvt4", "delaunay", "mc"));
  const Json comparison = readJson(full.folder / "out/comparison.json");
  EXPECT_EQ(comparison["schema"], "voroform.comparison/1");
  EXPECT_EQ(comparison["input"]["rotation_seed"], 0);
  EXPECT_THAT(keysOf(comparison["methods"]), ElementsAre("mc", "delaunay", "cvt1@0", "cvt1", "cvt2", "cvt3", "cvt4"));
  const double h = comparison["cell_size"];
  for (const auto& [name, method] : comparison["methods"].items()) {
    EXPECT_THAT(namesIn(full.folder / "out" / name), ElementsAre("cells.vtu", "surface.ply"));
    EXPECT_TRUE(method["failure"].is_null()) << name;
    EXPECT_EQ(method["validity"]["valid"], true) << name;
    EXPECT_EQ(method["validity"]["euler_characteristic"], 2) << name;
    const Json& accuracy = method["accuracy"];
    EXPECT_EQ(accuracy["cell_size"], h) << name;
    EXPECT_EQ(accuracy["unfound"], 0) << name;
    // A chord of length h stays within h²/8 of the unit sphere.
    EXPECT_GT(accuracy["dmean"].get<double>(), 0.002 * h * h) << name;
    EXPECT_LT(accuracy["dmean"].get<double>(), 0.3 * h * h) << name;
    EXPECT_GE(accuracy["drmse"], accuracy["dmean"]) << name;
    EXPECT_GE(accuracy["dmax"], accuracy["drmse"]) << name;
    EXPECT_EQ(accuracy["relative"]["cell_size"]["dmean"], accuracy["dmean"].get<double>() / h);
    EXPECT_EQ(method["quality"]["boundary_triangles"]["elements"], method["counts"]["boundary_triangles"]) << name;
    EXPECT_EQ(method["relative_to"]["mc"]["dmean"], dmean(comparison, name) / dmean(comparison, "mc"));
    EXPECT_GT(method["seconds"]["tessellation"].get<double>(), 0) << name;
  }
  EXPECT_LT(dmean(comparison, "cvt4"), 0.6 * dmean(comparison, "cvt3"));
  EXPECT_LT(dmean(comparison, "cvt3"), dmean(comparison, "cvt2"));
  EXPECT_LT(dmean(comparison, "cvt2"), dmean(comparison, "cvt1"));
  EXPECT_LT(dmean(comparison, "cvt1"), dmean(comparison, "cvt1@0"));
  for (const char* name : {"cvt1@0", "cvt1", "cvt2", "cvt3", "cvt4"}) {
    EXPECT_EQ(comparison["methods"][name]["counts"]["cells"], comparison["sites"]);
  }
  // n cells of the cubes' size: the volume of the sphere over the cubes', give or take those at its surface.
  EXPECT_NEAR(h / comparison["cube_edge"].get<double>(), 1, 0.03);
  EXPECT_EQ(comparison["methods"]["cvt1@0"]["energy"]["iterations"], 0);
  // One optimization served these.
  EXPECT_EQ(comparison["methods"]["cvt1"]["energy"], comparison["methods"]["cvt3"]["energy"]);

  const Json& tetrahedra = comparison["methods"]["delaunay"]["quality"]["tetrahedra"];
  EXPECT_EQ(tetrahedra["elements"], comparison["methods"]["delaunay"]["counts"]["cells"]);
  const Json& dual = comparison["methods"]["cvt1"]["quality"]["dual"];
  EXPECT_GT(dual["tetrahedra"]["mean"]["vq1"], tetrahedra["mean"]["vq1"]);
  EXPECT_TRUE(comparison["methods"]["cvt2"]["quality"]["dual"].is_null());
}

TEST_F(Compare, RunsTheBaselinesFinerUntilTheirTrianglesAreAsMany) {
  ASSERT_EQ(fullRun().outcome.exitCode, 0) << fullRun().outcome.err;
  const Json comparison = readJson(fullRun().folder / "out/comparison.json");
  EXPECT_THAT(keysOf(comparison["equal_triangles"]), ElementsAre("cvt1", "cvt2", "cvt3", "cvt4"));
  for (const auto& [name, group] : comparison["equal_triangles"].items()) {
    const double wanted = comparison["methods"][name]["counts"]["boundary_triangles"];
    EXPECT_EQ(group["boundary_triangles"], wanted);
    for (const char* baseline : {"mc", "delaunay"}) {
      const Json& method = group[baseline];
      EXPECT_TRUE(method["failure"].is_null());
      EXPECT_NEAR(method["counts"]["boundary_triangles"].get<double>(), wanted, 0.02 * wanted) << name;
      EXPECT_LT(method["accuracy"]["dmean"], dmean(comparison, baseline)) << "more triangles, yet no more accurate";
      EXPECT_EQ(method["accuracy"]["cell_size"], comparison["cell_size"]);
    }
  }
}

TEST_F(Compare, FitsWhatItIsAskedTo) {
  const Outcome outcome = compare(
      "shape:sphere", "out", {"--methods", "mc,delaunay,cvt2,cvt2+fit", "--fit-baselines", "--lloyd-iterations", "1"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const Json comparison = record("out");
  EXPECT_THAT(keysOf(comparison["methods"]),
              ElementsAre("mc", "mc+fit", "delaunay", "delaunay+fit", "cvt2", "cvt2+fit"));
  for (const std::string name : {"mc", "delaunay", "cvt2"}) {
    EXPECT_LT(dmean(comparison, name + "+fit"), 0.6 * dmean(comparison, name)) << name;
    EXPECT_EQ(comparison["methods"][name + "+fit"]["validity"]["valid"], true) << name;
    EXPECT_EQ(comparison["methods"][name + "+fit"]["counts"], comparison["methods"][name]["counts"]) << name;
  }
  for (const auto& [name, group] : comparison["equal_triangles"].items()) {
    EXPECT_LT(group["mc+fit"]["accuracy"]["dmean"], group["mc"]["accuracy"]["dmean"]) << name;
    EXPECT_LT(group["delaunay+fit"]["accuracy"]["dmean"], group["delaunay"]["accuracy"]["dmean"]) << name;
  }
}

TEST_F(Compare, WritesTheSamplesItMeasuredWith) {
  const Outcome outcome =
      compare("shape:sphere", "out", {"--methods", "cvt2", "--no-equal-triangles", "--accuracy-samples"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  std::stringstream file(readFile(folder_ / "out/cvt2/accuracy-samples.csv"));
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line, "from,x,y,z,nearest_x,nearest_y,nearest_z,distance,angle");
  double sum = 0;
  int count = 0;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = split(line, ',');
    ASSERT_EQ(cells.size(), 9U);
    if (cells[0] != "boundary") continue;
    // Boundary samples have their nearest points on the unit sphere.
    const auto at = [&](std::size_t i) { return std::stod(cells[i]); };
    EXPECT_NEAR(std::hypot(at(4), at(5), at(6)), 1, 1e-8);
    EXPECT_NEAR(std::abs(std::hypot(at(1), at(2), at(3)) - 1), at(7), 1e-8);
    sum += at(7);
    ++count;
  }
  const Json direction = record("out")["methods"]["cvt2"]["accuracy"]["per_direction"]["boundary_to_form"];
  EXPECT_EQ(count, direction["samples"].get<int>());
  EXPECT_NEAR(sum / count, direction["mean"].get<double>(), 1e-12);
}

TEST_F(Compare, TablesHoldARowForEachMethod) {
  const Outcome outcome = compare("shape:sphere", "out", {"--methods", "cvt2,mc", "--no-equal-triangles"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(namesIn(folder_ / "out"),
              ElementsAre("comparison.csv", "comparison.json", "comparison.md", "cvt2", "mc"));
  EXPECT_THAT(keysOf(record("out")["methods"]), ElementsAre("mc", "cvt2"));
  EXPECT_TRUE(record("out")["equal_triangles"].is_null());
  const std::vector<std::string> lines = split(readFile(folder_ / "out/comparison.csv"), '\n');
  ASSERT_EQ(lines.size(), 3U);
  const std::vector<std::string> header = split(lines[0], ',');
  const auto column = static_cast<std::size_t>(std::find(header.begin(), header.end(), "dmean") - header.begin());
  ASSERT_LT(column, header.size());
  EXPECT_EQ(split(lines[1], ',')[0], "mc");
  EXPECT_EQ(split(lines[2], ',')[0], "cvt2");
  EXPECT_EQ(std::stod(split(lines[2], ',')[column]), dmean(record("out"), "cvt2"));
  const std::string tables = readFile(folder_ / "out/comparison.md");
  EXPECT_THAT(tables, AllOf(HasSubstr("table 5.1"), HasSubstr("table 5.2"), HasSubstr("table 5.3"),
                            HasSubstr("table 5.4"), HasSubstr("\n| cvt2 |"), HasSubstr("relative to mc")));
  EXPECT_THAT(tables, AllOf(Not(HasSubstr("| cvt3 |")), Not(HasSubstr("equal numbers"))));
}

TEST_F(Compare, GivesTheSameBitsForAnyNumberOfThreads) {
  ASSERT_EQ(compare("shape:sphere", "two", {"--threads", "2", "--lloyd-iterations", "3"}).exitCode, 0);
  Json one = readJson(fullRun().folder / "out/comparison.json");
  Json two = record("two");
  EXPECT_NE(one, two) << "seconds are missing";
  removeCost(one);
  removeCost(two);
  EXPECT_EQ(one, two);
  // The digests of all tessellations are among what is equal.
  EXPECT_EQ(one["sha256"].size(), 2 * one["methods"].size());
}

TEST_F(Compare, AMethodThatRunsOutOfTimeIsAResult) {
  const Outcome outcome =
      compare("shape:sphere", "out", {"--methods", "mc,delaunay,cvt1", "--delaunay-time-limit", "0.01"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("delaunay: did not finish in 0.01 s"));
  const Json comparison = record("out");
  const Json& delaunay = comparison["methods"]["delaunay"];
  EXPECT_THAT(delaunay["failure"].get<std::string>(), HasSubstr("did not finish in 0.01 s"));
  EXPECT_FALSE(delaunay.contains("accuracy"));
  EXPECT_GT(dmean(comparison, "cvt1"), 0);
  EXPECT_THAT(comparison["equal_triangles"]["cvt1"]["delaunay"]["failure"].get<std::string>(),
              AllOf(HasSubstr("not tried"), HasSubstr("did not finish")));
  EXPECT_TRUE(comparison["equal_triangles"]["cvt1"]["mc"]["failure"].is_null());
  EXPECT_THAT(readFile(folder_ / "out/comparison.md"), HasSubstr("| delaunay | did not finish in 0.01 s |"));
  EXPECT_THAT(namesIn(folder_ / "out"), Not(testing::Contains("delaunay")));
}

TEST_F(Compare, TurnsShapesButNotClouds) {
  const std::vector<std::string> fast = {"--methods", "mc", "--no-equal-triangles"};
  ASSERT_EQ(compare("shape:box", "turned", fast).exitCode, 0);
  ASSERT_EQ(compare("shape:box", "straight", {"--methods", "mc", "--no-equal-triangles", "--no-rotation"}).exitCode, 0);
  EXPECT_FALSE(record("straight")["input"].contains("rotation_seed"));
  // Marching Cubes is exact on the box's sides, and cuts its edges and corners: turned it also cuts the sides' rims.
  EXPECT_GT(dmean(record("turned"), "mc"), 0);
  EXPECT_NE(dmean(record("turned"), "mc"), dmean(record("straight"), "mc"));
  const std::string cloud = folder_.write("torus.xyz", xyzText(torusPoints(1000)));
  ASSERT_EQ(compare(cloud, "cloud", fast).exitCode, 0);
  EXPECT_FALSE(record("cloud")["input"].contains("rotation_seed"));
  EXPECT_THAT(namesIn(folder_ / "cloud"), ElementsAre("comparison.csv", "comparison.json", "comparison.md", "form.json",
                                                      "form.vtu", "mc", "points.ply"));
}

TEST_F(Compare, RefusesWhatItCannotDo) {
  struct Case {
    std::vector<std::string> arguments;
    std::string message;
  };
  for (const Case& bad : {Case{{"--methods", "mc,cvt9"}, "unknown method cvt9"}, Case{{"--methods", ","}, "method"},
                          Case{{"--resolution", "3"}, "3 is not in [4, 1000]"},
                          Case{{"--resolution", "1001"}, "1001 is not in [4, 1000]"},
                          Case{{"--no-rotation", "--rotation-seed", "3"}, "--no-rotation"},
                          Case{{"--margin", "0.1"}, "--margin: has no meaning"}}) {
    std::vector<std::string> arguments = {"compare", "shape:sphere", "-o", folder_ / "out"};
    arguments.insert(arguments.end(), bad.arguments.begin(), bad.arguments.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 2) << bad.message;
    EXPECT_THAT(outcome.err, HasSubstr(bad.message));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(Compare, AccuracyStandsInTheMetricsUnlessItIsLeftOut) {
  const std::vector<std::string> base = {"tessellate", "shape:sphere", "-o", folder_ / "out", "--sites", "300"};
  Outcome outcome = run(base);
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("accuracy: mean distance"));
  const Json accuracy = readJson(folder_ / "out/metrics.json")["accuracy"];
  EXPECT_GT(accuracy["dmean"].get<double>(), 0);
  EXPECT_NEAR(accuracy["cell_size"].get<double>(), std::cbrt(4.18879 / 300), 1e-4);
  // evaluate gives the same.
  ASSERT_EQ(run({"evaluate", folder_ / "out"}).exitCode, 0);
  EXPECT_EQ(readJson(folder_ / "out/metrics.json")["accuracy"], accuracy);

  std::vector<std::string> without = base;
  without.push_back("--no-accuracy");
  outcome = run(without);
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.out, Not(HasSubstr("accuracy:")));
  EXPECT_TRUE(readJson(folder_ / "out/metrics.json")["accuracy"].is_null());
}

}  // namespace
}  // namespace voroform::test
