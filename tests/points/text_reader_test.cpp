// XYZ, XYZN, PWN and TXT.
#include <gmock/gmock.h>

#include <clocale>

#include "support.hpp"

namespace voroform::points::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(TextReader, ReadsThreeColumns) {
  const Outcome outcome = readBytes("# a comment\n\n  1 2\t3 \r\n// another\n4.5 -5e-1 +6 # behind\n7 8 9", ".xyz");
  EXPECT_EQ(outcome.error, "");
  EXPECT_THAT(outcome.warnings, IsEmpty());
  EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(4.5, -0.5, 6), Vec3(7, 8, 9)));
  EXPECT_FALSE(outcome.result.cloud.hasNormals());
  EXPECT_EQ(outcome.result.summary.format, "text with 3 columns");
  EXPECT_EQ(outcome.result.summary.records, 3U);
}

TEST(TextReader, PassesOverAByteOrderMark) {
  const std::string mark = "\xEF\xBB\xBF";
  const Outcome outcome = readBytes(mark + "1 2 3\n4 5 6\n", ".xyz");
  EXPECT_EQ(outcome.error, "");
  EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  // Only at the beginning.
  EXPECT_EQ(readBytes("1 2 3\n" + mark + "4 5 6\n", ".xyz").error,
            "file:2: expected a number in column 1, found \"\\xef\\xbb\\xbf4\"");
}

TEST(TextReader, ReadsNormalsFromColumnsFourToSix) {
  for (const std::string format : {".xyz", ".xyzn", ".pwn", ".txt"}) {
    const Outcome outcome = readBytes("1 2 3 0 0 -1 99\n4 5 6 0.6 0.8 0 99\n", format);
    EXPECT_EQ(outcome.error, "");
    EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
    EXPECT_THAT(outcome.result.cloud.normals, ElementsAre(Vec3(0, 0, -1), Vec3(0.6, 0.8, 0)));
    EXPECT_TRUE(outcome.result.summary.normals);
  }
}

TEST(TextReader, TakesFourAndFiveColumnsAsPositionsAndOthers) {
  const Outcome outcome = readBytes("1 2 3 4\n5 6 7 8\n", ".txt");
  EXPECT_EQ(outcome.error, "");
  EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(5, 6, 7)));
  EXPECT_FALSE(outcome.result.cloud.hasNormals());
}

TEST(TextReader, AcceptsCommasAndSemicolonsButOneKindAFile) {
  EXPECT_THAT(readBytes("1,2,3\n4 , 5,\t6,\n", ".txt").result.cloud.positions,
              ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  EXPECT_THAT(readBytes("1;2;3\n4;5;6\n", ".txt").result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  // Decimal commas would otherwise pass as twice the columns.
  EXPECT_EQ(readBytes("1,5 2,5 3,5\n", ".txt").error,
            "file:1: expected a comma between numbers as before, found a blank (decimal commas are not supported)");
  EXPECT_EQ(readBytes("1;2;3\n1,5;2,5;3,5\n", ".txt").error,
            "file:2: expected a semicolon between numbers as before, found a comma (decimal commas are not supported)");
  EXPECT_EQ(readBytes("1,,3\n", ".txt").error, "file:1: expected a number in column 2, found \",\"");
}

TEST(TextReader, IgnoresColorsWithAWarning) {
  const Outcome outcome = readBytes("1 2 3 255 128 0\n4 5 6 0 0 1\n", ".xyz");
  EXPECT_EQ(outcome.error, "");
  EXPECT_FALSE(outcome.result.cloud.hasNormals());
  EXPECT_FALSE(outcome.result.summary.normals);
  EXPECT_THAT(outcome.warnings, ElementsAre("file: columns 4 to 6 hold integers from 0 to 255: taken as colors and "
                                            "ignored, not as normals"));
  // Axis-parallel normals and longer ones that are no colors stay normals.
  EXPECT_TRUE(readBytes("1 2 3 1 0 0\n4 5 6 0 0 1\n", ".xyz").result.cloud.hasNormals());
  EXPECT_TRUE(readBytes("1 2 3 255 128 0\n4 5 6 0 0 -1\n", ".xyz").result.cloud.hasNormals());
}

TEST(TextReader, ReadsACountBeforeThePoints) {
  const Outcome outcome = readBytes("2\n1 2 3 0 0 1\n4 5 6 0 1 0\n", ".pwn");
  EXPECT_EQ(outcome.error, "");
  EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  EXPECT_THAT(outcome.result.cloud.normals, ElementsAre(Vec3(0, 0, 1), Vec3(0, 1, 0)));
  // All positions first, then all normals.
  const Outcome blocks = readBytes("2\n1 2 3\n4 5 6\n0 0 1\n0 1 0\n", ".pwn");
  EXPECT_EQ(blocks.error, "");
  EXPECT_THAT(blocks.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  EXPECT_THAT(blocks.result.cloud.normals, ElementsAre(Vec3(0, 0, 1), Vec3(0, 1, 0)));
  EXPECT_TRUE(blocks.result.summary.normals);
}

TEST(TextReader, DoesNotDependOnTheLocale) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8"}) std::setlocale(LC_ALL, name);
  const Outcome outcome = readBytes("1.5 2.5 3.5\n", ".xyz");
  std::setlocale(LC_ALL, before.c_str());
  EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(1.5, 2.5, 3.5)));
}

