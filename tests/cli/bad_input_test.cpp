// Bad input: the right exit code, a message that names the place, and no output.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <bit>
#include <cstring>

#include "program.hpp"

namespace voroform::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class BadInput : public testing::Test {
 protected:
  // Runs reconstruct on the file and expects exit 3 without an output folder; gives what was printed on stderr.
  std::string refused(const std::string& input, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"reconstruct", input, "-o", folder_ / "out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exitCode, 3) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
    return outcome.err;
  }

  TemporaryFolder folder_;
};

std::string plyHeader(const std::string& format, std::uint64_t count) {
  std::string header = "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(count) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"}) header += std::string("property double ") + name + "\n";
  return header + "end_header\n";
}

std::string binaryPly(const std::vector<OrientedPoint>& points) {
  static_assert(std::endian::native == std::endian::little);
  std::string content = plyHeader("binary_little_endian", points.size());
  for (const OrientedPoint& point : points) {
    char record[48];
    std::memcpy(record, point.position.data(), 24);
    std::memcpy(record + 24, point.normal.data(), 24);
    content.append(record, sizeof record);
  }
  return content;
}

TEST_F(BadInput, MissingFile) {
  const std::string path = folder_ / "none.ply";
  EXPECT_THAT(refused(path), AllOf(HasSubstr(path), HasSubstr("no such file")));
}

TEST_F(BadInput, FolderInPlaceOfAFile) {
  const std::string path = folder_ / "";
  EXPECT_THAT(refused(path), AllOf(HasSubstr(path), HasSubstr("folder")));
}

// A pipe could be read once only, and would be waited for.
TEST_F(BadInput, PipeInPlaceOfAFile) {
  const std::string path = folder_ / "pipe.xyz";
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_THAT(refused(path), AllOf(HasSubstr(path), HasSubstr("regular file")));
  const Outcome info = run({"info", path});
  EXPECT_EQ(info.exitCode, 3);
}

TEST_F(BadInput, EmptyFile) {
  for (const char* name : {"empty.ply", "empty.xyz", "empty.pcd", "empty.off"}) {
    EXPECT_THAT(refused(folder_.write(name, "")), HasSubstr(name));
  }
}

TEST_F(BadInput, UnknownExtension) {
  EXPECT_THAT(refused(folder_.write("points.doc", "1 2 3\n")), HasSubstr("points.doc"));
}

TEST_F(BadInput, TruncatedBinaryPly) {
  const std::string content = binaryPly(torusPoints(200));
  const std::string whole = folder_.write("whole.ply", content);
  const Outcome control = run({"points", whole, "-o", folder_ / "points.ply"});
  EXPECT_EQ(control.exitCode, 0) << control.err;
  const std::string cut = folder_.write("cut.ply", content.substr(0, content.size() - 60));
  EXPECT_THAT(refused(cut), AllOf(HasSubstr("cut.ply"), HasSubstr("198")));
}

