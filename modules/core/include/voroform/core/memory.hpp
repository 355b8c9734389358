// How much memory there is to use.
#pragma once

#include <cstdint>

namespace voroform {

// The least of the machine's memory, the limits of the process (RLIMIT_AS) and those of its container (control groups
// mounted at their usual place), in bytes. What other programs hold is not taken off.
std::uint64_t usableMemory();

}  // namespace voroform
