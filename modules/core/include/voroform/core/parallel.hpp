// Parallel loops. The only place that knows the threading library (oneTBB, or plain threads for the thread sanitizer).
//
// Work is cut into chunks whose borders depend on the count and the grain alone, never on the number of threads; a
// reduction joins the chunks' partial results in their order. So results are the same bits for any number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "voroform/core/run_context.hpp"

namespace voroform {

// Calls body(begin, end) for the chunks [0, grain), [grain, 2·grain), … of [0, count), in parallel. Checks for
// cancellation before each chunk. The first exception that a body throws is rethrown here.
void parallelFor(const RunContext& context, std::size_t count, std::size_t grain,
                 const std::function<void(std::size_t begin, std::size_t end)>& body);

// Reduces [0, count): partial results of body(begin, end, T initial) → T by chunk, joined left to right by join(a, b).
template <class T, class Body, class Join>
T parallelReduce(const RunContext& context, std::size_t count, std::size_t grain, T initial, const Body& body,
                 const Join& join) {
  const std::size_t chunks = (count + grain - 1) / grain;
  std::vector<T> partial(chunks, initial);
  parallelFor(context, count, grain,
              [&](std::size_t begin, std::size_t end) { partial[begin / grain] = body(begin, end, initial); });
  T result = initial;
  for (const T& part : partial) result = join(result, part);
  return result;
}

// Replaces values[i] by the sum of values[0 … i-1] and appends the total, so that n counts become n + 1 offsets.
template <class T>
void exclusiveScan(std::vector<T>& values) {
  T sum = 0;
  for (T& value : values) {
    const T count = value;
    value = sum;
    sum += count;
  }
  values.push_back(sum);
}

}  // namespace voroform
