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

void put(const std::filesystem::path& path, const std::string& content) { std::ofstream(path) << content; }

TEST(ArtifactStore, ShowsItsFilesOnlyAfterCommit) {
  const TemporaryFolder base;
  const auto folder = base / "a";
  {
    ArtifactStore store(folder / "b");
    put(store.path("one"), "1");
    put(store.path("two"), "2");
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
    put(store.path("one"), "1");
  }
  EXPECT_THAT(namesIn(base / ""), IsEmpty());
}

TEST(ArtifactStore, KeepsWhatWasThereWithoutCommit) {
  const TemporaryFolder base;
  base.write("one", "old");
  {
    ArtifactStore store(base / "");
    put(store.path("one"), "new");
  }
  EXPECT_THAT(namesIn(base / ""), ElementsAre("one"));
  EXPECT_EQ(readFile(base / "one"), "old");
}

TEST(ArtifactStore, MovesNothingIfOneFileCannotBeMoved) {
  const TemporaryFolder base;
  std::filesystem::create_directories(base / "two");
  {
    ArtifactStore store(base / "");
    put(store.path("one"), "1");
    put(store.path("two"), "2");
    EXPECT_THROW(store.commit(), EnvironmentError);
  }
  EXPECT_THAT(namesIn(base / ""), ElementsAre("two"));
}

TEST(ArtifactStore, IsRemovedOnASignal) {
  const TemporaryFolder base;
  ArtifactStore store(base / "new");
  put(store.path("one"), "1");
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
