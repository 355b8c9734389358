// How faithful a tessellation is to the form it was made from.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

struct FidelityOptions {
  // Quasi-random points in the form's bounds: for the volume, and for the share of the inside that no cell holds.
  std::int64_t volumeSamples = 2'000'000;
  // About how many of them, evenly chosen, are looked up in the boundary for missedShare, if they are inside.
  std::int64_t missedSamples = 400'000;
  // Points of the cloud, in the complex's local coordinates, and their spacing, for unsupportedShare; empty: there is
  // no cloud.
  std::span<const Vec3> points = {};
  double spacing = 0;
  std::uint64_t seed = 0;
};

// What fidelity needs of the form alone: samples of {f < 0}, made once and used for every tessellation of f.
struct InsideSamples {
  std::int64_t total = 0;    // samples in f.bounds(), inside or not; 0 if none were wanted or the bounds are empty
  double volume = 0;         // of {f < 0}
  double volumeSigma = 0;    // its standard deviation, if the points were random
  std::vector<Vec3> chosen;  // the inside ones of those to be looked up in the boundary
};
// Deterministic for any number of threads.
InsideSamples insideSamples(const implicit::ImplicitFunction& f, const FidelityOptions& options,
                            const RunContext& context);

struct Fidelity {
  double sampledVolume = 0;        // of {f < 0}
  double sampledVolumeSigma = 0;   // its standard deviation, if the points were random
  double volumeError = 0;          // |enclosed − sampled| / sampled; 1 if no sample is inside
  std::int64_t missedSamples = 0;  // inside points that were looked up in the boundary
  double missedShare = 0;          // share of these that lie outside the boundary
  Index disconnectedCells = 0;     // cells whose faces are not all connected across edges
  double envelopeShare = 0;        // share of the boundary's area on the envelope
  double unsupportedShare = 0;     // share of the boundary's area farther than four spacings from any point
};

// Deterministic for any number of threads. The complex and the form share one local frame.
Fidelity fidelity(const mesh::PolyhedralComplex& complex, const InsideSamples& samples, const FidelityOptions& options,
                  const RunContext& context);
// Both in one.
Fidelity fidelity(const mesh::PolyhedralComplex& complex, const implicit::ImplicitFunction& f,
                  const FidelityOptions& options, const RunContext& context);

}  // namespace voroform::metrics
