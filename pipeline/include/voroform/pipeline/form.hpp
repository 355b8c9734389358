// Where a tessellation's form comes from: a point cloud, a form on disk, or a named shape.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/implicit/poisson.hpp"
#include "voroform/pipeline/artifact_store.hpp"
#include "voroform/points/point_cloud.hpp"
#include "voroform/points/prepare.hpp"

namespace voroform::pipeline {

// What closes an open scan.
enum class Envelope {
  box,   // the cloud's bounding box, grown by a margin
  none,  // the form is taken as it is; a shape has no envelope
};
const char* toString(Envelope envelope);

// How an input file's kind is decided.
enum class InputKind {
  automatic,  // a file with faces is a mesh, without faces a cloud
  points,     // a mesh's vertices are taken as a cloud
  mesh,
};

struct FormOptions {
  InputKind inputKind = InputKind::automatic;
  Envelope envelope = Envelope::box;
  // How far the envelope reaches beyond the cloud's bounding box, as a share of its diagonal; in [0, 1].
  double margin = 0.02;
  points::PrepareOptions prepare;
  implicit::PoissonOptions poisson;
};
// Every violation of the options, as sentences naming field, value and rule; empty if there is none.
std::vector<std::string> validate(const FormOptions& options);

// What was read.
struct InputRecord {
  std::string kind;    // "points" or "shape"
  std::string name;    // the path as it was given, or the shape's name
  std::string format;  // of a file, e.g. "PLY ascii"
  std::string sha256;  // of a file
  std::uint64_t bytes = 0;
};

// Everything that a form's maker knew; stands in form.json, so that a later run knows it as well.
struct FormRecord {
  InputRecord input;
  Envelope envelope = Envelope::none;
  double margin = 0;
  std::optional<Box3> envelopeBox;  // local coordinates
  Frame frame;
  std::optional<points::PrepareSummary> points;
  std::optional<implicit::PoissonSummary> poisson;
  std::vector<std::string> warnings;
};

struct Form {
  implicit::ImplicitPtr function;                                // the envelope included
  std::shared_ptr<const implicit::TetrahedralForm> tetrahedral;  // what form.vtu holds; null for a shape
  points::PointCloud cloud;                                      // prepared; empty for a shape
  FormRecord record;
  // The form.vtu that it was read from; empty if it was made in this run.
  std::filesystem::path source;
  double secondsPoints = 0;
  double secondsImplicit = 0;
};

// Names of the files that hold a form.
inline constexpr const char* kFormFile = "form.vtu";
inline constexpr const char* kFormRecordFile = "form.json";
inline constexpr const char* kFormPointsFile = "points.ply";

// A cloud, cleaned, oriented and described.
struct PreparedPoints {
  points::PrepareResult prepared;
  InputRecord input;
  std::vector<std::string> warnings;
};
// Throws InputError.
PreparedPoints loadPoints(const std::filesystem::path& path, const FormOptions& options, const RunContext& context);

// The Poisson form of a cloud. Throws UsageError, InputError, MethodError.
Form formFromPoints(const std::filesystem::path& path, const FormOptions& options, const RunContext& context);
// A form that writeForm() wrote; its record is read from the .json of the same name and its cloud from points.ply, both
// beside it. The same form, bit for bit. Throws InputError.
Form formFromFile(const std::filesystem::path& path, const RunContext& context);
// A shape of implicit::shapeNames(). Throws UsageError.
Form formFromShape(const std::string& name);
// By the input's name: shape:NAME, a form (.vtu), or a cloud.
Form formFromInput(const std::string& input, const FormOptions& options, const RunContext& context);

// Writes form.vtu, points.ply and form.json; nothing for a shape.
void writeForm(const Form& form, ArtifactStore& store);

}  // namespace voroform::pipeline
