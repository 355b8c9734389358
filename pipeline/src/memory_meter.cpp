#include "memory_meter.hpp"

#include <malloc.h>

#include <fstream>
#include <string>

namespace voroform::pipeline {

namespace {

// A value of /proc/self/status, which counts in kB; 0 if there is none.
std::uint64_t statusBytes(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != key) continue;
    std::uint64_t kilobytes = 0;
    return status >> kilobytes ? kilobytes * 1024 : 0;
  }
  return 0;
}

// Makes what is resident now the peak (proc(5), clear_refs).
bool resetPeak() {
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;
  return static_cast<bool>(file);
}

// Without what the allocator keeps of memory that was given back.
std::uint64_t resident() {
#ifdef __GLIBC__
  ::malloc_trim(0);
#endif
  return statusBytes("VmRSS:");
}

}  // namespace

MemoryMeter::MemoryMeter() : base_(resident()) {}

void MemoryMeter::start() {
  atStart_ = resident();
  available_ = atStart_ > 0 && resetPeak();
}

std::uint64_t MemoryMeter::peakBytes() const { return available_ ? ownBytes(statusBytes("VmHWM:")) : 0; }

std::uint64_t MemoryMeter::ownBytes(std::uint64_t peakOfCopy) const {
  if (peakOfCopy == 0) return 0;
  const std::uint64_t others = atStart_ > base_ ? atStart_ - base_ : 0;
  return peakOfCopy > others ? peakOfCopy - others : 0;
}

}  // namespace voroform::pipeline
