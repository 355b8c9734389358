// Output files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>

namespace voroform {

// Writes to a temporary name beside the target; commit() flushes, checks and renames. Without commit the temporary is
// removed and an older file of the target's name stays as it was. Every failure throws EnvironmentError with the path
// and the system's reason.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path target);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  std::ostream& stream() { return stream_; }
  void commit();

 private:
  [[noreturn]] void fail(const std::string& action);

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::ofstream stream_;
  bool committed_ = false;
};

// Creates the folder and its parents; throws EnvironmentError if that fails or if a file stands in the way.
void createOutputFolder(const std::filesystem::path& folder);

// Removes the temporaries of all files that are open now: for a program that is about to exit on a signal.
void removeTemporaryFiles() noexcept;

}  // namespace voroform
