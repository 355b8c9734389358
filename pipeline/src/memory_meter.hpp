// The most memory that a part of a run has resident.
#pragma once

#include <cstdint>

namespace voroform::pipeline {

// Counts what a part of the run takes as if the process held nothing at its start but what it held when the meter was
// made: results of other parts that are kept in memory do not weigh on it. Linux only; elsewhere, and where the system
// does not allow it, all figures are 0.
class MemoryMeter {
 public:
  MemoryMeter();

  // A part begins.
  void start();
  // The most resident since start(), in bytes.
  std::uint64_t peakBytes() const;
  // The same for the figure of a child process that began with a copy of this one at start(); 0 stays 0.
  std::uint64_t ownBytes(std::uint64_t peakOfCopy) const;

 private:
  std::uint64_t base_ = 0;
  std::uint64_t atStart_ = 0;
  bool available_ = false;
};

}  // namespace voroform::pipeline
