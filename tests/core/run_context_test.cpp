#include "voroform/core/run_context.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <string>
#include <utility>
#include <vector>

#include "voroform/core/error.hpp"

namespace voroform {
namespace {

TEST(RunContext, WithoutSinksIsSilent) {
  const RunContext context;
  EXPECT_NO_THROW(context.report("stage", 0.5));
  EXPECT_NO_THROW(context.warn("message"));
  EXPECT_NO_THROW(context.throwIfCancelled());
}

TEST(RunContext, PassesProgressAndMessagesOn) {
  std::vector<std::pair<std::string, double>> progress;
  std::vector<std::pair<LogLevel, std::string>> log;
  RunContext context;
  context.progress = [&](std::string_view stage, double share) { progress.emplace_back(stage, share); };
  context.log = [&](LogLevel level, std::string_view message) { log.emplace_back(level, message); };
  context.report("clipping", 0.25);
  context.debug("a");
  context.info("b");
  context.warn("c");
  EXPECT_THAT(progress, testing::ElementsAre(testing::Pair("clipping", 0.25)));
  EXPECT_THAT(log, testing::ElementsAre(testing::Pair(LogLevel::debug, "a"), testing::Pair(LogLevel::info, "b"),
                                        testing::Pair(LogLevel::warning, "c")));
}

TEST(RunContext, ThrowsOnceCancelled) {
  std::atomic<bool> cancelled{false};
  RunContext context;
  context.cancelled = &cancelled;
  EXPECT_NO_THROW(context.throwIfCancelled());
  cancelled = true;
  EXPECT_THROW(context.throwIfCancelled(), Cancelled);
}

}  // namespace
}  // namespace voroform
