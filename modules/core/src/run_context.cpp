#include "voroform/core/run_context.hpp"

#include "voroform/core/error.hpp"

namespace voroform {

namespace {

void send(const RunContext& context, LogLevel level, std::string_view message) {
  if (context.log) context.log(level, message);
}

}  // namespace

void RunContext::report(std::string_view stage, double share) const {
  if (progress) progress(stage, share);
}

void RunContext::debug(std::string_view message) const { send(*this, LogLevel::debug, message); }
void RunContext::info(std::string_view message) const { send(*this, LogLevel::info, message); }
void RunContext::warn(std::string_view message) const { send(*this, LogLevel::warning, message); }

void RunContext::throwIfCancelled() const {
  if (cancelled != nullptr && cancelled->load(std::memory_order_relaxed)) throw Cancelled();
}

}  // namespace voroform
