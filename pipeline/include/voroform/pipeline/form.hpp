// Where a tessellation's form comes from: a point cloud, a triangle mesh, a form on disk, or a named shape.
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
#include "voroform/mesh/read_mesh.hpp"
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

// What function stands for the input.
enum class ImplicitKind {
  automatic,  // poisson for clouds, distance for meshes
  poisson,    // of a mesh: fitted to samples on it (thesis, figure 5.7)
  distance,   // signed distance; of meshes only
};

struct FormOptions {
  InputKind inputKind = InputKind::automatic;
  ImplicitKind implicitKind = ImplicitKind::automatic;
  // Points on a mesh that its Poisson form is fitted to, uniform by area; in [100, 100,000,000].
  Index samples = 100000;
  std::uint64_t seed = 0;  // of the samples
  // Turns the input by randomRotation() of this seed: a shape about the origin, a cloud or mesh about the center of its
  // bounding box.
  std::optional<std::uint64_t> rotationSeed;
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
  std::string kind;    // "points", "mesh" or "shape"
  std::string name;    // the path as it was given, or the shape's name
  std::string format;  // of a file, e.g. "PLY ascii"
  std::string sha256;  // of a file
  std::uint64_t bytes = 0;
  std::optional<std::uint64_t> rotationSeed;  // the input was turned
};

// What a mesh was made a form of.
struct MeshRecord {
  mesh::MeshReadSummary summary;
  ImplicitKind kind = ImplicitKind::distance;
  Index samples = 0;  // of the Poisson form
  std::uint64_t seed = 0;
};

// Everything that a form's maker knew; stands in form.json, so that a later run knows it as well.
struct FormRecord {
  InputRecord input;
  Envelope envelope = Envelope::none;
  double margin = 0;
  std::optional<Box3> envelopeBox;  // local coordinates
  Frame frame;
  std::optional<points::PrepareSummary> points;  // of a mesh: its samples
  std::optional<MeshRecord> mesh;
  std::optional<implicit::PoissonSummary> poisson;
  std::vector<std::string> warnings;
};

struct Form {
  implicit::ImplicitPtr function;                                // the envelope included
  std::shared_ptr<const implicit::TetrahedralForm> tetrahedral;  // what form.vtu holds; else null
  std::shared_ptr<const mesh::TriangleMesh> mesh;                // what form.ply holds; else null
  points::PointCloud cloud;                                      // that a Poisson form was fitted to
  FormRecord record;
  // The form.vtu or form.ply that it was read from; empty if it was made in this run.
  std::filesystem::path source;
  double secondsPoints = 0;
  double secondsImplicit = 0;
};

// Names of the files that hold a form.
inline constexpr const char* kFormFile = "form.vtu";
inline constexpr const char* kFormMeshFile = "form.ply";
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
// The signed distance to a closed mesh, or the Poisson form of samples on it. Throws UsageError, InputError,
// MethodError.
Form formFromMesh(const std::filesystem::path& path, const FormOptions& options, const RunContext& context);
// A form that writeForm() wrote, form.vtu or form.ply; its record is read from the .json of the same name and the cloud
// of form.vtu from points.ply, both beside it. The same form, bit for bit. Throws InputError.
Form formFromFile(const std::filesystem::path& path, const RunContext& context);
// The one of form.vtu and form.ply that the form.json of a results folder belongs to. Throws InputError.
std::filesystem::path formFileOf(const std::filesystem::path& folder);
// Whether the path is a mesh that writeForm() wrote: a .ply with its record beside it.
bool isStoredMeshForm(const std::filesystem::path& path);
// A shape of implicit::shapeNames(), turned if a seed is given. Throws UsageError.
Form formFromShape(const std::string& name, std::optional<std::uint64_t> rotationSeed = std::nullopt);
// By the input's name: shape:NAME, a form (.vtu, or .ply with its record), a mesh, or a cloud. Options that have no
// meaning for it are a UsageError.
Form formFromInput(const std::string& input, const FormOptions& options, const RunContext& context);

// Writes form.vtu and points.ply, or form.ply; and form.json. Nothing for a shape.
void writeForm(const Form& form, ArtifactStore& store);

}  // namespace voroform::pipeline