TEST(TextReader, ReadsNumbersExactly) {
  const Outcome outcome = readBytes(
      "0.1 4500000.000001 -1.734723475977e-018\n"
      "9007199254740993 0.30000000000000004 2.2250738585072011e-308\n"
      "000000000000000000000000000000000000000000000000000000000000000000000001 "
      "0.0000000000000000000000000000000000000000000000000000000000000000000001 1e-400\n",
      ".xyz");
  EXPECT_EQ(outcome.error, "");
  EXPECT_THAT(outcome.result.cloud.positions,
              ElementsAre(Vec3(0.1, 4500000.000001, -1.734723475977e-018),
                          Vec3(9007199254740992, 0.30000000000000004, 2.2250738585072011e-308), Vec3(1, 1e-70, 0)));
}

TEST(TextReader, NamesThePlaceOfEveryFault) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "file: the file is empty"},
      {"# only this\n\n", "file: the file holds no points"},
      {"1 2\n", "file:1: expected 3 or more columns, found 2"},
      {"1 2 3\n\n4 5\n", "file:3: expected 3 columns as before, found 2"},
      {"1 2 3\n4 5 6 7\n", "file:2: expected 3 columns as before, found 4"},
      {"x y z\n1 2 3\n", "file:1: expected a number in column 1, found \"x\""},
      {"1 2 3\n4 5 six;\n", "file:2: expected a number in column 3, found \"six\""},
      {"1 2 3\n4 5 6m\n", "file:2: expected a number in column 3, found \"6m\""},
      {"1 2 3\n4 5 0x6\n", "file:2: expected a number in column 3, found \"0x6\""},
      {"1 2 3\r4 5 6\r", "file:1: expected a number in column 3, found \"3\\x0d4\""},
      {"1.5\n1 2 3\n",
       "file:1: expected the number of points or 3 or more columns, found 1 column that is no positive integer"},
      {"nan\n1 2 3\n",
       "file:1: expected the number of points or 3 or more columns, found 1 column that is no positive integer"},
      {"4000000000\n1 2 3\n", "file: declares 4000000000 points, file ends after record 1 (byte 17)"},
      {"2\n1 2 3\n4 5 6\n7 8 9\n", "file: declares 2 points and as many normals, file ends after record 3 (byte 20)"},
      {"1\n1 2 3\n0 0 1\n7 8 9\n",
       "file:4: expected the end of the file after the declared 1 points, found one more line"},
      {"1\n1 2 3 0 0 1\n1 2 3 0 0 1\n",
       "file:3: expected the end of the file after the declared 1 points, found one more line"},
      {"2\n", "file: declares 2 points, file ends after record 0 (byte 2)"}};
  for (const auto& [bytes, message] : cases) EXPECT_EQ(readBytes(bytes, ".xyz").error, message) << bytes;
}

}  // namespace
}  // namespace voroform::points::test
