// Numbers for the few elements of a grid that are used.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "voroform/core/parallel.hpp"
#include "voroform/core/types.hpp"

namespace voroform::baselines {

// Rows of ascending keys; an element's number is its place in all rows joined.
class SparseRows {
 public:
  // enumerate(row, emit) calls emit(key) with the row's keys in ascending order; it is called twice.
  template <class Enumerate>
  SparseRows(const RunContext& context, std::size_t rows, const Enumerate& enumerate) : offsets_(rows, 0) {
    constexpr std::size_t kGrain = 64;
    parallelFor(context, rows, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        std::int64_t count = 0;
        enumerate(row, [&](Index) { ++count; });
        offsets_[row] = count;
      }
    });
    exclusiveScan(offsets_);
    keys_.resize(static_cast<std::size_t>(offsets_.back()));
    parallelFor(context, rows, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        auto next = keys_.begin() + offsets_[row];
        enumerate(row, [&](Index key) { *next++ = key; });
      }
    });
  }

  std::int64_t size() const { return offsets_.back(); }
  std::size_t rowCount() const { return offsets_.size() - 1; }
  std::int64_t begin(std::size_t row) const { return offsets_[row]; }
  std::int64_t end(std::size_t row) const { return offsets_[row + 1]; }
  Index key(std::int64_t number) const { return keys_[static_cast<std::size_t>(number)]; }

  // The number of an element that is there.
  Index find(std::size_t row, Index key) const {
    const auto first = keys_.begin() + offsets_[row];
    const auto last = keys_.begin() + offsets_[row + 1];
    return static_cast<Index>(std::lower_bound(first, last, key) - keys_.begin());
  }

 private:
  std::vector<std::int64_t> offsets_;
  std::vector<Index> keys_;
};

}  // namespace voroform::baselines
