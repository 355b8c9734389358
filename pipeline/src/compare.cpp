#include "voroform/pipeline/compare.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "comparing.hpp"
#include "records.hpp"
#include "voroform/core/error.hpp"
#include "warnings.hpp"

namespace voroform::pipeline {

namespace {

constexpr Index kLeastResolution = 4;
constexpr Index kMostResolution = 1000;

bool contains(const std::vector<std::string>& list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

cvt::TessellateOptions cvtOptions(const CompareOptions& options, Index sites, const std::string& method) {
  cvt::TessellateOptions result;
  result.sites = sites;
  result.iterations = method == kNotOptimized ? 0 : options.iterations;
  const CvtMethod kind = cvtMethod(method == kNotOptimized ? "cvt1" : method);
  result.cap = kind.cap;
  result.fit = kind.fit;
  result.seed = options.seed;
  return result;
}

// Sites by their number of iterations: one optimization serves all caps.
struct SharedSites {
  cvt::OptimizedSites<3> optimized;
  std::uint64_t peakMemoryBytes = 0;
  std::string failure;
};
using SitesByIterations = std::map<int, SharedSites>;

SharedSites& sitesFor(SitesByIterations& shared, Comparing& comparing, const cvt::TessellateOptions& options,
                      const RunContext& context) {
  const auto [place, isNew] = shared.try_emplace(options.iterations);
  SharedSites& sites = place->second;
  if (!isNew) return sites;
  comparing.memory.start();
  try {
    sites.optimized = cvt::optimizeSites(*comparing.form.function, options, context);
  } catch (const MethodError& error) {
    sites.failure = error.what();
  }
  sites.peakMemoryBytes = comparing.memory.peakBytes();
  return sites;
}

void makeCvt(Comparing& comparing, SitesByIterations& shared, Index siteCount, MethodOutcome& outcome,
             const RunContext& context) {
  const cvt::TessellateOptions options = cvtOptions(comparing.options, siteCount, outcome.method);
  const SharedSites& sites = sitesFor(shared, comparing, options, context);
  outcome.failure = sites.failure;
  if (!outcome.failure.empty()) return;
  comparing.memory.start();
  cvt::TessellateResult result =
      cvt::tessellateSites(sites.optimized, *comparing.form.function, comparing.form.record.frame, options, context);
  const std::uint64_t peakOfClipping = comparing.memory.peakBytes();
  if (peakOfClipping > 0) outcome.peakMemoryBytes = std::max(peakOfClipping, sites.peakMemoryBytes);
  outcome.seconds = result.summary.secondsInitial + result.summary.secondsOptimization + result.summary.secondsClipping;
  outcome.complex = std::move(result.complex);
  outcome.cvt = std::move(result.summary);
  if (outcome.complex.cellCount == 0) {
    outcome.failure = "the surface cuts no edge between the cells, so that no cell is left";
    return;
  }
  warnOfClipping(*outcome.cvt, context);
}

void evaluateDual(const Comparing& comparing, MethodOutcome& outcome, const RunContext& context) {
  const Stopwatch watch;
  try {
    metrics::DualOptions options;
    options.seed = comparing.options.seed;
    context.report("dual tetrahedra", 0);
    const metrics::DualResult dual =
        metrics::dualTetrahedra(outcome.complex, *comparing.form.function, options, context);
    outcome.dual = dual.summary;
    outcome.tetrahedra = metrics::tetrahedraQuality(dual.complex, context);
    outcome.dualTriangles = metrics::boundaryTriangleQuality(dual.complex);
    context.report("dual tetrahedra", 1);
  } catch (const MethodError& error) {
    context.warn(std::string("the dual tetrahedra could not be made: ") + error.what());
  }
  outcome.secondsEvaluation += watch.seconds();
}

void throwIfInvalid(const CompareOptions& options) {
  if (const auto violations = validate(options); !violations.empty()) throw UsageError(violations.front());
}

// Grid, number of sites and samples of the form.
Comparing prepare(const Form& form, Comparison& result, const RunContext& context) {
  Comparing comparing{form, result.options, {}, {}, 0, {}, 0};
  context.report("resolution", 0);
  const Box3 box = baselines::solidBox(*form.function, context);
  result.grid = baselines::gridOf(box, result.options.resolution);
  result.diagonal = box.diagonal().norm();
  result.sites = baselines::insideCubes(*form.function, result.grid, context);
  if (result.sites == 0) {
    throw MethodError("no cube's center lies inside the solid at resolution " +
                      std::to_string(result.options.resolution) + ": use a higher one");
  }
  cvt::requireMemory(cvtOptions(result.options, result.sites, "cvt1"));

  const Stopwatch watch;
  comparing.inside = insideSamples(form, result.options.seed, context);
  result.volume = comparing.inside.volume;
  result.cellSize = cellSize(result.volume, result.sites);
  comparing.cellSize = result.cellSize;
  comparing.surface = surfaceSamples(form, result.cellSize, result.options.seed, context);
  result.samples = static_cast<std::int64_t>(comparing.surface.points.size());
  result.sampleVariation = comparing.surface.variation;
  comparing.secondsEvaluation = watch.seconds();
  return comparing;
}

}  // namespace

std::vector<std::string> validate(const CompareOptions& options) {
  std::vector<std::string> violations;
  if (options.methods.empty()) violations.emplace_back("methods is empty, but must name at least one");
  for (const std::string& method : options.methods) {
    if (!contains(methodNames(), method)) violations.push_back("methods: unknown method " + method);
  }
  if (options.resolution < kLeastResolution || options.resolution > kMostResolution) {
    violations.push_back("resolution is " + std::to_string(options.resolution) + ", but must be from " +
                         std::to_string(kLeastResolution) + " to " + std::to_string(kMostResolution));
  }
  for (std::string& violation : cvt::validate(cvtOptions(options, 1, "cvt1"))) {
    violations.push_back(std::move(violation));
  }
  for (std::string& violation : baselines::validate(delaunayOptions(options, 1))) {
    violations.push_back(std::move(violation));
  }
  return violations;
}

RunContext named(const RunContext& context, const std::string& name) {
  RunContext result = context;
  result.progress = [context, name](std::string_view stage, double share) {
    context.report(name + ": " + std::string(stage), share);
  };
  result.log = [context, name](LogLevel level, std::string_view message) {
    if (context.log) context.log(level, name + ": " + std::string(message));
  };
  return result;
}

baselines::DelaunayOptions delaunayOptions(const CompareOptions& options, double cubeEdge) {
  baselines::DelaunayOptions result = options.delaunay;
  result.cubeEdge = cubeEdge;
  result.timeLimit = options.delaunayTimeLimit;
  result.seed = options.seed;
  return result;
}

void makeMarchingCubes(Comparing& comparing, const baselines::CubeGrid& grid, MethodOutcome& outcome,
                       const RunContext& context) {
  outcome.cubeEdge = grid.edge;
  context.report("cubes", 0);
  comparing.memory.start();
  const Stopwatch watch;
  try {
    baselines::MarchingCubesResult result =
        baselines::marchingCubes(*comparing.form.function, comparing.form.record.frame, grid, {}, context);
    outcome.complex = std::move(result.complex);
    outcome.marchingCubes = result.summary;
    if (outcome.complex.cellCount == 0) outcome.failure = "no cube's corner lies inside the solid";
  } catch (const MethodError& error) {
    outcome.failure = error.what();
  }
  outcome.seconds = watch.seconds();
  outcome.peakMemoryBytes = comparing.memory.peakBytes();
  outcome.boundaryTriangles = boundaryTriangles(outcome.complex);
  context.report("cubes", 1);
}

void makeDelaunay(Comparing& comparing, const baselines::DelaunayOptions& options, MethodOutcome& outcome,
                  const RunContext& context) {
  outcome.cubeEdge = options.cubeEdge;
  context.report("refinement", 0);
  comparing.memory.start();
  const Stopwatch watch;
  baselines::DelaunayResult result =
      baselines::delaunayRefinement(*comparing.form.function, comparing.form.record.frame, options, context);
  outcome.seconds = watch.seconds();
  outcome.peakMemoryBytes = comparing.memory.ownBytes(result.summary.peakMemoryBytes);
  outcome.complex = std::move(result.complex);
  outcome.delaunay = std::move(result.summary);
  if (outcome.delaunay->status != baselines::DelaunayStatus::done) outcome.failure = outcome.delaunay->message;
  outcome.boundaryTriangles = boundaryTriangles(outcome.complex);
  context.report("refinement", 1);
}

MethodOutcome fittedBaseline(Comparing& comparing, const baselines::CubeGrid& grid, const MethodOutcome& baseline,
                             const RunContext& context) {
  MethodOutcome outcome;
  outcome.method = baseline.method + "+fit";
  outcome.failure = baseline.failure;
  outcome.matched = baseline.matched;
  outcome.cubeEdge = baseline.cubeEdge;
  outcome.complex = baseline.complex;
  outcome.marchingCubes = baseline.marchingCubes;
  outcome.delaunay = baseline.delaunay;
  outcome.peakMemoryBytes = baseline.peakMemoryBytes;
  if (!outcome.failure.empty()) return outcome;
  const Stopwatch watch;
  const implicit::ImplicitFunction& f = *comparing.form.function;
  outcome.fit = baseline.marchingCubes ? baselines::fitMarchingCubes(outcome.complex, grid, f, {}, context)
                                       : baselines::fitTetrahedra(outcome.complex, f, {}, context);
  outcome.seconds = baseline.seconds + watch.seconds();
  return outcome;
}

void evaluateOutcome(Comparing& comparing, MethodOutcome& outcome, const RunContext& context) {
  if (!outcome.failure.empty()) return;
  const Stopwatch watch;
  const mesh::PolyhedralComplex& complex = outcome.complex;
  outcome.cells = complex.cellCount;
  outcome.vertices = static_cast<Index>(complex.vertices.size());
  outcome.faces = complex.faceCount();
  outcome.boundaryTriangles = boundaryTriangles(complex);
  outcome.measurement = measure(complex, comparing.form, comparing.inside, comparing.options.seed, context);
  outcome.triangles = metrics::boundaryTriangleQuality(complex);
  if (outcome.delaunay) outcome.tetrahedra = metrics::tetrahedraQuality(complex, context);
  context.report("accuracy", 0);
  metrics::AccuracyOptions accuracy;
  accuracy.cellSize = comparing.cellSize;
  accuracy.seed = comparing.options.seed;
  try {
    const bool keepsPairs = comparing.options.accuracySamples && outcome.matched.empty();
    outcome.accuracy = metrics::accuracy(complex, *comparing.form.function, comparing.surface, accuracy, context,
                                         keepsPairs ? &outcome.pairs : nullptr);
  } catch (const MethodError& error) {
    context.warn(std::string("the accuracy could not be measured: ") + error.what());
  }
  context.report("accuracy", 1);
  outcome.secondsEvaluation = watch.seconds();
}

Comparison compare(const Form& form, const CompareOptions& options, const RunContext& context) {
  throwIfInvalid(options);
  const Stopwatch watch;
  Comparison result;
  result.options = options;
  result.warnings = form.record.warnings;
  const RunContext recording = recordWarnings(context, result.warnings);
  Comparing comparing = prepare(form, result, recording);

  SitesByIterations sites;
  for (const std::string& method : methodNames()) {
    if (!contains(options.methods, method)) continue;
    const RunContext ofMethod = named(recording, method);
    MethodOutcome outcome;
    outcome.method = method;
    if (method == "mc") {
      makeMarchingCubes(comparing, result.grid, outcome, ofMethod);
    } else if (method == "delaunay") {
      makeDelaunay(comparing, delaunayOptions(options, result.grid.edge), outcome, ofMethod);
    } else {
      makeCvt(comparing, sites, result.sites, outcome, ofMethod);
    }
    evaluateOutcome(comparing, outcome, ofMethod);
    const bool wantsDual = options.dualTetrahedra && contains(options.methods, "delaunay");
    if (method == "cvt1" && wantsDual && outcome.failure.empty()) {
      evaluateDual(comparing, outcome, ofMethod);
    }
    if (!outcome.failure.empty()) ofMethod.warn(outcome.failure);
    comparing.secondsEvaluation += outcome.secondsEvaluation;
    result.methods.push_back(std::move(outcome));
    context.throwIfCancelled();
    if (options.fitBaselines && !isCvt(method)) {
      const RunContext ofFit = named(recording, method + "+fit");
      MethodOutcome fitted = fittedBaseline(comparing, result.grid, result.methods.back(), ofFit);
      evaluateOutcome(comparing, fitted, ofFit);
      comparing.secondsEvaluation += fitted.secondsEvaluation;
      result.methods.push_back(std::move(fitted));
    }
  }
  if (options.equalTriangles) result.equalTriangles = equalTriangles(comparing, result.grid, result.methods, recording);
  result.secondsEvaluation = comparing.secondsEvaluation;
  result.secondsTotal = watch.seconds();
  return result;
}

}  // namespace voroform::pipeline
