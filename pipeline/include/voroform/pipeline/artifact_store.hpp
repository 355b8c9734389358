// The folder that a run writes its results to: all of them appear, or none.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace voroform::pipeline {

// Files are written to a hidden folder inside the output folder and moved into place by commit(), the last named last.
// Without commit nothing remains: the hidden folder goes, and the output folder too if this run created it.
class ArtifactStore {
 public:
  // Creates the folder, its parents and the hidden folder. Throws EnvironmentError.
  explicit ArtifactStore(std::filesystem::path folder);
  ~ArtifactStore();
  ArtifactStore(const ArtifactStore&) = delete;
  ArtifactStore& operator=(const ArtifactStore&) = delete;

  // Calls write with the path to write the file to that will be folder/name; messages of what it throws name the
  // latter. Files are moved in the order in which they were written. The name may hold subfolders ("mc/cells.vtu").
  void put(const std::string& name, const std::function<void(const std::filesystem::path&)>& write);
  // Where a file that was put lies until commit().
  std::filesystem::path pathOf(const std::string& name) const { return staging_ / name; }
  const std::vector<std::string>& names() const { return names_; }
  void commit();

 private:
  void createSubfolders();

  std::filesystem::path folder_;
  std::filesystem::path staging_;
  std::vector<std::filesystem::path> createdFolders_;  // outermost first
  std::vector<std::string> names_;
  bool committed_ = false;
};

// Throws EnvironmentError if the folder cannot be there to write to: a file stands in its way, or the permission lacks.
// Creates nothing, so that a long run can fail at its start.
void checkOutputFolder(const std::filesystem::path& folder);

// Removes what uncommitted stores have written: for a program that is about to exit on a signal. Waits for a commit
// that is under way.
void removeUncommittedArtifacts() noexcept;

}  // namespace voroform::pipeline
