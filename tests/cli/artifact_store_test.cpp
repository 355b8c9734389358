#include "voroform/pipeline/artifact_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "program.hpp"
#include "voroform/core/error.hpp"

namespace voroform::pipeline {
namespace {

using test::namesIn;
using test::readFile;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::IsEmpty;

auto writer(const std::string& content) {
  return [content](const std::filesystem::path& path) { std::ofstream(path) << content; };
}

TEST(ArtifactStore, ShowsItsFilesOnlyAfterCommit) {
  const TemporaryFolder base;
  const auto folder = base / "a";
  {
    ArtifactStore store(folder / "b");
    store.put("one", writer("1"));
    store.put("two", writer("2"));
    EXPECT_THAT(namesIn(folder / "b"), ElementsAre(testing::StartsWith(".partial-")));
    store.commit();
    EXPECT_THAT(store.names(), ElementsAre("one", "two"));
  }
  EXPECT_THAT(namesIn(folder / "b"), ElementsAre("one", "two"));
  EXPECT_EQ(readFile(folder / "b" / "two"), "2");
}

TEST(ArtifactStore, LeavesNothingWithoutCommit) {
  const TemporaryFolder base;
  {
    ArtifactStore store(base / "new" / "deep");
    store.put("one", writer("1"));
  }
  EXPECT_THAT(namesIn(base / ""), IsEmpty());
}

TEST(ArtifactStore, KeepsWhatWasThereWithoutCommit) {
  const TemporaryFolder base;
  base.write("one", "old");
  {
    ArtifactStore store(base / "");
    store.put("one", writer("new"));
  }
  EXPECT_THAT(namesIn(base / ""), ElementsAre("one"));
  EXPECT_EQ(readFile(base / "one"), "old");
}

TEST(ArtifactStore, MovesNothingIfOneFileCannotBeMoved) {
  const TemporaryFolder base;
  std::filesystem::create_directories(base / "two");
  {
    ArtifactStore store(base / "");
    store.put("one", writer("1"));
    store.put("two", writer("2"));
    EXPECT_THROW(store.commit(), EnvironmentError);
  }
  EXPECT_THAT(namesIn(base / ""), ElementsAre("two"));
}

TEST(ArtifactStore, MakesSubfolders) {
  const TemporaryFolder base;
  {
    ArtifactStore store(base / "out");
    store.put("mc/one", writer("1"));
    store.put("mc/two", writer("2"));
    store.put("three", writer("3"));
    EXPECT_THAT(namesIn(base / "out"), ElementsAre(testing::StartsWith(".partial-")));
    store.commit();
  }
  EXPECT_THAT(namesIn(base / "out"), ElementsAre("mc", "three"));
  EXPECT_THAT(namesIn(base / "out/mc"), ElementsAre("one", "two"));
}

TEST(ArtifactStore, LeavesNoSubfolderBehindIfOneFileCannotBeMoved) {
  const TemporaryFolder base;
  base.write("cvt", "a file where a folder is to be");
  {
    ArtifactStore store(base / "");
    store.put("mc/one", writer("1"));
    store.put("cvt/one", writer("1"));
    EXPECT_THROW(store.commit(), EnvironmentError);
  }
  EXPECT_THAT(namesIn(base / ""), ElementsAre("cvt"));
}

TEST(ArtifactStore, NamesTheFinalPathOfWhatCouldNotBeWritten) {
  const TemporaryFolder base;
  const auto failing = [](const std::filesystem::path& path) { throw EnvironmentError(path.string() + ": disk full"); };
  std::string message;
  {
    ArtifactStore store(base / "out");
    try {
      store.put("one", failing);
    } catch (const EnvironmentError& error) {
      message = error.what();
    }
  }
  EXPECT_EQ(message, (base / "out/one").string() + ": disk full");
}

TEST(ArtifactStore, IsRemovedOnASignal) {
  const TemporaryFolder base;
  ArtifactStore store(base / "new");
  store.put("one", writer("1"));
  removeUncommittedArtifacts();
  EXPECT_THAT(namesIn(base / ""), IsEmpty());
}

TEST(ArtifactStore, RefusesAPathBelowAFileBeforeAnythingIsCreated) {
  const TemporaryFolder base;
  const std::string file = base.write("file", "x");
  EXPECT_THROW(checkOutputFolder(file), EnvironmentError);
  EXPECT_THROW(checkOutputFolder(std::filesystem::path(file) / "below"), EnvironmentError);
  EXPECT_THROW(ArtifactStore(std::filesystem::path(file) / "below"), EnvironmentError);
  EXPECT_NO_THROW(checkOutputFolder(base / "free/deep"));
  EXPECT_THAT(namesIn(base / ""), ElementsAre("file"));
}

}  // namespace
}  // namespace voroform::pipeline
