#include "signals.hpp"

#include <chrono>
#include <csignal>

#include <pthread.h>
#include <unistd.h>

#include "exit_codes.hpp"
#include "voroform/core/output_file.hpp"
#include "voroform/pipeline/artifact_store.hpp"

namespace voroform::cli {

namespace {

constexpr std::chrono::milliseconds kGrace{500};

sigset_t watchedSignals() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

}  // namespace

SignalWatch::SignalWatch() {
  const sigset_t set = watchedSignals();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  thread_ = std::thread([this] { wait(); });
}

SignalWatch::~SignalWatch() {
  {
    const std::lock_guard lock(mutex_);
    done_ = true;
  }
  ended_.notify_all();
  pthread_kill(thread_.native_handle(), SIGTERM);  // wakes the thread if it still waits for a signal
  thread_.join();
}

void SignalWatch::wait() {
  const sigset_t set = watchedSignals();
  int signal = 0;
  sigwait(&set, &signal);
  std::unique_lock lock(mutex_);
  if (done_) return;
  cancelled_ = true;
  if (ended_.wait_for(lock, kGrace, [this] { return done_; })) return;
  pipeline::removeUncommittedArtifacts();
  removeTemporaryFiles();
  constexpr char kMessage[] = "\nvoroform: interrupted\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  ::_exit(kExitInterrupted);
}

}  // namespace voroform::cli
