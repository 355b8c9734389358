// The same bits: for any number of threads, from a stored form, and when measured anew.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace voroform::test {
namespace {

const std::vector<std::string> kFiles = {"cells.vtu",  "form.json", "form.vtu",
                                         "points.ply", "sites.ply", "surface.ply"};

// metrics.json without what may differ between equal runs.
std::string comparableMetrics(const std::filesystem::path& folder) {
  auto metrics = readJson(folder / "metrics.json");
  for (const char* key : {"seconds", "peak_memory_bytes", "threads"}) {
    EXPECT_EQ(metrics.erase(key), 1U) << key;
  }
  return metrics.dump(2);
}

class Reproducibility : public testing::Test {
 protected:
  void SetUp() override { cloud_ = folder_.write("torus.xyz", xyzText(torusPoints(1500))); }

  std::filesystem::path made(const std::string& name, std::vector<std::string> arguments,
                             const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), {"-o", folder_ / name, "--quiet"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return folder_ / name;
  }

  static void expectSame(const std::filesystem::path& a, const std::filesystem::path& b) {
    EXPECT_EQ(namesIn(a), namesIn(b));
    for (const std::string& name : kFiles) {
      // Compared as a truth value, because the files are too long to be printed.
      EXPECT_TRUE(readFile(a / name) == readFile(b / name)) << name;
    }
    EXPECT_EQ(comparableMetrics(a), comparableMetrics(b));
  }

  TemporaryFolder folder_;
  std::string cloud_;
  std::vector<std::string> few_ = {"--sites", "400", "--iterations", "4", "--seed", "3"};
};

TEST_F(Reproducibility, OneAndTwoThreadsGiveTheSameFiles) {
  const auto one = made("one", {"reconstruct", cloud_, "--threads", "1"}, few_);
  const auto two = made("two", {"reconstruct", cloud_, "--threads", "2"}, few_);
  expectSame(one, two);
  EXPECT_EQ(readJson(one / "metrics.json")["threads"], 1);
  EXPECT_EQ(readJson(two / "metrics.json")["threads"], 2);
}

TEST_F(Reproducibility, AnotherSeedGivesOtherCells) {
  const auto a = made("a", {"reconstruct", cloud_}, few_);
  const auto b = made("b", {"reconstruct", cloud_}, {"--sites", "400", "--iterations", "4", "--seed", "4"});
  EXPECT_FALSE(readFile(a / "cells.vtu") == readFile(b / "cells.vtu"));
  EXPECT_TRUE(readFile(a / "form.vtu") == readFile(b / "form.vtu"));
}

TEST_F(Reproducibility, TheStoredFormGivesTheSameFiles) {
  const auto whole = made("whole", {"reconstruct", cloud_}, few_);
  const auto form = made("form", {"implicit", cloud_}, {});
  EXPECT_THAT(namesIn(form), testing::ElementsAre("form.json", "form.vtu", "points.ply"));
  const auto parts = made("parts", {"tessellate", form / "form.vtu"}, few_);
  expectSame(whole, parts);
  const auto again = made("again", {"tessellate", whole / "form.vtu"}, few_);
  expectSame(whole, again);
}

// The same far from the origin, where the cloud's frame is shifted.
TEST_F(Reproducibility, TheStoredFormGivesTheSameFilesFarAway) {
  std::vector<OrientedPoint> points = torusPoints(1500);
  constexpr double kGrid = 1 << 20;  // coordinates on a grid, so that the shift is exact
  for (OrientedPoint& point : points) {
    point.position = (point.position * kGrid).array().round() / kGrid;
    point.position += Vec3(500'000, 4'500'000, 120);
  }
  const std::string far = folder_.write("far.xyz", xyzText(points));
  const auto whole = made("whole", {"reconstruct", far}, few_);
  const auto parts = made("parts", {"tessellate", whole / "form.vtu"}, few_);
  expectSame(whole, parts);
  const auto metrics = readJson(whole / "metrics.json");
  EXPECT_EQ(metrics["validity"]["valid"], true);
  // The volume of the torus, 2π²Rr².
  EXPECT_NEAR(metrics["fidelity"]["sampled_volume"].get<double>(), 3.158, 0.06);
}

TEST_F(Reproducibility, EvaluateFindsTheSameMetrics) {
  const auto folder = made("whole", {"reconstruct", cloud_}, few_);
  const std::string before = comparableMetrics(folder);
  const Outcome outcome = run({"evaluate", folder, "--threads", "1"});
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(comparableMetrics(folder), before);
  EXPECT_EQ(readJson(folder / "metrics.json")["threads"], 1);
}

TEST_F(Reproducibility, EvaluateFindsTheSameMetricsOfAShape) {
  const auto folder = made("shape", {"tessellate", "shape:ellipsoid"}, few_);
  EXPECT_THAT(namesIn(folder), testing::ElementsAre("cells.vtu", "metrics.json", "sites.ply", "surface.ply"));
  const std::string before = comparableMetrics(folder);
  EXPECT_EQ(run({"evaluate", folder}).exitCode, 0);
  EXPECT_EQ(comparableMetrics(folder), before);
}

TEST_F(Reproducibility, EvaluateNoticesForeignCells) {
  const auto folder = made("shape", {"tessellate", "shape:sphere"}, few_);
  const auto other = made("other", {"tessellate", "shape:sphere"}, {"--sites", "50"});
  std::filesystem::copy_file(other / "cells.vtu", folder / "cells.vtu",
                             std::filesystem::copy_options::overwrite_existing);
  const Outcome outcome = run({"evaluate", folder});
  EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.err, testing::HasSubstr("warning: cells.vtu has changed"));
  EXPECT_EQ(readJson(folder / "metrics.json")["counts"]["cells"], 50);
}

}  // namespace
}  // namespace voroform::test
