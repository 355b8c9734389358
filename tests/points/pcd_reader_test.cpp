// PCD: ascii, binary and compressed.
#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>

#include "support.hpp"

namespace voroform::points::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string header(const std::string& fields, const std::string& points, const std::string& data) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n" + fields + "WIDTH " + points +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA " + data + "\n";
}

const std::string kXyz = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
const std::string kMixed =
    "FIELDS histogram x normal_x y normal_y z normal_z _\nSIZE 2 4 8 8 4 2 1 1\nTYPE U F F F F I I U\n"
    "COUNT 3 1 1 1 1 1 1 2\n";

TEST(PcdReader, ReadsAscii) {
  const Outcome outcome = readBytes(header(kXyz, "2", "ascii") + "1 2 3\n\n4 nan 6\n", ".pcd");
  EXPECT_EQ(outcome.error, "");
  ASSERT_EQ(outcome.result.cloud.positions.size(), 2U);
  EXPECT_EQ(outcome.result.cloud.positions[0], Vec3(1, 2, 3));
  EXPECT_TRUE(std::isnan(outcome.result.cloud.positions[1].y()));
  EXPECT_EQ(outcome.result.summary.format, "PCD ascii");
  EXPECT_FALSE(outcome.result.summary.normals);
}

TEST(PcdReader, ReadsFieldsOfAnyOrderTypeAndCount) {
  const Outcome ascii = readBytes(header(kMixed, "1", "ascii") + "7 7 7 1.5 0.6 2.5 0.8 -3 1 9 9\n", ".pcd");
  EXPECT_EQ(ascii.error, "");
  EXPECT_THAT(ascii.result.cloud.positions, ElementsAre(Vec3(1.5, 2.5, -3)));
  EXPECT_THAT(ascii.result.cloud.normals, ElementsAre(Vec3(0.6, 0.8, 1)));

  Bytes bytes(header(kMixed, "2", "binary"));
  for (int record = 0; record < 2; ++record) {
    bytes.putAll<std::uint16_t>({7, 7, 7}).put(1.5F).put(0.6).put(2.5 + record).put(0.5F);
    bytes.put<std::int16_t>(-3).put<std::int8_t>(-1).putAll<std::uint8_t>({9, 9});
  }
  const Outcome binary = readBytes(bytes.text(), ".pcd");
  EXPECT_EQ(binary.error, "");
  EXPECT_THAT(binary.warnings, IsEmpty());
  EXPECT_THAT(binary.result.cloud.positions, ElementsAre(Vec3(1.5, 2.5, -3), Vec3(1.5, 3.5, -3)));
  EXPECT_THAT(binary.result.cloud.normals, ElementsAre(Vec3(0.6, 0.5, -1), Vec3(0.6, 0.5, -1)));
  EXPECT_EQ(readBytes(bytes.put('x').text(), ".pcd").warnings.size(), 1U);
}

// Two points (1, 2, 3) and (1, 2, 5): fields one after the other, so each float of x and y comes twice. The code copies
// the second from the first: control byte (length − 2) << 5, then distance − 1.
std::string compressedPoints() {
  Bytes lzf;
  for (const float value : {1.0F, 2.0F}) {
    lzf.put<std::uint8_t>(3).put(value);                           // four literal bytes
    lzf.put<std::uint8_t>((4 - 2) << 5).put<std::uint8_t>(4 - 1);  // and again
  }
  lzf.put<std::uint8_t>(7).put(3.0F).put(5.0F);
  return lzf.text();
}

std::string withSizes(const std::string& lzf, std::uint32_t size) {
  return Bytes().put(static_cast<std::uint32_t>(lzf.size())).put(size).text() + lzf;
}

TEST(PcdReader, ReadsCompressed) {
  const std::string start = header(kXyz, "2", "binary_compressed");
  const Outcome outcome = readBytes(start + withSizes(compressedPoints(), 24), ".pcd");
  EXPECT_EQ(outcome.error, "");
  EXPECT_THAT(outcome.result.cloud.positions, ElementsAre(Vec3(1, 2, 3), Vec3(1, 2, 5)));
  EXPECT_EQ(outcome.result.summary.format, "PCD binary_compressed");
}

TEST(PcdReader, DecodesLongOverlappingCopies) {
  // 100 points of zeros are 1200 bytes: one literal and copies at distance one, of up to 264 bytes.
  Bytes lzf;
  lzf.put<std::uint8_t>(0).put<std::uint8_t>(0);
  for (const int length : {264, 264, 264, 264, 143}) {
    lzf.put<std::uint8_t>(7 << 5).put(static_cast<std::uint8_t>(length - 9)).put<std::uint8_t>(0);
  }
  const Outcome outcome = readBytes(header(kXyz, "100", "binary_compressed") + withSizes(lzf.text(), 1200), ".pcd");
  EXPECT_EQ(outcome.error, "");
  EXPECT_THAT(outcome.result.cloud.positions, testing::AllOf(testing::SizeIs(100), testing::Each(Vec3(0, 0, 0))));
}

