// Options from TOML files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace voroform::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Outcome tessellateWith(const TemporaryFolder& folder, const std::string& toml,
                       const std::vector<std::string>& more = {}) {
  const std::string config = folder.write("run.toml", toml);
  std::vector<std::string> arguments = {"tessellate", "shape:sphere", "--config", config};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run(arguments);
}

TEST(ConfigFile, GivesOptionsByTheirLongNames) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const Outcome outcome = tessellateWith(folder,
                                         "# a run\nsites = 60\nmethod = \"cvt1\"\niterations = 2\nquiet = true\n"
                                         "relative-error = 0.25\nformats = [\"obj\", \"adjacency\"]\n"
                                         "seed = 7\noutput = \"" +
                                             out + "\"\n");
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(outcome.out, "");
  const auto metrics = readJson(folder / "out/metrics.json");
  EXPECT_EQ(metrics["options"]["sites"], 60);
  EXPECT_EQ(metrics["options"]["method"], "cvt1");
  EXPECT_EQ(metrics["options"]["iterations"], 2);
  EXPECT_EQ(metrics["options"]["relative_error"], 0.25);
  EXPECT_EQ(metrics["options"]["formats"].dump(), "[\"obj\",\"adjacency\"]");
  EXPECT_EQ(metrics["seed"], 7);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/surface.obj"));
}

TEST(ConfigFile, YieldsToTheCommandLine) {
  const TemporaryFolder folder;
  const Outcome outcome =
      tessellateWith(folder, "sites = 60\niterations = 1\n", {"--sites", "40", "-o", folder / "out"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const auto metrics = readJson(folder / "out/metrics.json");
  EXPECT_EQ(metrics["options"]["sites"], 40);
  EXPECT_EQ(metrics["options"]["iterations"], 1);
}

TEST(ConfigFile, RefusesUnknownKeysWithTheirLine) {
  const TemporaryFolder folder;
  const Outcome outcome = tessellateWith(folder, "sites = 60\n\ncolor = \"red\"\n", {"-o", folder / "out"});
  EXPECT_EQ(outcome.exitCode, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("run.toml:3:"), HasSubstr("color")));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(ConfigFile, RefusesBadValuesWithTheirLine) {
  const TemporaryFolder folder;
  const Outcome range = tessellateWith(folder, "iterations = 3\nsites = 0\n", {"-o", folder / "out"});
  EXPECT_EQ(range.exitCode, 2);
  EXPECT_THAT(range.err, AllOf(HasSubstr("run.toml:2:"), HasSubstr("sites"), HasSubstr("[1, 2147483647]")));
  const Outcome type = tessellateWith(folder, "sites = \"many\"\n", {"-o", folder / "out"});
  EXPECT_EQ(type.exitCode, 2);
  EXPECT_THAT(type.err, AllOf(HasSubstr("run.toml:1:"), HasSubstr("many")));
  const Outcome table = tessellateWith(folder, "[sites]\nnumber = 3\n", {"-o", folder / "out"});
  EXPECT_EQ(table.exitCode, 2);
  EXPECT_THAT(table.err, AllOf(HasSubstr("run.toml:1:"), HasSubstr("sites")));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(ConfigFile, FlagsAreTrueOrFalse) {
  const TemporaryFolder folder;
  for (const char* value : {"3", "\"yes\"", "[true]"}) {
    const Outcome outcome =
        tessellateWith(folder, std::string("sites = 60\nquiet = ") + value + "\n", {"-o", folder / "out"});
    EXPECT_EQ(outcome.exitCode, 2) << value;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("run.toml:2:"), HasSubstr("true or false")));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

TEST(ConfigFile, IsAFile) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run({"tessellate", "shape:sphere", "--sites", "60", "-o", folder / "out", "--config", folder / ""});
  EXPECT_EQ(outcome.exitCode, 2);
  EXPECT_THAT(outcome.err, HasSubstr("folder"));
}

TEST(ConfigFile, RefusesWhatIsNotToml) {
  const TemporaryFolder folder;
  const Outcome syntax = tessellateWith(folder, "sites = 60\nmethod = = 2\n", {"-o", folder / "out"});
  EXPECT_EQ(syntax.exitCode, 2);
  EXPECT_THAT(syntax.err, HasSubstr("run.toml:2:"));
  const Outcome missing = run({"tessellate", "shape:sphere", "--config", folder / "none.toml"});
  EXPECT_EQ(missing.exitCode, 2);
  EXPECT_THAT(missing.err, HasSubstr("none.toml"));
}

}  // namespace
}  // namespace voroform::test
