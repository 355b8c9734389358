// SIGINT and SIGTERM end a run cleanly.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace voroform::cli {

// Blocks both signals for the calling thread and all that it starts later; a thread of its own waits for them. On a
// signal it sets the flag, gives the run half a second for a clean end, and then removes what was being written and
// exits the process with status 130: a solver of another library may be at work that cannot be cancelled.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  const std::atomic<bool>& cancelled() const { return cancelled_; }

 private:
  void wait();

  std::atomic<bool> cancelled_ = false;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool done_ = false;
  std::thread thread_;
};

}  // namespace voroform::cli
