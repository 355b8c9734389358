// Interrupted runs end with status 130 and leave nothing behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "program.hpp"

namespace voroform::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A run that takes minutes, so that the signal always comes first.
std::vector<std::string> longRun(const std::string& output) {
  return {"tessellate", "shape:torus", "-o", output, "--sites", "200000", "--iterations", "100000"};
}

RunOptions interruptedBy(int signal) {
  RunOptions options;
  options.signal = signal;
  options.sendSignalWhen = [](const std::string& err) { return !err.empty(); };
  return options;
}

TEST(Interrupt, EndsWith130AndLeavesNothing) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    const Outcome outcome = run(longRun(folder / "out"), interruptedBy(signal));
    EXPECT_EQ(outcome.exitCode, 130) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("interrupted"));
    EXPECT_THAT(namesIn(folder / ""), IsEmpty());
  }
}

TEST(Interrupt, KeepsTheFilesOfAnEarlierRun) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  std::filesystem::create_directory(out);
  folder.write("out/metrics.json", "earlier");
  const Outcome outcome = run(longRun(out), interruptedBy(SIGINT));
  EXPECT_EQ(outcome.exitCode, 130) << outcome.err;
  EXPECT_THAT(namesIn(out), ElementsAre("metrics.json"));
  EXPECT_EQ(readFile(folder / "out/metrics.json"), "earlier");
}

// The solver of the Poisson form cannot be cancelled: the program ends all the same, and soon.
TEST(Interrupt, EndsDuringThePoissonSolver) {
  const TemporaryFolder folder;
  const std::string cloud = folder.write("torus.xyz", xyzText(torusPoints(60000)));
  const auto start = std::chrono::steady_clock::now();
  auto signaled = start;
  RunOptions options = interruptedBy(SIGINT);
  options.sendSignalWhen = [&signaled](const std::string& err) {
    signaled = std::chrono::steady_clock::now();
    return err.find("Poisson") != std::string::npos;
  };
  const Outcome outcome =
      run({"reconstruct", cloud, "-o", folder / "out", "--sites", "100000", "--iterations", "100000"}, options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - signaled).count();
  EXPECT_EQ(outcome.exitCode, 130) << outcome.err;
  EXPECT_LT(seconds, 10);
  EXPECT_THAT(namesIn(folder / ""), ElementsAre("torus.xyz"));
}

}  // namespace
}  // namespace voroform::test
