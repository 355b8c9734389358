// A form's tessellation, measured and written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"
#include "voroform/mesh/validate.hpp"
#include "voroform/metrics/accuracy.hpp"
#include "voroform/metrics/fidelity.hpp"
#include "voroform/metrics/regularity.hpp"
#include "voroform/pipeline/artifact_store.hpp"
#include "voroform/pipeline/form.hpp"
#include "voroform/pipeline/site_options.hpp"

namespace voroform::pipeline {

// Files beside the ones that are always written.
enum class ExtraFormat { obj, off, stl, adjacency };
const char* toString(ExtraFormat format);
// A CVT's method by its name: cvt1, cvt2, cvt3, cvt4 (cvt3 fitted), cvt1+fit, cvt2+fit.
struct CvtMethod {
  voronoi::CapKind cap = voronoi::CapKind::cvt3;
  bool fit = false;
};
std::string toString(const CvtMethod& method);
// Throws UsageError for an unknown name.
CvtMethod cvtMethod(const std::string& name);
const char* toString(implicit::RootFinder finder);

// All that is measured on a tessellation against its form but its accuracy.
struct Measurement {
  std::vector<mesh::CellMoments> moments;  // one a cell
  std::vector<double> regularities;        // one a cell
  std::vector<double> boundaryFlags;       // one a cell: 1 if it has a boundary face, else 0
  mesh::Certificate certificate;
  metrics::Fidelity fidelity;
  metrics::Regularity regularity;
  double seconds = 0;
};
Measurement measure(const mesh::PolyhedralComplex& complex, const Form& form, std::uint64_t seed,
                    const RunContext& context);

// h = (V/n)^(1/3), the size of one of n cells in a volume V.
double cellSize(double volume, Index cells);

// The accuracy of a tessellation, measured with samples a third of the cell size apart: of the form's volume, as it was
// sampled, and the number of cells. Empty, with a warning, if there is nothing to measure: no cell, no volume, or all
// of the boundary lies on the envelope.
std::optional<metrics::Accuracy> measureAccuracy(const mesh::PolyhedralComplex& complex, const Form& form,
                                                 const Measurement& measurement, std::uint64_t seed,
                                                 const RunContext& context);

struct Tessellation {
  mesh::PolyhedralComplex complex;
  cvt::TessellateSummary summary;
  Measurement measurement;
  std::optional<metrics::Accuracy> accuracy;
  std::vector<std::string> warnings;  // of the form, the tessellation and the measurement
  double seconds = 0;                 // of the tessellation alone
  double secondsMetrics = 0;
};

// Tessellates and measures, the accuracy if asked for. Warns of what was lost. Throws as cvt::tessellate does, and
// MethodError if no cell is left.
Tessellation tessellate(const Form& form, const cvt::TessellateOptions& options, const RunContext& context,
                        bool withAccuracy = true);

struct WriteOptions {
  std::set<ExtraFormat> formats;
  cvt::TessellateOptions tessellate;  // as given to tessellate(), for the record
  int threads = 0;                    // as given, for the record
};

// Writes the form's files, cells.vtu, surface.ply, sites.ply, the extra formats and at last metrics.json to the folder:
// all of them or none. Returns the names of the files written.
std::vector<std::string> writeResults(const Form& form, const Tessellation& tessellation, const WriteOptions& options,
                                      const std::filesystem::path& folder, const RunContext& context);

struct Evaluation {
  mesh::PolyhedralComplex complex;
  Measurement measurement;
  std::optional<metrics::Accuracy> accuracy;
  bool hasCloud = false;  // the form was made from points
  std::vector<std::string> warnings;
};

// Reads cells.vtu of a results folder, measures it against the form beside it (or the shape that metrics.json names),
// and writes metrics.json anew: what only the making run knew is kept. Throws InputError, EnvironmentError.
Evaluation evaluate(const std::filesystem::path& folder, const RunContext& context);

}  // namespace voroform::pipeline
