// Files by path: how the format is chosen, files that cannot be read, and writing.
#include <gmock/gmock.h>

#include <atomic>
#include <filesystem>
#include <fstream>

#include "support.hpp"

namespace voroform::points::test {
namespace {

using testing::HasSubstr;

class PointFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("voroform_points_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  std::string errorOf(const std::filesystem::path& path) const {
    try {
      readPoints(path, RunContext());
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  std::filesystem::path folder_;
};

TEST_F(PointFiles, AreReadByTheirExtensionInAnyCase) {
  EXPECT_EQ(readPoints(write("a.XYZ", "1 2 3\n"), RunContext()).summary.format, "text with 3 columns");
  EXPECT_EQ(readPoints(write("a.Off", "OFF\n1 0 0\n1 2 3\n"), RunContext()).summary.format, "OFF");
}

TEST_F(PointFiles, ThatCannotBeReadAreNamed) {
  const std::string missing = (folder_ / "missing.ply").string();
  EXPECT_EQ(errorOf(missing), missing + ": no such file");
  EXPECT_EQ(errorOf(folder_), folder_.string() + ": expected a file, found a folder");
  std::filesystem::create_directories(folder_ / "folder.ply");
  EXPECT_THAT(errorOf(folder_ / "folder.ply"), HasSubstr("folder.ply: expected a file, found a folder"));
  EXPECT_THAT(errorOf(write("below.ply", "") / "x.ply"), HasSubstr("below.ply/x.ply: no such file"));
  for (const std::string name : {"empty.ply", "empty.xyz", "empty.pcd", "empty.off"}) {
    EXPECT_EQ(errorOf(write(name, "")), (folder_ / name).string() + ": the file is empty");
  }
  EXPECT_THAT(errorOf(write("a.stl", "solid")),
              HasSubstr("a.stl: expected the extension .ply, .xyz, .xyzn, .pwn, .txt, .pcd or .off, found \".stl\""));
}

TEST_F(PointFiles, ComeBackAsTheyWereWritten) {
  PointCloud cloud;
  cloud.frame.origin = Vec3(4500000, -300000, 0);
  for (int i = 0; i < 3000; ++i) {
    cloud.positions.emplace_back(i * 0x1p-20, -i * 0x1p-19, 1.0 / (i + 1));
    cloud.normals.emplace_back(0.6, -0.8, i / 7.0);
  }
  const std::filesystem::path path = folder_ / "cloud.ply";
  writePointsPly(path, cloud);
  const ReadResult result = readPoints(path, RunContext());
  EXPECT_EQ(result.summary.format, "PLY binary_little_endian");
  EXPECT_EQ(result.cloud.frame.origin, Vec3(0, 0, 0));
  ASSERT_EQ(result.cloud.positions.size(), cloud.positions.size());
  EXPECT_EQ(result.cloud.normals, cloud.normals);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    EXPECT_EQ(result.cloud.positions[i], cloud.frame.origin + cloud.positions[i]);
  }
  cloud.normals.clear();
  writePointsPly(path, cloud);
  EXPECT_FALSE(readPoints(path, RunContext()).cloud.hasNormals());
}

TEST_F(PointFiles, ThatCannotBeWrittenAreAFailureOfTheEnvironment) {
  EXPECT_THROW(writePointsPly(write("file", "") / "cloud.ply", PointCloud()), EnvironmentError);
}

TEST_F(PointFiles, StopWhenCancelled) {
  const std::atomic<bool> cancelled = true;
  RunContext context;
  context.cancelled = &cancelled;
  EXPECT_THROW(readPoints(write("a.xyz", "1 2 3\n"), context), Cancelled);
}

}  // namespace
}  // namespace voroform::points::test
