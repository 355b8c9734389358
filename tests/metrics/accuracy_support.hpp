// What the tests of the accuracy share.
#pragma once

#include <cmath>
#include <numbers>

#include "voroform/core/random.hpp"
#include "voroform/metrics/accuracy.hpp"

namespace voroform::metrics::test {

inline double random(std::uint64_t index) { return randomUnit(23, RandomStream::test, index); }

// Points on a sphere along a spiral, each with about the same area.
inline SurfaceSamples sphereSamples(double radius, int count) {
  SurfaceSamples samples;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    samples.normals.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
    samples.points.push_back(radius * samples.normals.back());
  }
  return samples;
}

inline AccuracyOptions ofSize(double cellSize, std::uint64_t seed = 0) {
  AccuracyOptions options;
  options.cellSize = cellSize;
  options.seed = seed;
  return options;
}

inline Accuracy measure(const mesh::PolyhedralComplex& complex, const implicit::ImplicitFunction& f,
                        const SurfaceSamples& samples, double cellSize, AccuracyPairs* pairs = nullptr) {
  return accuracy(complex, f, samples, ofSize(cellSize), RunContext{}, pairs);
}

}  // namespace voroform::metrics::test
