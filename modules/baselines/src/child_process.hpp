// Work in a child process: it can be stopped at any time, its memory is counted apart, and its crash is not ours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"

namespace voroform::baselines {

enum class ChildEnd {
  answered,
  timedOut,
  failed,  // it threw, crashed, or ended without an answer
};

struct ChildReport {
  ChildEnd end = ChildEnd::failed;
  std::vector<std::byte> answer;      // what the work returned
  std::string message;                // what was thrown, or how the child ended; empty if it answered
  std::uint64_t peakMemoryBytes = 0;  // most memory resident at a time, with what this process held when it forked
};

// Runs the work in a forked copy of this process and waits. Only the calling thread lives on in the copy, so the work
// may neither use other threads nor wait for a lock that one of them may hold. The child is killed after `timeLimit`
// seconds (0: none), and when this process ends. Throws Cancelled, and EnvironmentError if there can be no child.
ChildReport runInChild(const std::function<std::vector<std::byte>()>& work, double timeLimit,
                       const RunContext& context);

}  // namespace voroform::baselines
