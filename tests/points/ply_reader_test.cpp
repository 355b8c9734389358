// PLY: each encoding, type and layout against bytes built by hand, and every rejection with the place it names.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "support.hpp"

namespace voroform::points::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kAsciiHeader =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n";

std::string binaryHeader(std::endian order) {
  return std::string("ply\nformat ") + (order == std::endian::little ? "binary_little_endian" : "binary_big_endian") +
         " 1.0\n";
}

TEST(PlyReader, ReadsAscii) {
  const Outcome outcome = readBytes(kAsciiHeader + "end_header\n0.1 -2 3e-2\n+4 .5 6.\n", ".ply");
  EXPECT_EQ(outcome.error, "");
  EXPECT_THAT(outcome.warnings, IsEmpty());
  EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(0.1, -2, 0.03), Vec3(4, 0.5, 6)));
  EXPECT_FALSE(outcome.result.cloud.hasNormals());
  EXPECT_EQ(outcome.result.summary.format, "PLY ascii");
  EXPECT_EQ(outcome.result.summary.records, 2U);
  EXPECT_EQ(outcome.result.summary.faces, 0U);
  EXPECT_FALSE(outcome.result.summary.normals);
}

TEST(PlyReader, ReadsLineEndsOfWindows) {
  std::string bytes = kAsciiHeader + "end_header\n1 2 3\n4 5 6";
  for (std::size_t at = 0; (at = bytes.find('\n', at)) != std::string::npos; at += 2) bytes.insert(at, "\r");
  const Outcome outcome = readBytes(bytes, ".ply");
  EXPECT_EQ(outcome.error, "");
  EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
}

TEST(PlyReader, ReadsBinaryOfBothByteOrders) {
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    Bytes bytes(binaryHeader(order) +
                    "comment any\nobj_info any\nelement vertex 2\nproperty double x\nproperty double y\n"
                    "property double z\nproperty float normal_x\nproperty float normal_y\nproperty float normal_z\n"
                    "end_header\n",
                order);
    bytes.putAll({4500000.000001, -0.1, 1e300}).putAll({0.5F, -0.25F, 1.0F});
    bytes.putAll({1.0, 2.0, 3.0}).putAll({0.0F, 0.0F, -1.0F});
    const Outcome outcome = readBytes(bytes.text(), ".ply");
    EXPECT_EQ(outcome.error, "");
    EXPECT_THAT(outcome.warnings, IsEmpty());
    EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(4500000.000001, -0.1, 1e300), Vec3(1, 2, 3)));
    EXPECT_THAT(outcome.result.cloud.normals, ElementsAre(Vec3(0.5, -0.25, 1), Vec3(0, 0, -1)));
    EXPECT_TRUE(outcome.result.summary.normals);
    EXPECT_EQ(outcome.result.summary.format,
              order == std::endian::little ? "PLY binary_little_endian" : "PLY binary_big_endian");
  }
}

TEST(PlyReader, ReadsEveryScalarType) {
  struct Case {
    std::string type;
    std::string bytes;
    double value;
  };
  const std::vector<Case> cases{{"char", Bytes().put<std::int8_t>(-128).text(), -128},
                                {"int8", Bytes().put<std::int8_t>(127).text(), 127},
                                {"uchar", Bytes().put<std::uint8_t>(200).text(), 200},
                                {"uint8", Bytes().put<std::uint8_t>(255).text(), 255},
                                {"short", Bytes().put<std::int16_t>(-300).text(), -300},
                                {"int16", Bytes().put<std::int16_t>(300).text(), 300},
                                {"ushort", Bytes().put<std::uint16_t>(65535).text(), 65535},
                                {"uint16", Bytes().put<std::uint16_t>(258).text(), 258},
                                {"int", Bytes().put<std::int32_t>(-2147483647).text(), -2147483647},
                                {"int32", Bytes().put<std::int32_t>(16909060).text(), 16909060},
                                {"uint", Bytes().put<std::uint32_t>(4294967295U).text(), 4294967295.0},
                                {"uint32", Bytes().put<std::uint32_t>(1).text(), 1},
                                {"int64", Bytes().put<std::int64_t>(-4503599627370497).text(), -4503599627370497.0},
                                {"uint64", Bytes().put<std::uint64_t>(4503599627370497).text(), 4503599627370497.0},
                                {"float", Bytes().put(0.1F).text(), static_cast<double>(0.1F)},
                                {"float32", Bytes().put(-0.0F).text(), 0},
                                {"double", Bytes().put(0.1).text(), 0.1},
                                {"float64", Bytes().put(std::numeric_limits<double>::denorm_min()).text(),
                                 std::numeric_limits<double>::denorm_min()}};
  for (const Case& item : cases) {
    const std::string header = binaryHeader(std::endian::little) + "element vertex 1\nproperty uchar red\nproperty " +
                               item.type + " y\nproperty " + item.type + " x\nproperty uchar blue\nproperty " +
                               item.type + " z\nend_header\n";
    const Outcome outcome = readBytes(header + "R" + item.bytes + item.bytes + "B" + item.bytes, ".ply");
    EXPECT_EQ(outcome.error, "") << item.type;
    EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(item.value, item.value, item.value))) << item.type;
  }
}

