// What the parts of compare() share.
#pragma once

#include <string>
#include <string_view>

#include "measuring.hpp"
#include "memory_meter.hpp"
#include "voroform/core/run_context.hpp"
#include "voroform/pipeline/compare.hpp"

namespace voroform::pipeline {

// The method that clips the initial sites.
inline constexpr const char* kNotOptimized = "cvt1@0";

inline bool isCvt(std::string_view method) { return method.starts_with("cvt"); }

// Progress and warnings under a name: "mc: certificate".
RunContext named(const RunContext& context, const std::string& name);

// The form, and what was made of it once for all methods.
struct Comparing {
  const Form& form;
  const CompareOptions& options;
  metrics::InsideSamples inside;
  metrics::SurfaceSamples surface;
  double cellSize = 0;
  MemoryMeter memory;
  double secondsEvaluation = 0;  // so far
};

// Make the tessellation and note seconds and memory. A method that fails sets `failure`.
void makeMarchingCubes(Comparing& comparing, const baselines::CubeGrid& grid, MethodOutcome& outcome,
                       const RunContext& context);
void makeDelaunay(Comparing& comparing, const baselines::DelaunayOptions& options, MethodOutcome& outcome,
                  const RunContext& context);

// The same with its boundary fitted, for a baseline that finished; makes and measures none of the rest anew.
MethodOutcome fittedBaseline(Comparing& comparing, const baselines::CubeGrid& grid, const MethodOutcome& baseline,
                             const RunContext& context);

// Measures a tessellation; does nothing for a method that failed.
void evaluateOutcome(Comparing& comparing, MethodOutcome& outcome, const RunContext& context);

// As the comparison's options have it, for cubes of this edge.
baselines::DelaunayOptions delaunayOptions(const CompareOptions& options, double cubeEdge);

// The runs of Marching Cubes and Delaunay refinement at the triangle counts of the CVTs among `methods`.
std::vector<MethodOutcome> equalTriangles(Comparing& comparing, const baselines::CubeGrid& grid,
                                          const std::vector<MethodOutcome>& methods, const RunContext& context);

}  // namespace voroform::pipeline
