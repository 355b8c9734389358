// The exceptions that voroform throws. The program maps each to an exit code; a library user can catch Error.
#pragma once

#include <stdexcept>
#include <string>

namespace voroform {

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The environment failed: a file cannot be written, the disk is full, memory does not suffice (exit 1).
struct EnvironmentError : Error {
  using Error::Error;
};

// Bad usage: unknown command, option or key; a value out of its range (exit 2).
struct UsageError : Error {
  using Error::Error;
};

// The input is missing, unreadable or invalid (exit 3). The message names the file and the line or record.
struct InputError : Error {
  using Error::Error;
};

// The method failed on a valid input (exit 4). The message says what to change.
struct MethodError : Error {
  using Error::Error;
};

// The run was cancelled through RunContext::cancelled (exit 130).
struct Cancelled : Error {
  Cancelled() : Error("cancelled") {}
};

}  // namespace voroform
