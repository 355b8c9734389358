#include "program.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace voroform::test {

namespace {

constexpr std::chrono::milliseconds kPollInterval{2};

[[noreturn]] void becomeCommand(const std::vector<std::string>& command, const RunOptions& options,
                                const std::string& outPath, const std::string& errPath) {
  const int out = ::open(outPath.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err = ::open(errPath.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  if (options.fileSizeLimit) {
    const rlimit limit = {*options.fileSizeLimit, *options.fileSizeLimit};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  ::execvp(arguments[0], arguments.data());
  ::_exit(127);
}

}  // namespace

std::string programPath() { return VOROFORM_PROGRAM; }

Outcome runCommand(const std::vector<std::string>& command, const RunOptions& options) {
  const TemporaryFolder folder;
  const std::string outPath = folder / "out";
  const std::string errPath = folder / "err";
  folder.write("out", "");
  folder.write("err", "");
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) becomeCommand(command, options, outPath, errPath);
  int status = 0;
  bool sent = !options.sendSignalWhen;
  while (!sent && ::waitpid(child, &status, WNOHANG) == 0) {
    if (options.sendSignalWhen(readFile(errPath))) {
      ::kill(child, options.signal);
      sent = true;
    } else {
      std::this_thread::sleep_for(kPollInterval);
    }
  }
  // Where the child ended before a signal was due, it has been waited for already.
  if (sent) ::waitpid(child, &status, 0);
  Outcome outcome;
  outcome.exitCode = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  outcome.out = readFile(outPath);
  outcome.err = readFile(errPath);
  return outcome;
}

Outcome run(const std::vector<std::string>& arguments, const RunOptions& options) {
  std::vector<std::string> command = {programPath()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return runCommand(command, options);
}

TemporaryFolder::TemporaryFolder() {
  std::string name = std::filesystem::temp_directory_path() / "voroform_test_XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot create " + name);
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& content) const {
  std::ofstream stream(path_ / name, std::ios::binary);
  stream << content;
  stream.close();
  if (!stream) throw std::runtime_error("cannot write " + (path_ / name).string());
  return path_ / name;
}

std::string readFile(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error("cannot read " + path.string());
  std::ostringstream content;
  content << stream.rdbuf();
  return content.str();
}

nlohmann::ordered_json readJson(const std::filesystem::path& path) {
  return nlohmann::ordered_json::parse(readFile(path));
}

std::vector<std::string> namesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<OrientedPoint> torusPoints(int count) {
  constexpr double kMajor = 1;
  constexpr double kMinor = 0.4;
  constexpr double kGoldenRatio = std::numbers::phi;
  std::vector<OrientedPoint> points;
  for (int i = 0; i < count; ++i) {
    // The area up to the angle v about the tube is proportional to v + (r/R) sin v: solved by fixed-point steps.
    const double share = 2 * std::numbers::pi * (i + 0.5) / count;
    double v = share;
    for (int step = 0; step < 60; ++step) v = share - kMinor / kMajor * std::sin(v);
    const double u = 2 * std::numbers::pi * std::fmod(i * kGoldenRatio, 1.0);
    const Vec3 normal(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v));
    const Vec3 center(kMajor * std::cos(u), kMajor * std::sin(u), 0);
    points.push_back({center + kMinor * normal, normal});
  }
  return points;
}

std::string xyzText(const std::vector<OrientedPoint>& points) {
  std::string text;
  char line[256];
  for (const auto& [p, n] : points) {
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g %.17g %.17g %.17g\n", p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
    text += line;
  }
  return text;
}

}  // namespace voroform::test
