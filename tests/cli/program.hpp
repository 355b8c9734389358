// Runs the program and gives what it did; makes input files.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "voroform/core/types.hpp"

namespace voroform::test {

struct Outcome {
  int exitCode = -1;  // minus the signal's number if one ended the program
  std::string out;
  std::string err;
};

struct RunOptions {
  std::optional<std::uint64_t> fileSizeLimit;  // bytes; a larger write fails
  // Called over and over with what the program has printed on stderr; the signal is sent once it returns true.
  std::function<bool(const std::string& err)> sendSignalWhen;
  int signal = 0;
};

// Runs the program with the arguments and waits for its end.
Outcome run(const std::vector<std::string>& arguments, const RunOptions& options = {});
// Runs any other command, looked up in PATH.
Outcome runCommand(const std::vector<std::string>& command, const RunOptions& options = {});
std::string programPath();

// A folder that is removed with all its content.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  // Writes a file and returns its path as text.
  std::string write(const std::string& name, const std::string& content) const;

 private:
  std::filesystem::path path_;
};

std::string readFile(const std::filesystem::path& path);
nlohmann::ordered_json readJson(const std::filesystem::path& path);
// The names in a folder, sorted, hidden ones included.
std::vector<std::string> namesIn(const std::filesystem::path& folder);

struct OrientedPoint {
  Vec3 position;
  Vec3 normal;
};
// Points spread over a torus (R 1, r 0.4, axis z) by area, with outward normals.
std::vector<OrientedPoint> torusPoints(int count);
// "x y z nx ny nz" a line, 17 digits.
std::string xyzText(const std::vector<OrientedPoint>& points);

}  // namespace voroform::test
