// The commands on good input: files, metrics and what is printed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "program.hpp"
#include "voroform/core/output_file.hpp"

namespace voroform::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> keysOf(const nlohmann::ordered_json& json) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  return keys;
}

class Commands : public testing::Test {
 protected:
  std::string torus(int count = 1500) { return folder_.write("torus.xyz", xyzText(torusPoints(count))); }

  TemporaryFolder folder_;
};

TEST_F(Commands, ReconstructWritesAValidTessellationOfTheSolid) {
  const Outcome outcome = run({"reconstruct", torus(), "-o", folder_ / "out", "--sites", "800"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(namesIn(folder_ / "out"), ElementsAre("cells.vtu", "form.json", "form.vtu", "metrics.json", "points.ply",
                                                    "sites.ply", "surface.ply"));
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("valid: yes"), HasSubstr("on the envelope"), HasSubstr("four spacings")));

  const auto metrics = readJson(folder_ / "out/metrics.json");
  EXPECT_THAT(keysOf(metrics), ElementsAre("schema", "input", "options", "versions", "seed", "threads", "points",
                                           "implicit", "counts", "validity", "fidelity", "clipping", "regularity",
                                           "accuracy", "energy", "seconds", "peak_memory_bytes", "warnings", "sha256"));
  EXPECT_EQ(metrics["schema"], "voroform.metrics/1");
  EXPECT_EQ(metrics["input"]["kind"], "points");
  EXPECT_EQ(metrics["counts"]["sites"], 800);
  EXPECT_EQ(metrics["counts"]["cells"].get<int>() + metrics["fidelity"]["empty_sites"].get<int>(), 800);
  const auto& validity = metrics["validity"];
  EXPECT_EQ(validity["valid"], true);
  EXPECT_EQ(validity["self_intersections"], 0);
  EXPECT_EQ(validity["components"], 1);
  EXPECT_EQ(validity["euler_characteristic"], 0);
  // The volume of the torus, 2π²Rr².
  EXPECT_NEAR(validity["volume"].get<double>(), 3.158, 0.06);
  EXPECT_LT(metrics["fidelity"]["volume_error"].get<double>(), 0.02);
  // Its surface stays clear of the envelope.
  EXPECT_EQ(metrics["fidelity"]["envelope_share"], 0);
  EXPECT_LT(metrics["fidelity"]["unsupported_share"].get<double>(), 0.01);
  EXPECT_GT(metrics["regularity"]["all"]["mean"].get<double>(), 0.0785);
  EXPECT_THAT(keysOf(metrics["sha256"]),
              ElementsAre("form.vtu", "points.ply", "form.json", "cells.vtu", "surface.ply", "sites.ply"));
  EXPECT_THAT(metrics.dump(), Not(HasSubstr((folder_ / "out").string())));
}