TEST(PcdReader, RefusesDamagedCompression) {
  const std::string start = header(kXyz, "2", "binary_compressed");
  const std::string good = compressedPoints();
  const std::string damaged = "file: the compressed data are damaged or not of the declared size of 24 bytes";
  std::string farCopy = good;
  farCopy[6] = 17;  // a distance of 18 where only 4 bytes are there
  EXPECT_EQ(readBytes(start + withSizes(farCopy, 24), ".pcd").error, damaged);
  std::string longCopy = good;
  longCopy[5] = static_cast<char>(6 << 5);  // makes four bytes more
  EXPECT_EQ(readBytes(start + withSizes(longCopy, 24), ".pcd").error, damaged);
  EXPECT_EQ(readBytes(start + withSizes(good.substr(0, good.size() - 1), 24), ".pcd").error, damaged);
  EXPECT_EQ(readBytes(start + withSizes(good, 25), ".pcd").error,
            "file: declares 2 points of 12 bytes, but 25 bytes of uncompressed data");
  EXPECT_EQ(readBytes(start + withSizes(good, 24).substr(0, 20), ".pcd").error,
            "file: declares 23 bytes of compressed data, file ends before");
  EXPECT_EQ(readBytes(start + "abc", ".pcd").error, "file: file ends before the compressed size");
  // 357,913,941 points are 4 GB, out of 23 bytes.
  EXPECT_EQ(readBytes(header(kXyz, "357913941", "binary_compressed") + withSizes(good, 4294967292U), ".pcd").error,
            "file: the compressed data are damaged or not of the declared size of 4294967292 bytes");
}

TEST(PcdReader, RefusesFourBillionDeclaredPointsWithoutTheBytes) {
  Bytes binary(header(kXyz, "4000000000", "binary"));
  binary.putAll({1.0F, 2.0F, 3.0F});
  EXPECT_EQ(
      readBytes(binary.text(), ".pcd").error,
      "file: declares 4000000000 points, file ends after record 1 (byte " + std::to_string(binary.text().size()) + ")");
  EXPECT_THAT(readBytes(header(kXyz, "4000000000", "ascii") + "1 2 3\n", ".pcd").error,
              HasSubstr("declares 4000000000 points, file ends after record 1 (byte "));
  EXPECT_EQ(readBytes(header(kXyz, "4000000000", "binary_compressed") + withSizes("", 0), ".pcd").error,
            "file: declares 4000000000 points of 12 bytes, but 0 bytes of uncompressed data");
}

TEST(PcdReader, NamesThePlaceOfEveryFault) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"", "file: the file is empty"},
      {"VERSION 0.7\n", "file: file ends within the header (line 1)"},
      {"LASF\n", "file:1: expected a line of a PCD header (FIELDS, SIZE, TYPE, …), found \"LASF\""},
      {"FIELDS x y z\nSIZE 4 4\n", "file:2: expected the size of \"z\", found the end of the line"},
      {"FIELDS x y z\nSIZE 4 4 4 4\n", "file:2: expected the end of the line after SIZE, found \"4\""},
      {"FIELDS x y z\nTYPE F F D\n", "file:2: expected the type F, I or U, found \"D\""},
      {"FIELDS x\nFIELDS x\n", "file:2: expected one line FIELDS, found a second one"},
      {kXyz + "WIDTH a\n", "file:5: expected the width, found \"a\""},
      {kXyz + "DATA hex\n", "file:5: expected ascii, binary or binary_compressed, found \"hex\""},
      {kXyz + "DATA ascii\n", "file: the header has neither POINTS nor WIDTH"},
      {"POINTS 1\nDATA ascii\n", "file: the header has no line FIELDS"},
      {kXyz + "WIDTH 2\nHEIGHT 2\nPOINTS 2\nDATA ascii\n",
       "file: the header declares WIDTH 2 × HEIGHT 2, but POINTS 2"},
      {kXyz + "WIDTH 18446744073709551615\nHEIGHT 2\nDATA ascii\n",
       "file: the header declares WIDTH 18446744073709551615 × HEIGHT 2: too many points"},
      {"FIELDS x y z\nSIZE 4 4 3\nPOINTS 1\nDATA ascii\n",
       "file: the header gives field \"z\" the type F3, which PCD does not know"},
      {"FIELDS x y z h\nCOUNT 1 1 1 4000000000\nPOINTS 1\nDATA binary\n",
       "file: the header declares records of more than 1048576 bytes"},
      {"FIELDS x y z\nCOUNT 1 1 2\nPOINTS 1\nDATA ascii\n", "file: the header gives field z a count other than 1"},
      {"FIELDS x y\nPOINTS 1\nDATA ascii\n", "file: the header does not name z among the fields of a point"},
      {kXyz + "POINTS 1\nDATA ascii\n1 2 b\n", "file:7: expected a number for z, found \"b\""},
      {kXyz + "POINTS 1\nDATA ascii\n1 2 3 4\n", "file:7: expected the end of the line after the record, found \"4\""}};
  for (const auto& [bytes, message] : cases) EXPECT_EQ(readBytes(bytes, ".pcd").error, message) << bytes;
}

}  // namespace
}  // namespace voroform::points::test
