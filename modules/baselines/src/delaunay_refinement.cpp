#include "voroform/baselines/delaunay_refinement.hpp"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "child_process.hpp"
#include "mesh_solid.hpp"
#include "tetrahedra.hpp"
#include "voroform/core/error.hpp"

namespace voroform::baselines {

namespace {

constexpr double kMostFacetAngle = 30;
constexpr double kLeastRadiusEdgeRatio = 2;

std::string shortNumber(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", number);
  return text;
}

// A library's message of several lines, without the one that names a file of its own.
std::string inOneLine(const std::string& message) {
  std::string result;
  std::istringstream stream(message);
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line.starts_with("File")) continue;
    result += (result.empty() ? "" : "; ") + line;
  }
  return result;
}

}  // namespace

std::vector<std::string> validate(const DelaunayOptions& options) {
  std::vector<std::string> violations;
  const auto require = [&](bool holds, const char* field, double number, const char* rule) {
    if (!holds) violations.push_back(std::string(field) + " is " + shortNumber(number) + ", but must be " + rule);
  };
  const auto finite = [](double number) { return std::isfinite(number); };
  require(finite(options.cubeEdge) && options.cubeEdge > 0, "cubeEdge", options.cubeEdge, "positive");
  require(options.facetAngle >= 0 && options.facetAngle <= kMostFacetAngle, "facetAngle", options.facetAngle,
          "from 0 to 30 degrees");
  require(finite(options.radiusEdgeRatio) && options.radiusEdgeRatio >= kLeastRadiusEdgeRatio, "radiusEdgeRatio",
          options.radiusEdgeRatio, "at least 2");
  require(finite(options.facetDistance) && options.facetDistance >= 0, "facetDistance", options.facetDistance,
          "at least 0");
  require(options.lloydIterations >= 0, "lloydIterations", options.lloydIterations, "at least 0");
  require(options.odtIterations >= 0, "odtIterations", options.odtIterations, "at least 0");
  require(finite(options.timeLimit) && options.timeLimit >= 0, "timeLimit", options.timeLimit, "at least 0 and finite");
  return violations;
}

DelaunayResult delaunayRefinement(const implicit::ImplicitFunction& f, const Frame& frame,
                                  const DelaunayOptions& options, const RunContext& context) {
  const std::vector<std::string> violations = validate(options);
  if (!violations.empty()) throw UsageError("Delaunay refinement: " + violations.front());

  const Stopwatch watch;
  DelaunayResult result;
  DelaunaySummary& summary = result.summary;
  context.report("Delaunay refinement", 0);
  const ChildReport report = runInChild([&] { return pack(meshSolid(f, options)); }, options.timeLimit, context);
  summary.peakMemoryBytes = report.peakMemoryBytes;
  switch (report.end) {
    case ChildEnd::answered:
      try {
        const Tetrahedra tetrahedra = unpack(report.answer);
        summary.secondsRefinement = tetrahedra.secondsRefinement;
        summary.secondsOptimization = tetrahedra.secondsOptimization;
        result.complex = toComplex(tetrahedra, f, frame, context);
      } catch (const Cancelled&) {
        throw;
      } catch (const Error& error) {
        summary.status = DelaunayStatus::failed;
        summary.message = std::string("the child process's answer is damaged: ") + error.what();
      }
      break;
    case ChildEnd::timedOut:
      summary.status = DelaunayStatus::timedOut;
      summary.message = "did not finish in " + shortNumber(options.timeLimit) + " s";
      break;
    case ChildEnd::failed:
      summary.status = DelaunayStatus::failed;
      summary.message = inOneLine(report.message);
      break;
  }
  summary.seconds = watch.seconds();
  context.report("Delaunay refinement", 1);
  return result;
}

}  // namespace voroform::baselines
