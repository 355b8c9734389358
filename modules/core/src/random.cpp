#include "voroform/core/random.hpp"

#include <cmath>
#include <numbers>

namespace voroform {

namespace {

std::uint64_t mix(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBULL;
  return x ^ (x >> 31U);
}

// x·2⁻⁵³ for the upper 53 bits.
double toUnit(std::uint64_t bits) { return static_cast<double>(bits >> 11U) * 0x1.0p-53; }

template <int M>
Vec<M> placeInBox(const Vec<M>& unit, const Box<M>& box) {
  return box.min() + unit.cwiseProduct(box.sizes());
}

}  // namespace

std::uint64_t randomBits(std::uint64_t seed, RandomStream stream, std::uint64_t index) {
  return mix(mix(mix(seed) ^ static_cast<std::uint64_t>(stream)) ^ index);
}

double randomUnit(std::uint64_t seed, RandomStream stream, std::uint64_t index) {
  return toUnit(randomBits(seed, stream, index));
}

Vec2 randomInBox(std::uint64_t seed, RandomStream stream, std::uint64_t index, const Box2& box) {
  return placeInBox<2>({randomUnit(seed, stream, 2 * index), randomUnit(seed, stream, 2 * index + 1)}, box);
}

Vec3 randomInBox(std::uint64_t seed, RandomStream stream, std::uint64_t index, const Box3& box) {
  const Vec3 unit(randomUnit(seed, stream, 3 * index), randomUnit(seed, stream, 3 * index + 1),
                  randomUnit(seed, stream, 3 * index + 2));
  return placeInBox<3>(unit, box);
}

Vec3 quasiRandomInBox(std::uint64_t seed, std::uint64_t index, const Box3& box) {
  // Powers of 1/g in units of 2⁻⁶⁴, g the real root of g⁴ = g + 1; integer arithmetic keeps the sequence exact.
  constexpr std::uint64_t kSteps[3] = {15111065706836454659ULL, 12378569675163806722ULL, 10140184033053478359ULL};
  Vec3 unit;
  for (std::uint64_t axis = 0; axis < 3; ++axis) {
    unit[static_cast<Index>(axis)] = toUnit(randomBits(seed, RandomStream::volume, axis) + (index + 1) * kSteps[axis]);
  }
  return placeInBox<3>(unit, box);
}

Mat3 randomRotation(std::uint64_t seed) {
  const double u = randomUnit(seed, RandomStream::orientation, 0);
  const double a = 2 * std::numbers::pi * randomUnit(seed, RandomStream::orientation, 1);
  const double b = 2 * std::numbers::pi * randomUnit(seed, RandomStream::orientation, 2);
  const Eigen::Quaterniond rotation(std::sqrt(u) * std::cos(b), std::sqrt(1 - u) * std::sin(a),
                                    std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b));
  return rotation.normalized().toRotationMatrix();
}

}  // namespace voroform
