// Failures of the environment: exit 1, a message that names the path, and none of the run's files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace voroform::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(OutputFailure, PathBelowARegularFile) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "x");
  const std::string cloud = folder.write("torus.xyz", xyzText(torusPoints(500)));
  const std::vector<std::vector<std::string>> runs = {
      {"tessellate", "shape:sphere", "--sites", "50"}, {"reconstruct", cloud}, {"implicit", cloud}};
  for (std::vector<std::string> arguments : runs) {
    arguments.insert(arguments.end(), {"-o", file + "/below"});
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_THAT(outcome.err, HasSubstr(file));
  }
  const Outcome points = run({"points", cloud, "-o", file + "/points.ply"});
  EXPECT_EQ(points.exitCode, 1);
  const Outcome log = run({"info", cloud, "--log", file + "/log"});
  EXPECT_EQ(log.exitCode, 1);
  EXPECT_THAT(namesIn(folder / ""), ElementsAre("file", "torus.xyz"));
  EXPECT_EQ(readFile(file), "x");
}

// A long run must fail at its start: with these sites it would take far longer than the test's time limit.
TEST(OutputFailure, IsFoundBeforeTheWork) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "x");
  const Outcome outcome =
      run({"tessellate", "shape:torus", "-o", file + "/below", "--sites", "3000000", "--iterations", "100000"});
  EXPECT_EQ(outcome.exitCode, 1);
  EXPECT_THAT(outcome.err, HasSubstr("is not a folder"));
}

TEST(OutputFailure, MoreSitesThanMemoryAllows) {
  const TemporaryFolder folder;
  const Outcome vast = run({"tessellate", "shape:sphere", "-o", folder / "out", "--sites", "2000000000"});
  EXPECT_EQ(vast.exitCode, 1) << vast.err;
  EXPECT_THAT(vast.err, AllOf(HasSubstr("2000000000"), HasSubstr("memory")));
  const Outcome limited =
      run({"tessellate", "shape:sphere", "-o", folder / "out", "--sites", "100000", "--memory-limit", "1MB"});
  EXPECT_EQ(limited.exitCode, 1) << limited.err;
  EXPECT_THAT(limited.err, HasSubstr("memory"));
  EXPECT_THAT(namesIn(folder / ""), testing::IsEmpty());
}

// What the program prints is output as well.
TEST(OutputFailure, FullDevicesForWhatIsPrinted) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  const TemporaryFolder folder;
  const std::string cloud = folder.write("torus.xyz", xyzText(torusPoints(100)));
  EXPECT_EQ(run({"info", cloud}).exitCode, 0);
  const Outcome log = run({"points", cloud, "-o", folder / "points.ply", "--log", "/dev/full"});
  EXPECT_EQ(log.exitCode, 1);
  EXPECT_THAT(log.err, AllOf(HasSubstr("/dev/full"), HasSubstr("log")));
  for (const std::string& arguments : {std::string("--help"), "info '" + cloud + "'"}) {
    const Outcome printed = runCommand({"sh", "-c", "'" + programPath() + "' " + arguments + " > /dev/full"});
    EXPECT_EQ(printed.exitCode, 1) << arguments;
    EXPECT_THAT(printed.err, HasSubstr("standard output")) << arguments;
  }
}

// A write beyond the limit fails as it does on a full disk.
TEST(OutputFailure, DiskThatFillsUpLeavesNoneOfTheFiles) {
  const TemporaryFolder folder;
  RunOptions limited;
  limited.fileSizeLimit = 64 * 1024;
  const Outcome outcome = run({"tessellate", "shape:sphere", "-o", folder / "out", "--sites", "1000"}, limited);
  EXPECT_EQ(outcome.exitCode, 1) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("cells.vtu"));
  EXPECT_THAT(namesIn(folder / ""), testing::IsEmpty());
}

TEST(OutputFailure, DiskThatFillsUpKeepsAnEarlierRun) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  ASSERT_EQ(run({"tessellate", "shape:sphere", "-o", out, "--sites", "20"}).exitCode, 0);
  const std::vector<std::string> names = namesIn(out);
  const std::string metrics = readFile(folder / "out/metrics.json");
  RunOptions limited;
  limited.fileSizeLimit = 64 * 1024;
  EXPECT_EQ(run({"tessellate", "shape:sphere", "-o", out, "--sites", "1000"}, limited).exitCode, 1);
  EXPECT_EQ(namesIn(out), names);
  EXPECT_EQ(readFile(folder / "out/metrics.json"), metrics);
}

// The real thing, in a mount namespace of its own, where the system allows one; the test above needs no permission.
TEST(OutputFailure, SmallFileSystemThatFillsUp) {
  const TemporaryFolder folder;
  const std::string disk = folder / "disk";
  std::filesystem::create_directory(disk);
  const std::string mount = "mount -t tmpfs -o size=1m tmpfs '" + disk + "' || exit 99; ";
  if (runCommand({"unshare", "-rm", "sh", "-c", mount}).exitCode != 0) {
    GTEST_SKIP() << "this system lets nobody mount; DiskThatFillsUpLeavesNoneOfTheFiles has tested the like";
  }
  const std::string script = mount + "'" + programPath() + "' tessellate shape:sphere --sites 5000 -o '" + disk +
                             "/out'; code=$?; ls -A '" + disk + "' > '" + (folder / "left").string() + "'; exit $code";
  const Outcome outcome = runCommand({"unshare", "-rm", "sh", "-c", script});
  EXPECT_EQ(outcome.exitCode, 1) << outcome.err;
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("/out"), HasSubstr("No space left on device")));
  EXPECT_EQ(readFile(folder / "left"), "");
}

}  // namespace
}  // namespace voroform::test
