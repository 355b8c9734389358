// How faithful a tessellation is to the form it was made from.
#pragma once

#include <cstdint>
#include <span>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

struct FidelityOptions {
  // Quasi-random points in the form's bounds: for the volume, and for the share of the inside that no cell holds.
  std::int64_t volumeSamples = 2'000'000;
  // Points of the cloud and their spacing, for unsupportedShare; empty: there is no cloud.
  std::span<const Vec3> points = {};
  double spacing = 0;
  std::uint64_t seed = 0;
};

struct Fidelity {
  double sampledVolume = 0;           // of {f < 0}
  double sampledVolumeSigma = 0;      // its standard deviation, if the points were random
  double volumeError = 0;             // |enclosed − sampled| / sampled
  double missedShare = 0;             // share of the inside points that lie outside the boundary
  Index disconnectedCells = 0;        // cells whose faces form more than one closed part
  double envelopeShare = 0;           // share of the boundary's area on the envelope
  double unsupportedShare = 0;        // share of the boundary's area farther than four spacings from any point
};

Fidelity fidelity(const mesh::PolyhedralComplex& complex, const implicit::ImplicitFunction& f,
                  const FidelityOptions& options, const RunContext& context);

}  // namespace voroform::metrics
