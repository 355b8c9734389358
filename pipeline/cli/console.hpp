// What the program prints while it works.
#pragma once

#include <chrono>
#include <fstream>
#include <mutex>
#include <string>
#include <string_view>

#include "options.hpp"
#include "voroform/core/run_context.hpp"

namespace voroform::cli {

// Progress (a bar on a terminal, a line a stage otherwise), messages and warnings on the standard error stream, and all
// messages in the log file.
class Console {
 public:
  // Throws EnvironmentError if the log file cannot be written.
  explicit Console(const Settings& settings);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  // The sinks for a run; the console must outlive it.
  RunContext context(const std::atomic<bool>& cancelled, int threads);
  void error(std::string_view message);
  // Throws EnvironmentError if the log file could not be written in full.
  void closeLog();

 private:
  void progress(std::string_view stage, double share);
  void log(LogLevel level, std::string_view message);
  void clearBar();
  void writeLog(std::string_view kind, std::string_view message);

  using Clock = std::chrono::steady_clock;
  const bool quiet_;
  const bool verbose_;
  const bool terminal_;
  const Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  std::string logName_;
  std::ofstream logFile_;
  std::string stage_;
  bool barShown_ = false;
  Clock::time_point barTime_{};
};

}  // namespace voroform::cli