TEST(PlyReader, PassesOverOtherElementsAndLists) {
  const std::string body =
      "element camera 2\nproperty float a\nproperty list uchar int b\nelement empty 4000000000\nelement plain 2\n"
      "property short s\nelement vertex 2\nproperty list uint short extra\nproperty float x\nproperty float y\n"
      "property float z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n";
  const Outcome ascii = readBytes(
      "ply\nformat ascii 1.0\n" + body + "1.5 2 7 8\n1.5 0\n3\n4\n2 9 9 1 2 3\n0 4 5 6\n3 0 1 0\n3 0 1 1\n4 0 0 1 1\n",
      ".ply");
  EXPECT_EQ(ascii.error, "");
  EXPECT_THAT(ascii.warnings, IsEmpty());
  EXPECT_THAT(ascii.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  EXPECT_EQ(ascii.result.summary.faces, 3U);

  Bytes bytes(binaryHeader(std::endian::big) + body, std::endian::big);
  bytes.put(1.5F).put<std::uint8_t>(2).putAll<std::int32_t>({7, 8}).put(1.5F).put<std::uint8_t>(0);
  bytes.putAll<std::int16_t>({3, 4});
  bytes.put<std::uint32_t>(2).putAll<std::int16_t>({9, 9}).putAll({1.0F, 2.0F, 3.0F});
  bytes.put<std::uint32_t>(0).putAll({4.0F, 5.0F, 6.0F});
  for (int face = 0; face < 3; ++face) bytes.put<std::uint8_t>(3).putAll<std::int32_t>({0, 1, 0});
  const Outcome binary = readBytes(bytes.text(), ".ply");
  EXPECT_EQ(binary.error, "");
  EXPECT_THAT(binary.warnings, IsEmpty());
  EXPECT_THAT(binary.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
  EXPECT_EQ(binary.result.summary.faces, 3U);

  // The faces belong to the file: without the last one it is truncated.
  const Outcome cut = readBytes(bytes.text().substr(0, bytes.text().size() - 1), ".ply");
  EXPECT_THAT(cut.error, HasSubstr("declares 3 face records, file ends after record 2 (byte "));
}

TEST(PlyReader, AcceptsNanAndInfinityAsValues) {
  const Outcome outcome = readBytes(kAsciiHeader + "end_header\nnan inf -INF\n1e999 -1e999 1e-999\n", ".ply");
  ASSERT_EQ(outcome.error, "");
  ASSERT_EQ(outcome.result.cloud.positions.size(), 2U);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(outcome.result.cloud.positions[0].x()));
  EXPECT_EQ(outcome.result.cloud.positions[0].y(), kInfinity);
  EXPECT_EQ(outcome.result.cloud.positions[0].z(), -kInfinity);
  EXPECT_EQ(outcome.result.cloud.positions[1], Vec3(kInfinity, -kInfinity, 0));
}

TEST(PlyReader, WarnsOfDataBehindTheDeclaredRecords) {
  Bytes bytes(binaryHeader(std::endian::little) +
              "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n");
  bytes.putAll({1.0F, 2.0F, 3.0F});
  EXPECT_THAT(readBytes(bytes.text(), ".ply").warnings, IsEmpty());
  const Outcome longer = readBytes(bytes.put<std::uint8_t>(0).text(), ".ply");
  EXPECT_EQ(longer.error, "");
  EXPECT_EQ(longer.result.summary.records, 1U);
  EXPECT_THAT(longer.warnings, ElementsAre("file: ignored data behind the declared records"));
  EXPECT_THAT(readBytes(kAsciiHeader + "end_header\n1 2 3\n4 5 6\n\n7 8 9\n", ".ply").warnings,
              ElementsAre("file:11: ignored lines behind the declared records"));
}

TEST(PlyReader, RefusesFourBillionDeclaredPointsWithoutTheBytes) {
  for (const std::string count : {"4000000000", "18446744073709551615"}) {
    const std::string vertex =
        "element vertex " + count + "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    Bytes bytes(binaryHeader(std::endian::little) + vertex);
    bytes.putAll({1.0F, 2.0F, 3.0F}).put<std::uint8_t>(0);
    EXPECT_EQ(readBytes(bytes.text(), ".ply").error, "file: declares " + count +
                                                         " points, file ends after record 1 (byte " +
                                                         std::to_string(bytes.text().size()) + ")");
    const std::string ascii = "ply\nformat ascii 1.0\n" + vertex + "1 2 3\n";
    EXPECT_EQ(readBytes(ascii, ".ply").error, "file: declares " + count + " points, file ends after record 1 (byte " +
                                                  std::to_string(ascii.size()) + ")");
  }
}

TEST(PlyReader, NamesThePlaceOfEveryFault) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string start = "ply\nformat ascii 1.0\n";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "file: the file is empty"},
      {"plx\n", "file:1: expected \"ply\", found \"plx\""},
      {"ply\n", "file: file ends within the header (line 1)"},
      {"ply\nelement vertex 1\n", "file:2: expected the line \"format …\", found \"element vertex 1\""},
      {"ply\nformat asci 1.0\n", "file:2: expected ascii, binary_little_endian or binary_big_endian, found \"asci\""},
      {"ply\nformat ascii 1.1\n", "file:2: expected version 1.0, found \"1.1\""},
      {start + "format ascii 1.0\n", "file:3: expected one line \"format …\", found a second one"},
      {start + "element vertex -1\n", "file:3: expected the number of \"vertex\" records, found \"-1\""},
      {start + "element vertex 1 1\n", "file:3: expected the end of the line after element, found \"1\""},
      {start + "element vertex 1\nelement vertex 1\n",
       "file:4: expected every element once, found a second \"vertex\""},
      {start + "property float x\n", "file:3: expected an element before its properties, found \"property float x\""},
      {start + "element vertex 1\nproperty half x\n",
       "file:4: expected a scalar type such as float or uchar, found \"half\""},
      {start + "element vertex 1\nproperty list float int x\n",
       "file:4: expected an integer type for the length of a list, found a floating-point type"},
      {start + "element vertex 1\nproperty float\n",
       "file:4: expected the name of the property, found the end of the line"},
      {start + "vertex 1\n", "file:3: expected element, property, comment or end_header, found \"vertex\""},
      {start + "element face 1\nend_header\n", "file: the header declares no element vertex"},
      {start + "element vertex 1\nproperty float x\nproperty float y\nend_header\n",
       "file: the header does not name z among the fields of a point"},
      {start + "element vertex 1\n" + xyz + "property float x\nend_header\n", "file: the header names x twice"},
      {start + "element vertex 1\n" + xyz + "property float nx\nproperty float nz\nend_header\n",
       "file: the header does not name ny, though it names other components of a normal"},
      {start + "element vertex 1\nproperty float x\nproperty float y\nproperty list uchar float z\nend_header\n",
       "file: the header makes z a list"},
      {kAsciiHeader + "end_header\n1 2 3\n4 five 6\n", "file:9: expected a number for y, found \"five\""},
      {kAsciiHeader + "end_header\n1 2 3\n4 5x 6\n", "file:9: expected a number for y, found \"5x\""},
      {kAsciiHeader + "end_header\n1 2 3\n4 5,6 6\n", "file:9: expected a number for y, found \"5,6\""},
      {kAsciiHeader + "end_header\n1 2 3\n4 +-5 6\n", "file:9: expected a number for y, found \"+-5\""},
      {kAsciiHeader + "end_header\n1 2\n4 5 6\n", "file:8: expected a number for z, found the end of the line"},
      {kAsciiHeader + "end_header\n1 2 3 4\n4 5 6\n",
       "file:8: expected the end of the line after the record, found \"4\""},
      {kAsciiHeader + "end_header\n1 2 3\n", "file: declares 2 points, file ends after record 1 (byte 106)"},
      {kAsciiHeader + "end_header\n1 2 \x01\xff" + std::string(40, 'a') + "\n",
       "file:8: expected a number for z, found \"\\x01\\xff" + std::string(30, 'a') + "…\""}};
  for (const auto& [bytes, message] : cases) EXPECT_EQ(readBytes(bytes, ".ply").error, message) << bytes;
}

TEST(PlyReader, RefusesListsOfNegativeOrEndlessLength) {
  const std::string header = binaryHeader(std::endian::little) +
                             "element vertex 1\nproperty list int double a\nproperty float x\nproperty float y\n"
                             "property float z\nend_header\n";
  EXPECT_EQ(readBytes(Bytes(header).put<std::int32_t>(-1).text(), ".ply").error,
            "file: record 1 of element vertex: expected the length of a list, found a negative number");
  EXPECT_THAT(readBytes(Bytes(header).put<std::int32_t>(2147483647).text(), ".ply").error,
              HasSubstr("declares 1 points, file ends after record 0 (byte "));
}

TEST(PlyReader, RefusesEndlessLines) {
  const std::string error = readBytes(kAsciiHeader + "comment " + std::string(2'000'000, 'x'), ".ply").error;
  EXPECT_EQ(error, "file:7: expected a line of at most 1048576 bytes, found a longer one");
}

}  // namespace
}  // namespace voroform::points::test
