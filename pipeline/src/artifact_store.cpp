#include "voroform/pipeline/artifact_store.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "voroform/core/error.hpp"

namespace voroform::pipeline {

namespace {

namespace fs = std::filesystem;

// Stores that are open now; the mutex is held while one commits.
struct OpenStore {
  const ArtifactStore* store;
  fs::path staging;
  std::vector<fs::path> createdFolders;
};
struct OpenStores {
  std::mutex mutex;
  std::vector<OpenStore> list;
};
OpenStores& openStores() {
  static OpenStores instance;
  return instance;
}

void discard(const fs::path& staging, const std::vector<fs::path>& createdFolders) noexcept {
  std::error_code ignored;
  fs::remove_all(staging, ignored);
  // Innermost first; a folder that others have filled meanwhile stays.
  for (auto folder = createdFolders.rbegin(); folder != createdFolders.rend(); ++folder) fs::remove(*folder, ignored);
}

fs::path absoluteFolder(const fs::path& folder) {
  fs::path result = fs::absolute(folder).lexically_normal();
  return result.has_filename() ? result : result.parent_path();
}

// The folders on the way to `folder` that do not exist, outermost first.
std::vector<fs::path> missingFolders(const fs::path& folder) {
  std::vector<fs::path> missing;
  std::error_code ignored;
  for (fs::path at = absoluteFolder(folder); !at.empty() && !fs::exists(fs::symlink_status(at, ignored));) {
    missing.insert(missing.begin(), at);
    if (at == at.parent_path()) break;
    at = at.parent_path();
  }
  return missing;
}

}  // namespace

void checkOutputFolder(const fs::path& folder) {
  if (folder.empty()) throw EnvironmentError("the output folder's name is empty");
  const std::vector<fs::path> missing = missingFolders(folder);
  const fs::path base = missing.empty() ? absoluteFolder(folder) : missing.front().parent_path();
  std::error_code error;
  if (!fs::is_directory(base, error)) {
    throw EnvironmentError(folder.string() + ": cannot create the output folder: " + base.string() +
                           " is not a folder");
  }
  if (::access(base.c_str(), W_OK | X_OK) != 0) {
    throw EnvironmentError(folder.string() + ": cannot write the output folder: " + base.string() + ": " +
                           std::strerror(errno));
  }
}

ArtifactStore::ArtifactStore(fs::path folder) : folder_(std::move(folder)) {
  checkOutputFolder(folder_);
  createdFolders_ = missingFolders(folder_);
  staging_ = folder_ / (".partial-" + std::to_string(::getpid()));
  {
    const std::lock_guard lock(openStores().mutex);
    openStores().list.push_back({this, staging_, createdFolders_});
  }
  std::error_code error;
  fs::create_directories(staging_, error);
  if (error) {
    discard(staging_, createdFolders_);
    const std::lock_guard lock(openStores().mutex);
    std::erase_if(openStores().list, [this](const OpenStore& open) { return open.store == this; });
    throw EnvironmentError(folder_.string() + ": cannot create the output folder: " + error.message());
  }
}

ArtifactStore::~ArtifactStore() {
  const std::lock_guard lock(openStores().mutex);
  std::erase_if(openStores().list, [this](const OpenStore& open) { return open.store == this; });
  if (!committed_) discard(staging_, createdFolders_);
}

void ArtifactStore::put(const std::string& name, const std::function<void(const fs::path&)>& write) {
  if (const fs::path subfolder = (staging_ / name).parent_path(); subfolder != staging_) {
    std::error_code error;
    fs::create_directories(subfolder, error);
    if (error) throw EnvironmentError((folder_ / name).string() + ": cannot create its folder: " + error.message());
  }
  try {
    write(staging_ / name);
  } catch (const EnvironmentError& error) {
    std::string message = error.what();
    const std::string hidden = staging_.string() + "/";
    if (const auto at = message.find(hidden); at != std::string::npos) {
      message.replace(at, hidden.size(), (folder_ / "").string());
    }
    throw EnvironmentError(message);
  }
  std::erase(names_, name);
  names_.push_back(name);
}

// Those that did not exist go again with the store if the commit fails.
void ArtifactStore::createSubfolders() {
  for (const std::string& name : names_) {
    const fs::path subfolder = (folder_ / name).parent_path();
    for (const fs::path& missing : missingFolders(subfolder)) createdFolders_.push_back(missing);
    std::error_code error;
    fs::create_directories(subfolder, error);
    if (error) throw EnvironmentError(subfolder.string() + ": cannot create the folder: " + error.message());
  }
}

void ArtifactStore::commit() {
  const std::lock_guard lock(openStores().mutex);
  std::error_code error;
  // All that can be foreseen is checked before the first file is moved.
  for (const std::string& name : names_) {
    if (!fs::is_regular_file(staging_ / name, error)) {
      throw EnvironmentError((folder_ / name).string() + ": the finished file has vanished");
    }
    if (fs::is_directory(folder_ / name, error)) {
      throw EnvironmentError((folder_ / name).string() + ": cannot be written: a folder of that name exists");
    }
  }
  createSubfolders();
  for (const std::string& name : names_) {
    fs::rename(staging_ / name, folder_ / name, error);
    if (error) {
      throw EnvironmentError((folder_ / name).string() + ": cannot rename the finished file: " + error.message());
    }
  }
  fs::remove_all(staging_, error);
  committed_ = true;
}

void removeUncommittedArtifacts() noexcept {
  const std::lock_guard lock(openStores().mutex);
  for (const OpenStore& open : openStores().list) discard(open.staging, open.createdFolders);
}

}  // namespace voroform::pipeline
