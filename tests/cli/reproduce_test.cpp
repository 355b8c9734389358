// reproduce: the thesis's figures beside ours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "program.hpp"
#include "voroform/baselines/cube_grid.hpp"
#include "voroform/core/error.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/pipeline/reproduce.hpp"

namespace voroform::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

TEST(Reproduce, TableOfBodiesAgreesInAllDigits) {
  const TemporaryFolder folder;
  const Outcome outcome = run({"reproduce", "3.1", "-o", folder / "out"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(namesIn(folder / "out"), ElementsAre("reproduce.csv", "reproduce.json", "reproduce.md"));
  EXPECT_THAT(outcome.out, HasSubstr("truncated octahedron"));
  const auto json = readJson(folder / "out/reproduce.json");
  ASSERT_EQ(json["figures"].size(), 9U);
  for (const auto& figure : json["figures"]) {
    EXPECT_NEAR(figure["ours"].get<double>(), figure["published"].get<double>(), 1e-7) << figure["data_set"];
    EXPECT_EQ(figure["page"], 40);
  }
}

TEST(RegularityOfBody, AgreesWithClosedForms) {
  EXPECT_NEAR(pipeline::regularityOfBody("cube"), 1.0 / 12, 1e-14);
  EXPECT_NEAR(pipeline::regularityOfBody("truncated octahedron"), 19 / (192 * std::cbrt(2.0)), 1e-14);
  // Edge a: ∫‖x − x̂‖² = 3/40·a²·V, V = a³/(6√2).
  EXPECT_NEAR(pipeline::regularityOfBody("tetrahedron"), 3.0 / 40 / 3 * std::pow(6 * std::sqrt(2.0), 2.0 / 3), 1e-12);
  EXPECT_NEAR(pipeline::regularityOfBody("sphere"), 0.2 / std::pow(4 * M_PI / 3, 2.0 / 3), 1e-8);
  EXPECT_THROW(pipeline::regularityOfBody("cone"), UsageError);
}

TEST(PublishedFigures, AreBuiltIn) {
  std::map<std::string, std::size_t> sizes;
  for (const std::string& table : pipeline::reproducibleTables()) {
    sizes[table] = pipeline::publishedFigures(table).size();
    for (const pipeline::PublishedFigure& figure : pipeline::publishedFigures(table)) {
      EXPECT_EQ(figure.table, table == "figure-5.7" ? "figure 5.7" : table);
      EXPECT_GE(figure.page, 40);
    }
  }
  EXPECT_EQ(sizes["3.1"], 9U);
  EXPECT_EQ(sizes["5.1"], 24U * 6 - 2 * 4);  // Delaunay refinement has no regularity
  EXPECT_EQ(sizes["5.2"], 24U);
  EXPECT_EQ(sizes["5.3"], 24U);
  EXPECT_EQ(sizes["5.4"], 28U);
  for (const pipeline::PublishedFigure& figure : pipeline::publishedFigures("5.1")) {
    if (figure.dataSet == "DANCER" && figure.method == "cvt2" && figure.criterion == "Gmean") {
      EXPECT_EQ(figure.value, 8.03);
      EXPECT_EQ(figure.sites, 14474);
      EXPECT_EQ(figure.page, 82);
    }
  }
  EXPECT_THROW(pipeline::publishedFigures("9.9"), UsageError);
}

TEST(ResolutionFor, FindsTheNearestNumberOfSites) {
  const auto torus = implicit::torus(1.0, 0.4);
  const Box3 box = baselines::solidBox(*torus, {});
  const auto count = [&](Index resolution) {
    return baselines::insideCubes(*torus, baselines::gridOf(box, resolution), {});
  };
  for (const Index wanted : {200, 2365, 14474}) {
    const Index resolution = pipeline::resolutionFor(*torus, wanted, {});
    const Index error = std::abs(count(resolution) - wanted);
    for (const Index other : {resolution - 1, resolution + 1}) {
      EXPECT_LE(error, std::abs(count(other) - wanted)) << wanted << ": " << resolution << " or " << other;
    }
  }
  EXPECT_EQ(pipeline::resolutionFor(*torus, 1, {}), 4);
}

TEST(Reproduce, StandsInForWhatCannotBeHad) {
  const TemporaryFolder folder;
  folder.write("kitten.xyz", xyzText(torusPoints(1500)));
  const Outcome outcome = run({"reproduce", "5.1", "-o", folder / "out", "--data", folder / "", "--data-sets",
                               "DANCER LOW", "--iterations", "2", "--delaunay-time-limit", "60"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_THAT(outcome.out, AllOf(HasSubstr("For DANCER LOW (2365 sites) stands"), HasSubstr("kitten.xyz")));
  const auto json = readJson(folder / "out/reproduce.json");
  EXPECT_NEAR(json["stand_ins"][0]["sites"].get<double>(), 2365, 240);
  ASSERT_EQ(json["figures"].size(), 28U);
  for (const auto& figure : json["figures"]) {
    ASSERT_FALSE(figure.contains("failure")) << figure.dump();
    EXPECT_NEAR(figure["difference"].get<double>(), figure["ours"].get<double>() - figure["published"].get<double>(),
                1e-12);
    if (figure["criterion"] == "Gmean" && figure["method"] == "cvt1") {
      EXPECT_NEAR(figure["ours"].get<double>(), 8.3, 0.4);  // as published, times 100
      EXPECT_NEAR(figure["published_ratio_to_mc"].get<double>(), 8.18 / 19.30, 1e-12);
    }
  }
}

TEST(Reproduce, SaysOfHowManyRunsAFigureIs) {
  const TemporaryFolder folder;
  const auto remark = [&](const std::string& table, const std::string& dataSet, const std::string& seeds) {
    const Outcome outcome =
        run({"reproduce", table, "-o", folder / "out", "--data-sets", dataSet, "--iterations", "1", "--seeds", seeds});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    return readJson(folder / "out/reproduce.json")["remarks"][0].get<std::string>();
  };
  EXPECT_THAT(remark("figure-3.8", "square", "2"),
              AllOf(HasSubstr("each figure is of one run"), Not(HasSubstr("median"))));
  // The lattice's row is of one run.
  EXPECT_THAT(remark("4.4", "square", "2"),
              AllOf(HasSubstr("of 2 seeds the median"), HasSubstr("without these two is of one run")));
  const auto json = readJson(folder / "out/reproduce.json");
  for (const auto& figure : json["figures"]) {
    EXPECT_EQ(figure["lowest"].is_null(), figure["method"] == "lattice") << figure.dump();
  }
}

TEST(Reproduce, ReadsARankingForTheFigure) {
  const TemporaryFolder folder;
  ASSERT_EQ(run({"rank", "shape:sphere", "shape:torus", "shape:ellipsoid", "-o", folder / "ranks", "--methods",
                 "mc,cvt1,cvt2", "--resolution", "8", "--no-dual", "--no-equal-triangles"})
                .exitCode,
            0);
  const Outcome outcome = run({"reproduce", "5.7", "-o", folder / "out", "--ranking", folder / "ranks"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const auto json = readJson(folder / "out/reproduce.json");
  ASSERT_EQ(json["figures"].size(), 20U);
  for (const auto& figure : json["figures"]) {
    const bool withDelaunay = figure["criterion"].get<std::string>().ends_with("delaunay");
    EXPECT_EQ(figure.contains("failure"), withDelaunay) << figure.dump();
  }
}

TEST(Reproduce, RefusesBadRequests) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const Outcome table = run({"reproduce", "5.9", "-o", out});
  EXPECT_EQ(table.exitCode, 2);
  EXPECT_THAT(table.err, AllOf(HasSubstr("5.9"), HasSubstr("figure-5.7")));
  const Outcome dataSet = run({"reproduce", "5.2", "-o", out, "--data-sets", "SKULL"});
  EXPECT_EQ(dataSet.exitCode, 2);
  EXPECT_THAT(dataSet.err, AllOf(HasSubstr("SKULL"), HasSubstr("AQUARIUS")));
  EXPECT_EQ(run({"reproduce", "5.1", "-o", out, "--ranking", out}).exitCode, 2);
  const Outcome data = run({"reproduce", "5.1", "-o", out, "--data", folder / "none"});
  EXPECT_EQ(data.exitCode, 3);
  EXPECT_THAT(data.err, HasSubstr("fetch-scans"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

}  // namespace
}  // namespace voroform::test
