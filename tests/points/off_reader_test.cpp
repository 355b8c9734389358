// OFF and its variants.
#include <gmock/gmock.h>

#include "support.hpp"

namespace voroform::points::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(OffReader, ReadsVerticesAndCountsFaces) {
  for (const std::string start : {"OFF\n3 1 0\n", "# first\nOFF # kind\n\n3 1\n", "OFF 3 1 3\r\n"}) {
    const Outcome outcome = readBytes(start + "0 0 0\n1 0 0 # second\n\n0 1 .5\n3 0 1 2 255 0 0\n", ".off");
    EXPECT_EQ(outcome.error, "");
    EXPECT_THAT(outcome.warnings, IsEmpty());
    EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0.5)));
    EXPECT_EQ(outcome.result.summary.faces, 1U);
    EXPECT_EQ(outcome.result.summary.records, 3U);
    EXPECT_EQ(outcome.result.summary.format, "OFF");
    EXPECT_FALSE(outcome.result.summary.normals);
  }
}

TEST(OffReader, ReadsNormalsAndPassesOverColors) {
  for (const std::string kind : {"NOFF", "CNOFF", "NCOFF", "STNOFF"}) {
    const std::string extras = kind == "NOFF" ? "" : " 0.1 0.2 0.3 1";
    const Outcome outcome = readBytes(kind + "\n2 0 0\n1 2 3 0 0 1" + extras + "\n4 5 6 0 1 0" + extras + "\n", ".off");
    EXPECT_EQ(outcome.error, "") << kind;
    EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
    EXPECT_THAT(outcome.result.cloud.normals, ElementsAre(Vec3(0, 0, 1), Vec3(0, 1, 0)));
  }
  const Outcome colors = readBytes("COFF\n1 0 0\n1 2 3 0.1 0.2 0.3 1\n", ".off");
  EXPECT_EQ(colors.error, "");
  EXPECT_FALSE(colors.result.cloud.hasNormals());
}

TEST(OffReader, WarnsOfLinesBehindTheDeclaredRecords) {
  EXPECT_THAT(readBytes("OFF\n1 0 0\n1 2 3\n4 5 6\n", ".off").warnings,
              ElementsAre("file:4: ignored lines behind the declared records"));
}

TEST(OffReader, NamesThePlaceOfEveryFault) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "file: the file is empty"},
      {"# only this\n", "file: the file holds no header"},
      {"OFG\n", "file:1: expected OFF, COFF, NOFF or CNOFF, found \"OFG\""},
      {"4OFF\n", "file:1: expected OFF, COFF, NOFF or CNOFF, found \"4OFF\""},
      {"OFF BINARY\n", "file:1: expected the number of vertices, found \"BINARY\""},
      {"OFF\n", "file: file ends before the numbers of vertices and faces"},
      {"OFF\n1\n", "file:2: expected the number of faces, found the end of the line"},
      {"OFF\n1.5 0 0\n", "file:2: expected the number of vertices, found \"1.5\""},
      {"OFF\n1 0 0 0\n", "file:2: expected the end of the line after the number of edges, found \"0\""},
      {"OFF\n4000000000 0 0\n1 2 3\n", "file: declares 4000000000 points, file ends after record 1 (byte 25)"},
      {"OFF\n1 0 0\n1 2 c\n", "file:3: expected a number for z, found \"c\""},
      {"OFF\n1 0 0\n1 2 3 4\n", "file:3: expected the end of the line after the record, found \"4\""},
      {"NOFF\n1 0 0\n1 2 3 0 0\n", "file:3: expected a number for nz, found the end of the line"},
      {"OFF\n1 2 0\n1 2 3\n3 0 0 0\n", "file: declares 2 faces, file ends after record 1 (byte 24)"},
      {"OFF\n1 1 0\n1 2 3\n3 0 0 1\n", "file:4: expected an index below 1, found 1"},
      {"OFF\n1 1 0\n1 2 3\n3 0 0\n", "file:4: expected the index of a vertex, found the end of the line"}};
  for (const auto& [bytes, message] : cases) EXPECT_EQ(readBytes(bytes, ".off").error, message) << bytes;
}

}  // namespace
}  // namespace voroform::points::test
