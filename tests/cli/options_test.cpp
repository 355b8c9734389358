// Usage: help, versions, unknown options, values out of range.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace voroform::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::vector<std::string> kCommands = {"reconstruct", "points", "implicit", "tessellate", "evaluate", "info"};

TEST(Options, EveryCommandHasHelpWithItsDefaults) {
  for (const std::string& command : kCommands) {
    const Outcome outcome = run({command, "--help"});
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_THAT(outcome.out, AllOf(HasSubstr("--threads"), HasSubstr("--seed"), HasSubstr("--quiet"),
                                   HasSubstr("--verbose"), HasSubstr("--log"), HasSubstr("--config")))
        << command;
  }
  const std::string help = run({"tessellate", "--help"}).out;
  EXPECT_THAT(help,
              AllOf(HasSubstr("15000"), HasSubstr("cvt3"), HasSubstr("lbfgs"), HasSubstr("itp"), HasSubstr("0.02")));
}

TEST(Options, GeneralHelpNamesTheCommands) {
  const Outcome outcome = run({"--help"});
  EXPECT_EQ(outcome.exitCode, 0);
  for (const std::string& command : kCommands) EXPECT_THAT(outcome.out, HasSubstr(command));
}

TEST(Options, VersionIsPrinted) {
  const Outcome outcome = run({"--version"});
  EXPECT_EQ(outcome.exitCode, 0);
  EXPECT_THAT(outcome.out, testing::MatchesRegex("voroform [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

struct Misuse {
  const char* name;
  std::vector<std::string> options;
  std::vector<std::string> said;
};

void PrintTo(const Misuse& misuse, std::ostream* out) { *out << misuse.name; }

class Misused : public testing::TestWithParam<Misuse> {};

TEST_P(Misused, IsRefusedWithTheOptionTheValueAndTheRange) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = {"tessellate", "shape:sphere", "-o", folder / "out"};
  const Misuse& misuse = GetParam();
  arguments.insert(arguments.end(), misuse.options.begin(), misuse.options.end());
  const Outcome outcome = run(arguments);
  EXPECT_EQ(outcome.exitCode, 2);
  for (const std::string& text : misuse.said) EXPECT_THAT(outcome.err, HasSubstr(text));
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
}

INSTANTIATE_TEST_SUITE_P(
    Options, Misused,
    testing::Values(Misuse{"ZeroSites", {"--sites", "0"}, {"--sites", "0 is not in [1, 2147483647]"}},
                    Misuse{"NegativeSites", {"--sites", "-5"}, {"--sites", "-5"}},
                    Misuse{"SitesAsText", {"--sites", "many"}, {"--sites", "many"}},
                    Misuse{"SitesBeyondIndices", {"--sites", "3000000000"}, {"--sites", "3000000000"}},
                    Misuse{"NegativeIterations", {"--iterations", "-1"}, {"--iterations", "-1 is not in [0, 1000000]"}},
                    Misuse{"UnknownMethod", {"--method", "cvt9"}, {"--method", "cvt9", "cvt1, cvt2, cvt3"}},
                    Misuse{"UnknownOptimizer", {"--optimizer", "newton"}, {"--optimizer", "newton", "lbfgs, lloyd"}},
                    Misuse{"UnknownRootFinder", {"--root-finder", "guess"}, {"--root-finder", "itp, bisection"}},
                    Misuse{"NegativeRelativeError", {"--relative-error", "-0.5"}, {"--relative-error", "-0.5"}},
                    Misuse{"UnknownFormat", {"--formats", "obj,doc"}, {"--formats", "doc", "obj,off,stl,adjacency"}},
                    Misuse{"NegativeThreads", {"--threads", "-1"}, {"--threads", "-1"}},
                    Misuse{"NegativeSeed", {"--seed", "-1"}, {"--seed", "-1 is not in"}},
                    Misuse{"SeedBeyond64Bits", {"--seed", "18446744073709551616"}, {"--seed", "18446744073709551616"}},
                    Misuse{"NegativeMemory", {"--memory-limit", "-5"}, {"--memory-limit", "-5"}},
                    Misuse{"UnknownOption", {"--colour", "red"}, {"--colour"}},
                    Misuse{"EnvelopeOfAShape", {"--envelope", "box"}, {"--envelope", "shape:sphere"}}),
    [](const testing::TestParamInfo<Misuse>& tested) { return std::string(tested.param.name); });

struct Meaningless {
  const char* name;
  std::vector<std::string> options;
  std::vector<std::string> said;            // the option without meaning, and the one that it lacks
  std::vector<std::string> withoutMistake;  // options that give it one
};

void PrintTo(const Meaningless& meaningless, std::ostream* out) { *out << meaningless.name; }

class MeaninglessOptions : public testing::TestWithParam<Meaningless> {};

TEST_P(MeaninglessOptions, AreRefusedInSpaceAndInThePlane) {
  const TemporaryFolder folder;
  const Meaningless& meaningless = GetParam();
  for (const std::string input : {"shape:sphere", "shape2d:disc"}) {
    const auto outcome = [&](const std::vector<std::string>& options) {
      std::vector<std::string> arguments = {"tessellate", input, "-o", folder / "out", "--iterations", "0"};
      arguments.insert(arguments.end(), meaningless.options.begin(), meaningless.options.end());
      arguments.insert(arguments.end(), options.begin(), options.end());
      return run(arguments);
    };
    const Outcome refused = outcome({});
    EXPECT_EQ(refused.exitCode, 2) << input;
    for (const std::string& text : meaningless.said) EXPECT_THAT(refused.err, HasSubstr(text)) << input;
    EXPECT_FALSE(std::filesystem::exists(folder / "out"));
    const Outcome control = outcome(meaningless.withoutMistake);
    EXPECT_EQ(control.exitCode, 0) << input << control.err;
    std::filesystem::remove_all(folder / "out");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Options, MeaninglessOptions,
    testing::Values(Meaningless{"SubdivisionsWithoutAHierarchy",
                                {"--sites", "100", "--subdivisions", "1"},
                                {"--subdivisions: has no meaning", "--init hierarchical-random"},
                                {"--init", "hierarchical-random"}},
                    Meaningless{"RuleWithoutAHierarchy",
                                {"--sites", "100", "--subdivision-rule", "insertion"},
                                {"--subdivision-rule: has no meaning", "--init hierarchical-random"},
                                {"--init", "hierarchical-lattice"}},
                    Meaningless{"PerturbationsWithoutMonteCarlo",
                                {"--sites", "50", "--perturbations", "2"},
                                {"--perturbations: has no meaning", "--optimizer monte-carlo"},
                                {"--optimizer", "monte-carlo"}},
                    Meaningless{"RatioWithoutADensity",
                                {"--sites", "50", "--density-ratio", "2"},
                                {"--density-ratio: has no meaning", "--density boundary"},
                                {"--density", "boundary"}},
                    Meaningless{"WidthWithoutADensity",
                                {"--sites", "50", "--density-width", "0.5"},
                                {"--density-width: has no meaning", "--density boundary"},
                                {"--density", "boundary"}}),
    [](const testing::TestParamInfo<Meaningless>& tested) { return std::string(tested.param.name); });

TEST(Options, WidthHasNoMeaningForCurvature) {
  const TemporaryFolder folder;
  const Outcome outcome =
      run({"tessellate", "shape:torus", "-o", folder / "out", "--density", "curvature", "--density-width", "0.5"});
  EXPECT_EQ(outcome.exitCode, 2);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("--density-width: has no meaning"), HasSubstr("--density boundary")));
}

TEST(Options, AFileOfSitesSaysHowManyThereAre) {
  const TemporaryFolder folder;
  const std::string file = folder.write("sites.xyz", "0.1 0 0\n-0.1 0 0\n0 0.3 0\n");
  const Outcome refused = run({"tessellate", "shape:sphere", "-o", folder / "out", "--init", file, "--sites", "7"});
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_THAT(refused.err, AllOf(HasSubstr("--sites: has no meaning"), HasSubstr("--init " + file)));
  const Outcome outcome =
      run({"tessellate", "shape:sphere", "-o", folder / "out", "--init", file, "--iterations", "0"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  const auto metrics = readJson(folder / "out/metrics.json");
  EXPECT_EQ(metrics["options"]["sites"], 3);
  EXPECT_EQ(metrics["counts"]["sites"], 3);
}

// As a key of a configuration file, too.
TEST(Options, MeaninglessKeysAreRefused) {
  const TemporaryFolder folder;
  const std::string config = folder.write("run.toml", "subdivisions = 2\n");
  const Outcome outcome = run({"tessellate", "shape:sphere", "-o", folder / "out", "--config", config});
  EXPECT_EQ(outcome.exitCode, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--subdivisions: has no meaning"));
}

TEST(Options, TheLargestSeedIsOne) {
  const TemporaryFolder folder;
  const Outcome outcome = run({"tessellate", "shape:sphere", "-o", folder / "out", "--sites", "40", "--iterations", "0",
                               "--seed", "18446744073709551615"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_EQ(readJson(folder / "out/metrics.json")["seed"], 18446744073709551615U);
}

TEST(Options, FormatsMayBeSetOffByBlanks) {
  const TemporaryFolder folder;
  const Outcome outcome = run({"tessellate", "shape:sphere", "-o", folder / "out", "--sites", "40", "--iterations", "0",
                               "--formats", "obj, off"});
  ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder / "out/surface.off"));
}

// More threads than cores are no reason for a library to print.
TEST(Options, ManyThreadsPrintNothing) {
  const TemporaryFolder folder;
  const Outcome outcome = run({"tessellate", "shape:sphere", "-o", folder / "out", "--sites", "1000", "--iterations",
                               "1", "--threads", "1000", "--quiet"});
  EXPECT_EQ(outcome.exitCode, 0);
  EXPECT_EQ(outcome.err, "");
}

TEST(Options, EveryMistakeIsReportedInTheSameWay) {
  const std::vector<std::vector<std::string>> mistakes = {
      {}, {"frobnicate"}, {"tessellate"}, {"tessellate", "shape:sphere", "--colour"}, {"info", "a", "b"}};
  for (const std::vector<std::string>& arguments : mistakes) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 2);
    EXPECT_THAT(outcome.err, AllOf(testing::StartsWith("voroform: error: "), HasSubstr("see voroform")));
  }
}

TEST(Options, MarginIsAShareOfTheDiagonal) {
  for (const char* value : {"-0.1", "1.5", "nan"}) {
    const Outcome outcome = run({"implicit", "cloud.xyz", "-o", "out", "--margin", value});
    EXPECT_EQ(outcome.exitCode, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("--margin"), HasSubstr(value), HasSubstr("[0, 1]")));
  }
}

TEST(Options, UnknownCommandsAndMissingArgumentsAreUsageErrors) {
  const Outcome unknown = run({"frobnicate"});
  EXPECT_EQ(unknown.exitCode, 2);
  EXPECT_THAT(unknown.err, HasSubstr("frobnicate"));
  EXPECT_EQ(run({}).exitCode, 2);
  EXPECT_EQ(run({"tessellate"}).exitCode, 2);
  const Outcome noOutput = run({"tessellate", "shape:sphere"});
  EXPECT_EQ(noOutput.exitCode, 2);
  EXPECT_THAT(noOutput.err, HasSubstr("--output"));
  const Outcome shape = run({"tessellate", "shape:banana", "-o", "out"});
  EXPECT_EQ(shape.exitCode, 2);
  EXPECT_THAT(shape.err, AllOf(HasSubstr("banana"), HasSubstr("torus")));
}

}  // namespace
}  // namespace voroform::test