TEST_F(BadInput, HeaderThatDeclaresFourBillionPoints) {
  const std::string content = plyHeader("binary_little_endian", 4'000'000'000) + std::string(480, '\0');
  EXPECT_THAT(refused(folder_.write("vast.ply", content)), HasSubstr("vast.ply"));
  const std::string pcd =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4000000000\nHEIGHT 1\n"
      "POINTS 4000000000\nDATA binary\n" +
      std::string(120, '\0');
  EXPECT_THAT(refused(folder_.write("vast.pcd", pcd)), HasSubstr("vast.pcd"));
}

TEST_F(BadInput, TextWhereNumbersBelong) {
  const std::string content = xyzText(torusPoints(60)) + "0.1 0.2 left 0 0 1\n";
  EXPECT_THAT(refused(folder_.write("text.xyz", content)),
              AllOf(HasSubstr("text.xyz"), HasSubstr("61"), HasSubstr("left")));
}

TEST_F(BadInput, OnlyNotANumber) {
  std::string content;
  for (int i = 0; i < 100; ++i) content += "nan nan nan 0 0 1\n";
  EXPECT_THAT(refused(folder_.write("nan.xyz", content)), AllOf(HasSubstr("nan.xyz"), HasSubstr("100")));
}

TEST_F(BadInput, TenPoints) {
  EXPECT_THAT(refused(folder_.write("ten.xyz", xyzText(torusPoints(10)))),
              AllOf(HasSubstr("ten.xyz"), HasSubstr("10")));
}

TEST_F(BadInput, CoplanarPoints) {
  std::vector<OrientedPoint> points = torusPoints(200);
  for (OrientedPoint& point : points) point = {{point.position.x(), point.position.y(), 0.5}, Vec3::UnitZ()};
  EXPECT_THAT(refused(folder_.write("flat.xyz", xyzText(points))), AllOf(HasSubstr("flat.xyz"), HasSubstr("plane")));
}

TEST_F(BadInput, InputsTakenForWhatTheyAreNot) {
  const std::string off =
      folder_.write("tetra.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  EXPECT_THAT(refused(off, {"--as", "points"}), HasSubstr("4"));
  EXPECT_THAT(refused(folder_.write("cloud.xyz", xyzText(torusPoints(100))), {"--as", "mesh"}), HasSubstr("mesh"));
}

// Before the input is: it takes long to make a form of it.
TEST_F(BadInput, FilesOfSitesAreReadFirst) {
  const std::string none = folder_ / "none.xyz";
  const auto refusedSites = [&](const std::string& name, const std::string& content) {
    return refused(none, {"--init", folder_.write(name, content)});
  };
  EXPECT_THAT(refusedSites("text.xyz", "0 0 0\n0 left 0\n"), AllOf(HasSubstr("text.xyz:2"), HasSubstr("left")));
  EXPECT_THAT(refusedSites("twice.xyz", "0 0 0\n1 0 0\n0 0 0\n"), HasSubstr("twice.xyz: sites 1 and 3 coincide"));
  EXPECT_THAT(refusedSites("infinite.xyz", "0 0 0\n1 0 inf\n"), HasSubstr("infinite.xyz: site 2 is not finite"));
  EXPECT_THAT(refused(none, {"--init", "no-such-kind"}), HasSubstr("no-such-kind"));
  // The negative control: the input is read next.
  EXPECT_THAT(refusedSites("good.xyz", "0 0 0\n1 0 0\n"), HasSubstr("none.xyz: no such file"));
}

TEST_F(BadInput, SitesOutsideTheSolid) {
  const Outcome outcome =
      run({"tessellate", "shape:torus", "-o", folder_ / "out", "--init", folder_.write("sites.xyz", "1 0 0\n0 0 0\n")});
  EXPECT_EQ(outcome.exitCode, 3);
  EXPECT_THAT(outcome.err, HasSubstr("sites.xyz: site 2 lies outside the solid"));
}

TEST_F(BadInput, FormWithoutItsCompanions) {
  const std::string form = folder_.write("form.vtu", "<VTKFile/>");
  const Outcome outcome = run({"tessellate", form, "-o", folder_ / "out"});
  EXPECT_EQ(outcome.exitCode, 3);
  EXPECT_THAT(outcome.err, AllOf(HasSubstr("form.json"), HasSubstr("missing")));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(BadInput, EvaluateNeedsAResultsFolder) {
  EXPECT_THAT(run({"evaluate", folder_ / "none"}).err, HasSubstr("no such folder"));
  const Outcome empty = run({"evaluate", folder_ / ""});
  EXPECT_EQ(empty.exitCode, 3);
  EXPECT_THAT(empty.err, HasSubstr("metrics.json"));
  folder_.write("metrics.json", "{\"schema\": 3}");
  const Outcome broken = run({"evaluate", folder_ / ""});
  EXPECT_EQ(broken.exitCode, 3);
  EXPECT_THAT(broken.err, AllOf(HasSubstr("metrics.json"), HasSubstr("schema")));
}

TEST_F(BadInput, EvaluateRefusesNumbersThatARecordCannotHold) {
  const auto refusal = [this](const std::string& seed, const std::string& sites) {
    folder_.write("metrics.json", "{\"schema\": \"voroform.metrics/1\", \"seed\": " + seed +
                                      ", \"counts\": {\"sites\": " + sites + "}}");
    const Outcome outcome = run({"evaluate", folder_ / ""});
    EXPECT_EQ(outcome.exitCode, 3);
    EXPECT_THAT(outcome.err, HasSubstr("metrics.json: the key "));
    return outcome.err;
  };
  EXPECT_THAT(refusal("-1", "10"), HasSubstr("\"seed\" is out of range: -1"));
  EXPECT_THAT(refusal("1.5", "10"), HasSubstr("\"seed\" has a wrong type: 1.5"));
  EXPECT_THAT(refusal("true", "10"), HasSubstr("\"seed\" has a wrong type: true"));
  EXPECT_THAT(refusal("1", "4294967297"), HasSubstr("\"sites\" is out of range: 4294967297"));
  // The negative control: the greatest that are held; what is missing next is told.
  EXPECT_THAT(refusal("18446744073709551615", "2147483647"), HasSubstr("\"warnings\" is missing"));
}

// Normals that point everywhere contradict any surface.
TEST_F(BadInput, ContradictoryNormalsAreAFailureOfTheMethod) {
  std::vector<OrientedPoint> points = torusPoints(600);
  for (std::size_t i = 0; i < points.size(); i += 2) points[i].normal = -points[i].normal;
  const std::string input = folder_.write("mixed.xyz", xyzText(points));
  const Outcome outcome = run({"reconstruct", input, "-o", folder_ / "out", "--sites", "100"});
  EXPECT_EQ(outcome.exitCode, 4) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("normals"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

}  // namespace
}  // namespace voroform::test
