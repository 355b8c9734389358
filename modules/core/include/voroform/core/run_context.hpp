// What a stage needs of its caller: progress, log, cancellation and the number of threads.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <string_view>

namespace voroform {

enum class LogLevel { debug, info, warning };

struct RunContext {
  // Called with the stage's name and the share done, in [0, 1]; from one thread at a time.
  std::function<void(std::string_view stage, double share)> progress;
  // Receives log lines without a line end; from one thread at a time.
  std::function<void(LogLevel level, std::string_view message)> log;
  // Set to true by the caller to stop the run; the running stage then throws Cancelled.
  const std::atomic<bool>* cancelled = nullptr;
  // Most threads to use; 0 means as many as the machine has, and more than these are not used. Results do not depend on
  // it.
  int threads = 0;

  void report(std::string_view stage, double share) const;
  void debug(std::string_view message) const;
  void info(std::string_view message) const;
  void warn(std::string_view message) const;
  // Throws Cancelled if the caller asked to stop.
  void throwIfCancelled() const;
};

// Wall-clock seconds since construction or the last restart.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  void restart() { start_ = Clock::now(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace voroform
