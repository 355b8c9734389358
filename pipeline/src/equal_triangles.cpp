// Marching Cubes and Delaunay refinement with as many boundary triangles as a CVT: the stricter comparison.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "comparing.hpp"

namespace voroform::pipeline {

namespace {

// Runs of a method until its number of triangles is the one wanted; it takes two or three.
constexpr int kMostRuns = 8;

// How far a number of triangles is from the one wanted, alike for half and double.
double miss(std::int64_t triangles, std::int64_t target) {
  return std::abs(std::log(static_cast<double>(std::max<std::int64_t>(triangles, 1)) / static_cast<double>(target)));
}

bool equal(std::int64_t triangles, std::int64_t target) {
  return std::abs(static_cast<double>(triangles - target)) <= kEqualTriangles * static_cast<double>(target);
}

// Triangles grow as the square of the resolution.
double scaledEdge(double edge, std::int64_t triangles, std::int64_t target) {
  return edge * std::sqrt(static_cast<double>(triangles) / static_cast<double>(target));
}

using Make = std::function<MethodOutcome(double edge)>;

// The outcome whose number of triangles comes nearest, from the first edge on; one that failed ends the search.
MethodOutcome search(double edge, std::int64_t target, const Make& make, int mostRuns = kMostRuns) {
  MethodOutcome best;
  for (int run = 0; run < mostRuns; ++run) {
    MethodOutcome outcome = make(edge);
    if (!outcome.failure.empty()) return outcome;
    edge = scaledEdge(outcome.cubeEdge, outcome.boundaryTriangles, target);
    if (run == 0 || miss(outcome.boundaryTriangles, target) < miss(best.boundaryTriangles, target)) {
      best = std::move(outcome);
    }
    if (equal(best.boundaryTriangles, target)) break;
  }
  return best;
}

// Cubes of this edge about the same center as `grid`, with a layer of cubes around what it holds without its own.
baselines::CubeGrid gridOfEdge(const baselines::CubeGrid& grid, double edge) {
  constexpr Index kLayers = 2;
  baselines::CubeGrid result;
  result.edge = edge;
  Vec3 sizes;
  Vec3 finer;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    sizes[i] = grid.edge * grid.cubes[axis];
    result.cubes[axis] = static_cast<Index>(std::ceil((grid.cubes[axis] - kLayers) * grid.edge / edge)) + kLayers;
    finer[i] = edge * result.cubes[axis];
  }
  result.origin = grid.origin + 0.5 * (sizes - finer);
  return result;
}

MethodOutcome equalMarchingCubes(Comparing& comparing, const baselines::CubeGrid& grid, const MethodOutcome& rule,
                                 std::int64_t target, const RunContext& context) {
  return search(scaledEdge(grid.edge, rule.boundaryTriangles, target), target, [&](double edge) {
    MethodOutcome outcome;
    outcome.method = rule.method;
    makeMarchingCubes(comparing, gridOfEdge(grid, edge), outcome, context);
    return outcome;
  });
}

// The edge is searched for with refinement alone, for the optimization takes most of the time and hardly changes the
// number of triangles; then all is done, a second time if the optimization did change it.
MethodOutcome equalDelaunay(Comparing& comparing, const MethodOutcome& rule, std::int64_t target,
                            const RunContext& context) {
  const auto make = [&](double edge, bool optimized) {
    baselines::DelaunayOptions options = delaunayOptions(comparing.options, edge);
    if (!optimized) {
      options.lloydIterations = 0;
      options.odtIterations = 0;
      options.perturb = false;
      options.exude = false;
    }
    MethodOutcome outcome;
    outcome.method = rule.method;
    makeDelaunay(comparing, options, outcome, context);
    return outcome;
  };
  const double first = scaledEdge(rule.cubeEdge, rule.boundaryTriangles, target);
  const MethodOutcome refined = search(first, target, [&](double edge) { return make(edge, false); });
  if (!refined.failure.empty()) return refined;
  return search(
      refined.cubeEdge, target, [&](double edge) { return make(edge, true); }, 2);
}

}  // namespace

std::vector<MethodOutcome> equalTriangles(Comparing& comparing, const baselines::CubeGrid& grid,
                                          const std::vector<MethodOutcome>& methods, const RunContext& context) {
  std::vector<MethodOutcome> results;
  // Measures, keeps the figures and lets go of the tessellation.
  const auto keep = [&](MethodOutcome&& outcome, std::int64_t target, const RunContext& ofMethod) {
    evaluateOutcome(comparing, outcome, ofMethod);
    if (!outcome.failure.empty()) ofMethod.warn(outcome.failure);
    if (outcome.failure.empty() && !equal(outcome.boundaryTriangles, target)) {
      ofMethod.warn("has " + std::to_string(outcome.boundaryTriangles) + " boundary triangles, where " +
                    std::to_string(target) + " were aimed at");
    }
    comparing.secondsEvaluation += outcome.secondsEvaluation;
    outcome.complex = {};
    outcome.measurement.moments = {};
    outcome.measurement.regularities = {};
    outcome.measurement.boundaryFlags = {};
    results.push_back(std::move(outcome));
    context.throwIfCancelled();
  };
  std::map<std::int64_t, std::string> done;  // numbers of triangles with the CVT that they were run for
  for (const MethodOutcome& cvt : methods) {
    if (!isCvt(cvt.method) || cvt.method == kNotOptimized || !cvt.failure.empty()) continue;
    const std::int64_t target = cvt.boundaryTriangles;
    // cvt4 has the triangles of cvt3, and so the same opponents.
    if (const auto [place, isNew] = done.try_emplace(target, cvt.method); !isNew) {
      const std::size_t count = results.size();
      for (std::size_t i = 0; i < count; ++i) {
        if (results[i].matched != place->second) continue;
        results.push_back(results[i]);
        results.back().matched = cvt.method;
      }
      continue;
    }
    for (const MethodOutcome& rule : methods) {
      if (isCvt(rule.method) || rule.fit) continue;
      const RunContext ofMethod = named(context, rule.method + " as " + cvt.method);
      MethodOutcome outcome;
      if (!rule.failure.empty()) {
        outcome.failure = "not tried, for at the thesis's rule: " + rule.failure;
      } else if (rule.method == "mc") {
        outcome = equalMarchingCubes(comparing, grid, rule, target, ofMethod);
      } else {
        outcome = equalDelaunay(comparing, rule, target, ofMethod);
      }
      outcome.method = rule.method;
      outcome.matched = cvt.method;
      if (comparing.options.fitBaselines && outcome.failure.empty()) {
        const RunContext ofFit = named(context, rule.method + "+fit as " + cvt.method);
        MethodOutcome fitted = fittedBaseline(comparing, gridOfEdge(grid, outcome.cubeEdge), outcome, ofFit);
        keep(std::move(outcome), target, ofMethod);
        keep(std::move(fitted), target, ofFit);
      } else {
        keep(std::move(outcome), target, ofMethod);
      }
    }
  }
  return results;
}

}  // namespace voroform::pipeline
