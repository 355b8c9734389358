#include "voroform/core/parallel.hpp"

#include <algorithm>
#include <thread>

#ifdef VOROFORM_PLAIN_THREADS
#include <atomic>
#include <exception>
#include <mutex>
#else
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#endif

namespace voroform {

namespace {

int threadCount(const RunContext& context) {
  const int machine = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  return context.threads > 0 ? context.threads : machine;
}

}  // namespace

void parallelFor(const RunContext& context, std::size_t count, std::size_t grain,
                 const std::function<void(std::size_t begin, std::size_t end)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t chunks = (count + grain - 1) / grain;
  const auto runChunk = [&](std::size_t chunk) {
    context.throwIfCancelled();
    body(chunk * grain, std::min(count, (chunk + 1) * grain));
  };
  const int threads = threadCount(context);
  if (threads == 1 || chunks == 1) {
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) runChunk(chunk);
    return;
  }
#ifdef VOROFORM_PLAIN_THREADS
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failureMutex;
  const auto work = [&] {
    try {
      for (std::size_t chunk = next++; chunk < chunks; chunk = next++) runChunk(chunk);
    } catch (...) {
      next = chunks;
      const std::lock_guard lock(failureMutex);
      if (!failure) failure = std::current_exception();
    }
  };
  std::vector<std::thread> pool;
  const std::size_t helpers = std::min<std::size_t>(static_cast<std::size_t>(threads), chunks) - 1;
  for (std::size_t i = 0; i < helpers; ++i) pool.emplace_back(work);
  work();
  for (std::thread& thread : pool) thread.join();
  if (failure) std::rethrow_exception(failure);
#else
  // An arena of its own for every number of threads asked for; oneTBB reuses the same worker threads for all of them.
  // It has no more of them than the machine has cores, and complains on stderr if asked for more.
  oneapi::tbb::task_arena arena(std::min(threads, oneapi::tbb::info::default_concurrency()));
  arena.execute(
      [&] { oneapi::tbb::parallel_for(std::size_t{0}, chunks, runChunk, oneapi::tbb::simple_partitioner{}); });
#endif
}

}  // namespace voroform
