// What several kinds of initial sites are made of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "voroform/core/parallel.hpp"
#include "voroform/cvt/domain.hpp"

namespace voroform::cvt {

inline constexpr std::size_t kCandidateGrain = 4096;

// The most candidates that are worth trying for so many sites; a domain that holds less of them is too thin.
std::size_t mostCandidates(std::size_t sites);
[[noreturn]] void throwTooThin(std::size_t tried, std::size_t inside, std::size_t sites);

struct KeepAll {
  bool operator()(std::size_t, const auto&) const { return true; }
};

// Of the points pointAt(0) … pointAt(count − 1) those inside the domain for which keep(index, point) holds, in their
// order.
template <int M, class PointAt, class Keep = KeepAll>
std::vector<Vec<M>> pointsInside(const Domain<M>& domain, std::size_t count, const PointAt& pointAt,
                                 const RunContext& context, const Keep& keep = {}) {
  std::vector<std::vector<Vec<M>>> chunks((count + kCandidateGrain - 1) / kCandidateGrain);
  parallelFor(context, count, kCandidateGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec<M> p = pointAt(i);
      if (domain.contains(p) && keep(i, p)) chunks[begin / kCandidateGrain].push_back(p);
    }
  });
  std::vector<Vec<M>> inside;
  for (const auto& chunk : chunks) inside.insert(inside.end(), chunk.begin(), chunk.end());
  return inside;
}

// How many of them there are.
template <int M, class PointAt, class Keep = KeepAll>
std::size_t countInside(const Domain<M>& domain, std::size_t count, const PointAt& pointAt, const RunContext& context,
                        const Keep& keep = {}) {
  return parallelReduce(
      context, count, kCandidateGrain, std::size_t{0},
      [&](std::size_t begin, std::size_t end, std::size_t inside) {
        for (std::size_t i = begin; i < end; ++i) {
          const Vec<M> p = pointAt(i);
          if (domain.contains(p) && keep(i, p)) ++inside;
        }
        return inside;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
}

// `count` random points inside, as dense as the domain wants sites, in the order they were drawn. Throws MethodError if
// the domain is too thin.
template <int M>
std::vector<Vec<M>> randomPointsInside(const Domain<M>& domain, std::size_t count, std::uint64_t seed,
                                       const RunContext& context);

// About `count` points inside, of a shifted Hammersley sequence; at least one. Throws MethodError if the domain is too
// thin.
template <int M>
std::vector<Vec<M>> hammersleyPointsInside(const Domain<M>& domain, std::size_t count, std::uint64_t seed,
                                           const RunContext& context);

// Neighbors in the list become neighbors in space.
template <int M>
std::vector<Vec<M>> inSpatialOrder(const std::vector<Vec<M>>& points);

}  // namespace voroform::cvt
