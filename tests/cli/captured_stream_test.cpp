#include "captured_stream.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <vector>

namespace voroform::cli {
namespace {

TEST(CapturedStream, HandsOverLinesAndGivesTheStreamBack) {
  std::ostringstream stream;
  stream << "before\n";
  std::vector<std::string> lines;
  {
    const CapturedStream captured(stream, [&lines](std::string_view line) { lines.emplace_back(line); });
    stream << "N = " << 3 << '\n' << "\nsecond" << ' ' << "line" << std::endl << "without an end";
    EXPECT_THAT(lines, testing::ElementsAre("N = 3", "second line"));
  }
  stream << "after\n";
  EXPECT_THAT(lines, testing::ElementsAre("N = 3", "second line", "without an end"));
  EXPECT_EQ(stream.str(), "before\nafter\n");
}

}  // namespace
}  // namespace voroform::cli
