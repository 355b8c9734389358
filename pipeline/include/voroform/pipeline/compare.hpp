// All methods on one form at equal resolution, measured alike (thesis 5.3, tables 5.1-5.4).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "voroform/baselines/delaunay_refinement.hpp"
#include "voroform/baselines/fit_boundary.hpp"
#include "voroform/baselines/marching_cubes.hpp"
#include "voroform/core/run_context.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"
#include "voroform/metrics/accuracy.hpp"
#include "voroform/metrics/dual_tetrahedra.hpp"
#include "voroform/metrics/shape_quality.hpp"
#include "voroform/pipeline/form.hpp"
#include "voroform/pipeline/tessellation.hpp"

namespace voroform::pipeline {

// Names of methods, in the order of the tables: mc, delaunay, cvt1@0, cvt1, cvt1+fit, cvt2, cvt2+fit, cvt3, cvt4.
const std::vector<std::string>& methodNames();
// Those that run if none are named: all but cvt1+fit and cvt2+fit.
const std::vector<std::string>& defaultMethods();

struct CompareOptions {
  std::vector<std::string> methods = defaultMethods();
  // Cubes along the longest edge of the solid's bounding box, in [4, 1000].
  Index resolution = 50;
  // Of the CVT's optimization; "cvt1@0" takes none.
  int iterations = 10;
  // Lloyd steps of Delaunay refinement, and its other choices; cubeEdge, seed and timeLimit are set from here.
  baselines::DelaunayOptions delaunay;
  double delaunayTimeLimit = 0;  // seconds; 0: none
  // Keep the samples with their nearest points, for writeComparison to write; not those at equal triangles.
  bool accuracySamples = false;
  // Also fit the boundaries of Marching Cubes and Delaunay refinement to the surface, as cvt4's is: mc+fit and
  // delaunay+fit, after each of theirs.
  bool fitBaselines = false;
  // Also run Marching Cubes and Delaunay refinement finer, until they have as many boundary triangles as each CVT.
  bool equalTriangles = true;
  // Measure the dual tetrahedra of cvt1 against those of Delaunay refinement, if that is among the methods.
  bool dualTetrahedra = true;
  std::uint64_t seed = 0;
  int threads = 0;
};
std::vector<std::string> validate(const CompareOptions& options);

struct MethodOutcome {
  std::string method;  // of methodNames(), or mc+fit or delaunay+fit
  // Empty if the method finished; else why it has no result, e.g. "did not finish in 60 s".
  std::string failure;
  // For the equal-triangles table: the CVT method whose triangle count was aimed at, and the cube edge that gave it.
  std::string matched;
  double cubeEdge = 0;
  // Empty in the equal-triangles table, where what is counted of it remains, and the measurement's values of each cell.
  mesh::PolyhedralComplex complex;
  Measurement measurement;
  std::optional<metrics::Accuracy> accuracy;
  metrics::AccuracyPairs pairs;  // with accuracySamples
  Index cells = 0;
  Index vertices = 0;
  Index faces = 0;
  std::int64_t boundaryTriangles = 0;
  std::optional<metrics::QualityStatistics> tetrahedra;     // delaunay, and the dual of cvt1
  std::optional<metrics::QualityStatistics> triangles;      // of the boundary, polygons cut into fans
  std::optional<metrics::QualityStatistics> dualTriangles;  // of the boundary of cvt1's dual
  std::optional<metrics::DualSummary> dual;
  std::optional<cvt::TessellateSummary> cvt;
  std::optional<baselines::MarchingCubesSummary> marchingCubes;
  std::optional<baselines::DelaunaySummary> delaunay;
  std::optional<baselines::BoundaryFit> fit;  // of mc+fit and delaunay+fit
  double seconds = 0;                         // of making the tessellation
  std::uint64_t peakMemoryBytes = 0;          // resident while it was made, the form included; 0: could not be measured
  double secondsEvaluation = 0;
};

struct Comparison {
  CompareOptions options;
  baselines::CubeGrid grid;
  Index sites = 0;             // n, the cubes whose center is inside
  double volume = 0;           // V, of {f < 0}, sampled
  double cellSize = 0;         // h = (V/n)^(1/3)
  double diagonal = 0;         // of the solid's bounding box
  double sampleVariation = 0;  // of the samples on S
  std::int64_t samples = 0;
  std::vector<MethodOutcome> methods;         // at the thesis's rule, in the order of methodNames()
  std::vector<MethodOutcome> equalTriangles;  // mc and delaunay at the triangle counts of the CVTs
  std::vector<std::string> warnings;
  double secondsEvaluation = 0;  // of all tessellations, with the samples of the form
  double secondsTotal = 0;       // without the form and the files
};

// A boundary has as many triangles as another if the numbers differ by at most this share of the latter.
inline constexpr double kEqualTriangles = 0.02;

// A method that fails is a result; the others go on. The same bits for any number of threads but for seconds and
// memory. Throws UsageError on bad options, MethodError if f has no inside or no surface to compare at this resolution,
// EnvironmentError if the memory does not suffice, Cancelled.
Comparison compare(const Form& form, const CompareOptions& options, const RunContext& context);

inline constexpr const char* kComparisonFile = "comparison.json";

// The tables of thesis 5.1-5.4 as Markdown, and as comma-separated values: a row a method, all digits.
std::string comparisonMarkdown(const Form& form, const Comparison& comparison);
std::string comparisonCsv(const std::vector<MethodOutcome>& outcomes);

// Writes comparison.json, .csv and .md, comparison-equal-triangles.csv, the form's files, and a folder of each method's
// cells.vtu, surface.ply and, if they were kept, accuracy-samples.csv: all of them or none. Returns the names of the
// files written.
std::vector<std::string> writeComparison(const Form& form, const Comparison& comparison,
                                         const std::filesystem::path& folder, const RunContext& context);

}  // namespace voroform::pipeline
