#include "console.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include <unistd.h>

#include "voroform/core/error.hpp"

namespace voroform::cli {

namespace {

constexpr int kBarWidth = 30;
constexpr std::chrono::milliseconds kBarInterval{100};

// Not through std::cerr, which is for what libraries print (see CapturedStream).
void print(const char* prefix, std::string_view message) {
  std::fprintf(stderr, "%s%.*s\n", prefix, static_cast<int>(message.size()), message.data());
}

}  // namespace

Console::Console(const Settings& settings)
    : quiet_(settings.quiet),
      verbose_(settings.verbose),
      terminal_(::isatty(STDERR_FILENO) == 1),
      logName_(settings.logFile) {
  if (settings.logFile.empty()) return;
  errno = 0;
  logFile_.open(settings.logFile, std::ios::trunc);
  if (!logFile_) {
    throw EnvironmentError(settings.logFile + ": cannot create the log file: " + std::strerror(errno));
  }
}

Console::~Console() { clearBar(); }

RunContext Console::context(const std::atomic<bool>& cancelled, int threads) {
  RunContext context;
  context.progress = [this](std::string_view stage, double share) { progress(stage, share); };
  context.log = [this](LogLevel level, std::string_view message) { log(level, message); };
  context.cancelled = &cancelled;
  context.threads = threads;
  return context;
}

void Console::error(std::string_view message) {
  const std::lock_guard lock(mutex_);
  clearBar();
  print("voroform: error: ", message);
  writeLog("error", message);
}

void Console::closeLog() {
  const std::lock_guard lock(mutex_);
  if (!logFile_.is_open()) return;
  logFile_.close();
  if (logFile_.fail()) throw EnvironmentError(logName_ + ": the log file could not be written");
}

void Console::progress(std::string_view stage, double share) {
  const std::lock_guard lock(mutex_);
  const bool newStage = stage != stage_;
  if (newStage) {
    stage_ = stage;
    writeLog("stage", stage);
  }
  if (quiet_) return;
  if (!terminal_) {
    if (newStage) print("", stage);
    return;
  }
  // A finished stage leaves no bar in the way of what is printed next.
  if (share >= 1) {
    clearBar();
    return;
  }
  const auto now = Clock::now();
  if (!newStage && now - barTime_ < kBarInterval) return;
  barTime_ = now;
  const double bounded = std::clamp(share, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(bounded * kBarWidth);
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  std::fprintf(stderr, "\r\033[K[%s] %3.0f %% %s", bar.c_str(), 100 * bounded, stage_.c_str());
  std::fflush(stderr);
  barShown_ = true;
}

void Console::log(LogLevel level, std::string_view message) {
  const std::lock_guard lock(mutex_);
  const char* kind = level == LogLevel::warning ? "warning" : level == LogLevel::info ? "info" : "debug";
  writeLog(kind, message);
  if (level == LogLevel::debug && !verbose_) return;
  if (level == LogLevel::info && quiet_) return;
  clearBar();
  print(level == LogLevel::warning ? "warning: " : "", message);
}

void Console::clearBar() {
  if (!barShown_) return;
  std::fputs("\r\033[K", stderr);
  std::fflush(stderr);
  barShown_ = false;
}

void Console::writeLog(std::string_view kind, std::string_view message) {
  if (!logFile_.is_open()) return;
  char time[32];
  std::snprintf(time, sizeof time, "%10.3f", std::chrono::duration<double>(Clock::now() - start_).count());
  logFile_ << time << " s " << kind << ": " << message << std::endl;
}

}  // namespace voroform::cli
