#include "voroform/core/parallel.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "voroform/core/error.hpp"

namespace voroform {
namespace {

RunContext withThreads(int threads) {
  RunContext context;
  context.threads = threads;
  return context;
}

std::set<std::pair<std::size_t, std::size_t>> chunksOf(int threads, std::size_t count, std::size_t grain) {
  std::mutex mutex;
  std::set<std::pair<std::size_t, std::size_t>> chunks;
  parallelFor(withThreads(threads), count, grain, [&](std::size_t begin, std::size_t end) {
    const std::lock_guard lock(mutex);
    chunks.emplace(begin, end);
  });
  return chunks;
}

TEST(Parallel, VisitsEveryIndexOnce) {
  for (const int threads : {1, 2, 4}) {
    for (const std::size_t count : {1U, 9U, 10U, 11U, 1000U}) {
      std::vector<std::atomic<int>> visits(count);
      parallelFor(withThreads(threads), count, 10, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (const auto& visit : visits) ASSERT_EQ(visit.load(), 1) << threads << " threads, count " << count;
    }
  }
}

TEST(Parallel, ChunksDependOnCountAndGrainAlone) {
  const std::set<std::pair<std::size_t, std::size_t>> expected = {{0, 30}, {30, 60}, {60, 90}, {90, 100}};
  for (const int threads : {1, 2, 3, 8}) EXPECT_EQ(chunksOf(threads, 100, 30), expected) << threads << " threads";
}

TEST(Parallel, CallsNothingForNothing) { EXPECT_TRUE(chunksOf(2, 0, 10).empty()); }

TEST(Parallel, TakesGrainZeroForOne) { EXPECT_EQ(chunksOf(2, 3, 0).size(), 3U); }

TEST(Parallel, UsesSeveralThreads) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "this machine has one core";
  // Each of two chunks waits for the other to start: without two threads this would never end, so the wait is bounded.
  std::atomic<int> started{0};
  std::atomic<bool> met{true};
  parallelFor(withThreads(2), 2, 1, [&](std::size_t, std::size_t) {
    ++started;
    for (int i = 0; started < 2; ++i) {
      if (i > 5000) {
        met = false;
        return;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  EXPECT_TRUE(met);
}

TEST(Parallel, RethrowsTheBodysException) {
  for (const int threads : {1, 4}) {
    const auto body = [](std::size_t begin, std::size_t) {
      if (begin == 50) throw std::out_of_range("chunk 50");
    };
    EXPECT_THROW(parallelFor(withThreads(threads), 100, 10, body), std::out_of_range) << threads << " threads";
  }
}

TEST(Parallel, StopsBeforeTheNextChunkOnceCancelled) {
  for (const int threads : {1, 2}) {
    std::atomic<bool> cancelled{false};
    std::atomic<int> chunks{0};
    RunContext context = withThreads(threads);
    context.cancelled = &cancelled;
    const auto body = [&](std::size_t, std::size_t) {
      ++chunks;
      cancelled = true;
    };
    EXPECT_THROW(parallelFor(context, 1000, 1, body), Cancelled);
    EXPECT_LE(chunks, threads) << "every thread may have begun one chunk";
  }
}

TEST(Parallel, StartsNothingIfCancelledBefore) {
  const std::atomic<bool> cancelled{true};
  RunContext context = withThreads(2);
  context.cancelled = &cancelled;
  bool called = false;
  EXPECT_THROW(parallelFor(context, 10, 1, [&](std::size_t, std::size_t) { called = true; }), Cancelled);
  EXPECT_FALSE(called);
}

double harmonicSum(int threads, std::size_t count, std::size_t grain) {
  return parallelReduce(
      withThreads(threads), count, grain, 0.0,
      [](std::size_t begin, std::size_t end, double sum) {
        for (std::size_t i = begin; i < end; ++i) sum += 1 / static_cast<double>(i + 1);
        return sum;
      },
      [](double a, double b) { return a + b; });
}

TEST(Parallel, ReductionsGiveTheSameBitsForAnyNumberOfThreads) {
  const double expected = harmonicSum(1, 100'000, 1000);
  for (const int threads : {2, 3, 4, 7}) EXPECT_EQ(harmonicSum(threads, 100'000, 1000), expected) << threads;
  // The negative control: another grain is another order of summation, and rounds differently.
  EXPECT_NE(harmonicSum(1, 100'000, 100'000), expected);
}

TEST(Parallel, JoinsPartialResultsInTheirOrder) {
  const auto result = parallelReduce(
      withThreads(4), 10, 3, std::vector<std::size_t>{},
      [](std::size_t begin, std::size_t end, std::vector<std::size_t> list) {
        for (std::size_t i = begin; i < end; ++i) list.push_back(i);
        return list;
      },
      [](std::vector<std::size_t> a, const std::vector<std::size_t>& b) {
        a.insert(a.end(), b.begin(), b.end());
        return a;
      });
  EXPECT_THAT(result, testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
}

TEST(Parallel, ReductionOfNothingIsTheInitialValue) { EXPECT_EQ(harmonicSum(2, 0, 10), 0.0); }

TEST(ExclusiveScan, TurnsCountsIntoOffsets) {
  std::vector<int> counts = {3, 0, 2, 5};
  exclusiveScan(counts);
  EXPECT_THAT(counts, testing::ElementsAre(0, 3, 3, 5, 10));
}

TEST(ExclusiveScan, OfNothingIsASingleZero) {
  std::vector<int> counts;
  exclusiveScan(counts);
  EXPECT_THAT(counts, testing::ElementsAre(0));
}

}  // namespace
}  // namespace voroform
