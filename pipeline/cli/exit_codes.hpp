#pragma once

namespace voroform::cli {

inline constexpr int kExitDone = 0;
inline constexpr int kExitEnvironment = 1;  // cannot write, disk full, not enough memory
inline constexpr int kExitUsage = 2;        // unknown command, option or key; value out of range
inline constexpr int kExitInput = 3;        // input missing, unreadable or invalid
inline constexpr int kExitMethod = 4;       // the method failed on a valid input
inline constexpr int kExitInterrupted = 130;

}  // namespace voroform::cli
