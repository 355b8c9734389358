#include "voroform/core/output_file.hpp"

#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include <unistd.h>

#include "voroform/core/error.hpp"

namespace voroform {

namespace {

// Names of the temporaries that exist, so that an interrupted program can remove them.
struct TemporaryNames {
  std::mutex mutex;
  std::set<std::filesystem::path> names;
};

TemporaryNames& temporaryNames() {
  static TemporaryNames instance;
  return instance;
}

// Why the file cannot be written: a stream forgets the reason of a write that failed before it is asked, but another
// write fails for the same one. 0 if this one succeeds.
int reasonOfFailedWrite(const std::filesystem::path& name) {
  std::ofstream probe(name, std::ios::binary | std::ios::app);
  errno = 0;
  probe << std::string(1 << 16, '\0') << std::flush;
  return probe ? 0 : errno;
}

void forget(const std::filesystem::path& name) {
  const std::lock_guard lock(temporaryNames().mutex);
  temporaryNames().names.erase(name);
}

}  // namespace

OutputFile::OutputFile(std::filesystem::path target) : target_(std::move(target)) {
  temporary_ = target_;
  temporary_ += "." + std::to_string(::getpid()) + ".tmp";
  {
    const std::lock_guard lock(temporaryNames().mutex);
    temporaryNames().names.insert(temporary_);
  }
  errno = 0;
  stream_.open(temporary_, std::ios::binary | std::ios::trunc);
  if (!stream_) fail("cannot create");
}

OutputFile::~OutputFile() {
  if (committed_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
  forget(temporary_);
}

void OutputFile::commit() {
  const bool failedBefore = !stream_;
  errno = 0;
  stream_.flush();
  if (!stream_) {
    if (failedBefore) errno = reasonOfFailedWrite(temporary_);
    fail("cannot write");
  }
  stream_.close();
  if (stream_.fail()) fail("cannot close");
  std::error_code error;
  std::filesystem::rename(temporary_, target_, error);
  if (error) throw EnvironmentError(target_.string() + ": cannot rename the finished file: " + error.message());
  committed_ = true;
  forget(temporary_);
}

void OutputFile::fail(const std::string& action) {
  const int reason = errno;
  const std::string detail = reason != 0 ? std::strerror(reason) : "write error";
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
  forget(temporary_);
  throw EnvironmentError(target_.string() + ": " + action + ": " + detail);
}

void createOutputFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw EnvironmentError(folder.string() + ": cannot create the output folder: " + error.message());
  if (!std::filesystem::is_directory(folder, error)) {
    throw EnvironmentError(folder.string() + ": cannot create the output folder: a file of that name exists");
  }
}

void removeTemporaryFiles() noexcept {
  const std::lock_guard lock(temporaryNames().mutex);
  std::error_code ignored;
  for (const auto& name : temporaryNames().names) std::filesystem::remove(name, ignored);
}

}  // namespace voroform