TEST_F(Commands, ReconstructWarnsOfFlippedNormalsAndRecordsIt) {
  std::vector<OrientedPoint> points = torusPoints(1500);
  for (OrientedPoint& point : points) point.normal = -point.normal;
  const std::string input = folder_.write("flipped.xyz", xyzText(points));
  const Outcome outcome = run({"reconstruct", input, "-o", folder_ / "out", "--sites", "200"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("warning: "));
  EXPECT_GE(readJson(folder_ / "out/metrics.json")["warnings"].size(), 1U);
}

TEST_F(Commands, EveryMethodAndOptimizerWorks) {
  for (const char* method : {"cvt1", "cvt2", "cvt3"}) {
    for (const char* optimizer : {"lbfgs", "lloyd"}) {
      const Outcome outcome = run({"tessellate", "shape:bumpy-sphere", "-o", folder_ / "out", "--sites", "300",
                                   "--method", method, "--optimizer", optimizer, "--root-finder", "bisection"});
      ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
      const auto metrics = readJson(folder_ / "out/metrics.json");
      EXPECT_EQ(metrics["options"]["method"], method);
      EXPECT_EQ(metrics["options"]["optimizer"], optimizer);
      EXPECT_EQ(metrics["options"]["root_finder"], "bisection");
      EXPECT_EQ(metrics["validity"]["valid"], true);
    }
  }
}

TEST_F(Commands, ThinPartsAreWarnedAbout) {
  const Outcome outcome = run({"tessellate", "shape:gyroid-ball", "-o", folder_ / "out", "--sites", "150"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning: "), HasSubstr("more sites")));
}

TEST_F(Commands, FurtherFormatsAreWritten) {
  const Outcome outcome =
      run({"tessellate", "shape:torus", "-o", folder_ / "out", "--sites", "200", "--formats", "adjacency,stl,obj,off"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(namesIn(folder_ / "out"), ElementsAre("adjacency.csv", "cells.vtu", "metrics.json", "sites.ply",
                                                    "surface.obj", "surface.off", "surface.ply", "surface.stl"));
  EXPECT_THAT(outcome.err, HasSubstr("warning: surface.stl"));
}

TEST_F(Commands, ZeroIterationsClipTheInitialSites) {
  const Outcome outcome =
      run({"tessellate", "shape:sphere", "-o", folder_ / "out", "--sites", "100", "--iterations", "0"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(readJson(folder_ / "out/metrics.json")["energy"]["iterations"], 0);
}

TEST_F(Commands, PointsCleansACloud) {
  std::string text = xyzText(torusPoints(300));
  text += text.substr(0, text.find('\n') + 1) + "nan 0 0 0 0 1\n1 2 3 0 0 0\n";
  const Outcome outcome = run({"points", folder_.write("raw.xyz", text), "-o", folder_ / "clean.ply"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("300 of 303 records"));
  const Outcome info = run({"info", folder_ / "clean.ply", "--json"});
  ASSERT_EQ(info.exitCode, 0) << info.err;
  const auto described = nlohmann::ordered_json::parse(info.out);
  EXPECT_EQ(described["kind"], "points");
  EXPECT_EQ(described["records"], 300);
  EXPECT_EQ(described["normals"], true);
  EXPECT_EQ(described["duplicates"], 0);
}

TEST_F(Commands, InfoDescribesClouds) {
  std::string text = xyzText(torusPoints(300));
  text += text.substr(0, text.find('\n') + 1) + "nan 0 0 0 0 1\n";
  const Outcome info = run({"info", folder_.write("raw.xyz", text), "--json"});
  ASSERT_EQ(info.exitCode, 0) << info.err;
  const auto described = nlohmann::ordered_json::parse(info.out);
  EXPECT_EQ(described["records"], 302);
  EXPECT_EQ(described["duplicates"], 1);
  EXPECT_EQ(described["not_finite"], 1);
  EXPECT_NEAR(described["bounds"]["max"][0].get<double>(), 1.4, 0.02);
}

TEST_F(Commands, InfoDescribesFormsAndCells) {
  ASSERT_EQ(run({"reconstruct", torus(), "-o", folder_ / "out", "--sites", "200"}).exitCode, 0);
  const auto form = nlohmann::ordered_json::parse(run({"info", folder_ / "out/form.vtu", "--json"}).out);
  EXPECT_EQ(form["kind"], "form");
  EXPECT_GT(form["tetrahedra"].get<int>(), 1500);
  const auto cells = nlohmann::ordered_json::parse(run({"info", folder_ / "out/cells.vtu", "--json"}).out);
  EXPECT_EQ(cells["kind"], "cells");
  EXPECT_EQ(cells["valid"], true);
  EXPECT_EQ(cells["euler_characteristic"], 0);
  EXPECT_THAT(run({"info", folder_ / "out/cells.vtu"}).out, AllOf(HasSubstr("kind: cells"), HasSubstr("valid: yes")));
  EXPECT_THAT(run({"info", folder_ / "out/surface.ply"}).out, HasSubstr("kind: mesh"));
  EXPECT_EQ(run({"info", folder_ / "none.ply"}).exitCode, 3);
}

TEST_F(Commands, QuietPrintsNothingAndTheLogEverything) {
  const Outcome outcome = run(
      {"tessellate", "shape:sphere", "-o", folder_ / "out", "--sites", "500", "--quiet", "--log", folder_ / "log.txt"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  EXPECT_EQ(outcome.err, "");
  EXPECT_THAT(readFile(folder_ / "log.txt"), HasSubstr("certificate"));
}

// What a restart evaluates again is no iteration.
TEST_F(Commands, IterationsAreCountedWithoutRestarts) {
  const Outcome outcome =
      run({"tessellate", "shape:gyroid-ball", "-o", folder_ / "out", "--sites", "200", "--iterations", "10"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const auto energy = readJson(folder_ / "out/metrics.json")["energy"];
  ASSERT_GT(energy["restarts"].get<int>(), 0) << "the run must move sites out of empty cells";
  const auto iterations = energy["iterations"].get<std::size_t>();
  EXPECT_LE(iterations, 10U);
  EXPECT_EQ(energy["history"].size(), 1 + iterations + energy["restarts"].get<std::size_t>());
  EXPECT_THAT(outcome.out, HasSubstr("optimization: " + std::to_string(iterations) + " iteration"));
}

// A single cell has no edge that the surface could cut.
TEST_F(Commands, TooFewSitesForASingleCellAreAFailureOfTheMethod) {
  for (const char* sites : {"1", "2"}) {
    const Outcome outcome = run({"tessellate", "shape:sphere", "-o", folder_ / "out", "--sites", sites});
    EXPECT_EQ(outcome.exitCode, 4);
    EXPECT_THAT(outcome.err, HasSubstr("use more sites"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }
}

}  // namespace
}  // namespace voroform::test
