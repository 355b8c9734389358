// What is said of sites that were lost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "measuring.hpp"

namespace voroform::pipeline {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> warningsOfEmptySites(Index emptySites) {
  std::vector<std::string> warnings;
  RunContext context;
  context.log = [&](LogLevel level, std::string_view message) {
    if (level == LogLevel::warning) warnings.emplace_back(message);
  };
  cvt::TessellateSummary summary;
  summary.emptySites = emptySites;
  warnOfClipping(summary, context);
  return warnings;
}

TEST(TessellationWarnings, SitesWithoutACell) {
  EXPECT_THAT(warningsOfEmptySites(0), IsEmpty());
  EXPECT_THAT(warningsOfEmptySites(1),
              ElementsAre("1 site ended without a cell and was dropped: some parts of the solid are thinner than the "
                          "cell size; more sites help"));
  EXPECT_THAT(warningsOfEmptySites(2),
              ElementsAre("2 sites ended without a cell and were dropped: some parts of the solid are thinner than the "
                          "cell size; more sites help"));
}

}  // namespace
}  // namespace voroform::pipeline
