// Random and quasi-random numbers that depend on (seed, stream, index) alone, never on threads or on the order of
// calls.
#pragma once

#include <cstdint>

#include "voroform/core/types.hpp"

namespace voroform {

// Streams keep the uses of one seed apart.
enum class RandomStream : std::uint64_t {
  sites,
  ghosts,
  validation,
  volume,
  reseed,
  orientation,
  sampling,
  insertion,
  test,
  surfaceSampling,
  meshSampling,
  hammersley,
  lattice,
  thinning,
  generalPosition,
  perturbation,
  insertionOrder,
  latticeTurn
};

// 64 random bits for a key: SplitMix64's finalizer over the mixed key.
std::uint64_t randomBits(std::uint64_t seed, RandomStream stream, std::uint64_t index);

// Uniform in [0, 1) with 53 bits.
double randomUnit(std::uint64_t seed, RandomStream stream, std::uint64_t index);

// Uniform in the box.
Vec2 randomInBox(std::uint64_t seed, RandomStream stream, std::uint64_t index, const Box2& box);
Vec3 randomInBox(std::uint64_t seed, RandomStream stream, std::uint64_t index, const Box3& box);

// The index-th point of the additive R3 sequence in the box (M. Roberts 2018), shifted by the seed: quasi-random,
// with an integration error that falls almost like 1/n.
Vec3 quasiRandomInBox(std::uint64_t seed, std::uint64_t index, const Box3& box);

// A uniformly distributed rotation (Shoemake 1992).
Mat3 randomRotation(std::uint64_t seed);

}  // namespace voroform
