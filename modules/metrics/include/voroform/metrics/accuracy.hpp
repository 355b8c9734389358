// How near a tessellation's boundary B is to the surface S of its form, both ways (thesis 5.3.3).
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"
#include "voroform/metrics/particles.hpp"
#include "voroform/metrics/surface_cvt.hpp"

namespace voroform::metrics {

struct AccuracyOptions {
  // h = (V/n)^(1/3), the size of a cell at the resolution compared, in the form's units, > 0: samples have the spacing
  // h/3, and the thesis's variant searches along normals as far as 2h.
  double cellSize = 0;
  std::uint64_t seed = 0;
};

// Of one direction. Distances in the form's units, angles in radians.
struct DirectedAccuracy {
  std::int64_t samples = 0;
  double mean = 0;
  double rms = 0;
  double max = 0;
  double normalMean = 0;  // angle between the surfaces' normals at the sample and at its nearest point
  double normalRms = 0;
  double variation = 0;      // of the sample set: see SurfaceSamples
  std::int64_t unfound = 0;  // samples for which no nearest point was found; they count in no mean and are reported
  // Samples whose nearest point lies on the envelope, as happens at the rim of an open scan; they count in no mean
  // either.
  std::int64_t envelope = 0;
};

// The thesis's variant: the nearest crossing of the other surface along the normal at the sample (of the facet, or of
// S), to either side, up to 2h.
struct NormalLineAccuracy {
  std::int64_t misses = 0;  // samples without a crossing; their distance counts as 2h
  double mean = 0;          // ½(mean S→B + mean B→S)
  double rms = 0;
};

struct Accuracy {
  double dmean = 0;  // ½(mean S→B + mean B→S)
  double drmse = 0;  // √(½(ms S→B + ms B→S))
  double dmax = 0;
  double nmean = 0;  // as dmean and drmse, of the angles
  double nrmse = 0;
  DirectedAccuracy fromForm;      // samples on S, nearest point on B
  DirectedAccuracy fromBoundary;  // samples on B, nearest point on S
  NormalLineAccuracy normalLine;
  double cellSize = 0;  // h
  double diagonal = 0;  // of the bounding box of the samples on S
  double seconds = 0;
};

// A sample with its nearest point on the other surface.
struct AccuracyPair {
  Vec3 sample;
  Vec3 nearest;
  double distance = 0;
  double angle = 0;
};

// The pairs that count in the means, for files and pictures; in the samples' order.
struct AccuracyPairs {
  std::vector<AccuracyPair> fromForm;
  std::vector<AccuracyPair> fromBoundary;
};

// `samples` are those of S (particleSamples with spacing h/3): made once, used for every method. Boundary faces and
// parts of S on the envelope are left out on both sides: no samples are taken there, and samples whose nearest point on
// the other surface lies there are left out (near the rim, which facets of a tessellation count as envelope is a matter
// of their tags, not of their shape). `pairs` may be null. The same bits for any number of threads. Throws UsageError
// if there are no samples of S or h is not above 0, MethodError if the boundary has no face off the envelope or one
// surface is nowhere near the other.
Accuracy accuracy(const mesh::PolyhedralComplex& complex, const implicit::ImplicitFunction& f,
                  const SurfaceSamples& samples, const AccuracyOptions& options, const RunContext& context,
                  AccuracyPairs* pairs = nullptr);

}  // namespace voroform::metrics
