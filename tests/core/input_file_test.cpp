#include "voroform/core/input_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <iterator>
#include <string>

#include "voroform/core/error.hpp"

namespace voroform {
namespace {

namespace fs = std::filesystem;

class InputFile : public testing::Test {
 protected:
  InputFile() {
    std::string name = fs::temp_directory_path() / "voroform_input_file_test_XXXXXX";
    EXPECT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  ~InputFile() override { fs::remove_all(folder_); }

  // What opening the path complains of, without the path that it begins with.
  static std::string complaint(const fs::path& path) {
    try {
      openInputFile(path);
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find(path.string() + ": "), 0U) << message;
      return message.substr(path.string().size() + 2);
    }
    return "";
  }

  fs::path folder_;
};

TEST_F(InputFile, IsReadAsBytesAlsoThroughALink) {
  std::ofstream(folder_ / "file", std::ios::binary) << "a\r\nb";
  fs::create_symlink("file", folder_ / "link");
  for (const char* name : {"file", "link"}) {
    std::ifstream stream = openInputFile(folder_ / name);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "a\r\nb");
  }
}

TEST_F(InputFile, ThatIsNotThere) {
  EXPECT_EQ(complaint(folder_ / "none"), "no such file");
  EXPECT_EQ(complaint(""), "no such file");
  fs::create_symlink("none", folder_ / "dangling");
  EXPECT_EQ(complaint(folder_ / "dangling"), "no such file");
}

TEST_F(InputFile, FolderIsNone) { EXPECT_EQ(complaint(folder_), "expected a file, found a folder"); }

// Opening a pipe that nobody writes to would wait for ever.
TEST_F(InputFile, PipesAndDevicesAreNone) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THAT(complaint(pipe), testing::HasSubstr("expected a regular file"));
  EXPECT_THAT(complaint("/dev/zero"), testing::HasSubstr("expected a regular file"));
}

TEST_F(InputFile, ExtensionsAreToldWhateverTheirCase) {
  EXPECT_EQ(lowerCaseExtension("Folder.A/Scan.PlY"), ".ply");
  EXPECT_EQ(lowerCaseExtension("a.tar.GZ"), ".gz");
  EXPECT_EQ(lowerCaseExtension("Folder.A/scan"), "");
  EXPECT_EQ(lowerCaseExtension("a.Ä"), ".Ä");
}

TEST_F(InputFile, ThatMayNotBeRead) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may read everything";
  std::ofstream(folder_ / "secret") << "x";
  fs::permissions(folder_ / "secret", fs::perms::none);
  EXPECT_EQ(complaint(folder_ / "secret"), "cannot be opened: Permission denied");
}

}  // namespace
}  // namespace voroform
