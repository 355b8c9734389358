#include "voroform/core/output_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "voroform/core/error.hpp"

namespace voroform {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class OutputFileTest : public testing::Test {
 protected:
  OutputFileTest() {
    std::string name = (fs::temp_directory_path() / "voroform-output-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create " + name);
    folder_ = name;
  }
  ~OutputFileTest() override { fs::remove_all(folder_); }

  std::vector<std::string> names() const {
    std::vector<std::string> list;
    for (const auto& entry : fs::directory_iterator(folder_)) list.push_back(entry.path().filename());
    std::sort(list.begin(), list.end());
    return list;
  }
  static std::string content(const fs::path& path) {
    std::stringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }

  fs::path folder_;
};

template <class Action>
std::string environmentErrorOf(const Action& action) {
  try {
    action();
  } catch (const EnvironmentError& error) {
    return error.what();
  }
  return "no EnvironmentError was thrown";
}

TEST_F(OutputFileTest, CommitMakesTheFileAppearWhole) {
  OutputFile file(folder_ / "a.txt");
  file.stream() << "one\ntwo";
  EXPECT_FALSE(fs::exists(folder_ / "a.txt"));
  file.commit();
  EXPECT_EQ(content(folder_ / "a.txt"), "one\ntwo");
  EXPECT_THAT(names(), ElementsAre("a.txt"));
}

TEST_F(OutputFileTest, LeavesNothingBehindWithoutCommit) {
  {
    OutputFile file(folder_ / "a.txt");
    file.stream() << "text" << std::flush;
    EXPECT_EQ(names().size(), 1U) << "the temporary";
  }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(OutputFileTest, KeepsTheOlderFileWithoutCommit) {
  std::ofstream(folder_ / "a.txt") << "old";
  {
    OutputFile file(folder_ / "a.txt");
    file.stream() << "new";
  }
  EXPECT_EQ(content(folder_ / "a.txt"), "old");
  EXPECT_THAT(names(), ElementsAre("a.txt"));
}

TEST_F(OutputFileTest, ReplacesTheOlderFileOnCommit) {
  std::ofstream(folder_ / "a.txt") << "an older and longer text";
  OutputFile file(folder_ / "a.txt");
  file.stream() << "new";
  file.commit();
  EXPECT_EQ(content(folder_ / "a.txt"), "new");
}

TEST_F(OutputFileTest, FullDiskIsAnEnvironmentErrorAndLeavesNothing) {
  // /dev/full fails every write for want of space; the temporary is made a link to it.
  const fs::path target = folder_ / "a.bin";
  std::ofstream(target) << "old";
  const fs::path temporary = target.string() + "." + std::to_string(::getpid()) + ".tmp";
  fs::create_symlink("/dev/full", temporary);
  {
    OutputFile file(target);
    file.stream() << std::string(1 << 20, 'x');
    const std::string message = environmentErrorOf([&] { file.commit(); });
    EXPECT_THAT(message, AllOf(HasSubstr("a.bin"), HasSubstr("No space left on device")));
  }
  EXPECT_EQ(content(target), "old");
  EXPECT_THAT(names(), ElementsAre("a.bin"));
}

TEST_F(OutputFileTest, SmallFilesOnAFullDiskFailToo) {
  // What fits the stream's buffer is only written on commit.
  const fs::path target = folder_ / "a.bin";
  fs::create_symlink("/dev/full", target.string() + "." + std::to_string(::getpid()) + ".tmp");
  OutputFile file(target);
  file.stream() << "x";
  const std::string message = environmentErrorOf([&] { file.commit(); });
  EXPECT_THAT(message, HasSubstr("No space left on device"));
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(OutputFileTest, MissingFolderIsAnEnvironmentErrorThatNamesThePath) {
  const fs::path target = folder_ / "missing" / "a.txt";
  const std::string message = environmentErrorOf([&] { const OutputFile file(target); });
  EXPECT_THAT(message, HasSubstr(target.string()));
  EXPECT_THAT(message, HasSubstr("No such file or directory"));
}

TEST_F(OutputFileTest, TargetThatIsAFolderIsAnEnvironmentError) {
  fs::create_directories(folder_ / "a" / "content");
  {
    OutputFile file(folder_ / "a");
    file.stream() << "text";
    EXPECT_THAT(environmentErrorOf([&] { file.commit(); }), HasSubstr("cannot rename"));
  }
  EXPECT_THAT(names(), ElementsAre("a"));
}

TEST_F(OutputFileTest, TemporariesOfOpenFilesCanBeRemovedAtOnce) {
  std::ofstream(folder_ / "b.txt") << "old";
  OutputFile a(folder_ / "a.txt");
  OutputFile b(folder_ / "b.txt");
  EXPECT_EQ(names().size(), 3U);
  removeTemporaryFiles();
  EXPECT_THAT(names(), ElementsAre("b.txt"));
}

TEST_F(OutputFileTest, CreatesOutputFoldersWithTheirParents) {
  createOutputFolder(folder_ / "a" / "b");
  EXPECT_TRUE(fs::is_directory(folder_ / "a" / "b"));
  EXPECT_NO_THROW(createOutputFolder(folder_ / "a" / "b"));
}

TEST_F(OutputFileTest, OutputFolderBelowAFileIsAnEnvironmentError) {
  std::ofstream(folder_ / "file") << "text";
  const fs::path below = folder_ / "file" / "below";
  EXPECT_THAT(environmentErrorOf([&] { createOutputFolder(below); }), HasSubstr(below.string()));
  EXPECT_THAT(environmentErrorOf([&] { createOutputFolder(folder_ / "file"); }), HasSubstr("file"));
  EXPECT_EQ(content(folder_ / "file"), "text");
}

}  // namespace
}  // namespace voroform
