#include "voroform/pipeline/form.hpp"

#include <fstream>
#include <string_view>
#include <system_error>

#include "form_parts.hpp"
#include "records.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/form_file.hpp"
#include "voroform/implicit/mesh_distance.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/implicit/tetrahedral_form.hpp"
#include "voroform/pipeline/sha256.hpp"
#include "voroform/points/read.hpp"
#include "warnings.hpp"

namespace voroform::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kShapePrefix = "shape:";

Box3 grown(const Box3& box, double margin) {
  const Vec3 border = Vec3::Constant(margin * box.diagonal().norm());
  return {box.min() - border, box.max() + border};
}

// About the center of the finite positions' bounding box.
void rotate(points::PointCloud& cloud, const Mat3& rotation) {
  Box3 box;
  for (const Vec3& position : cloud.positions) {
    if (position.allFinite()) box.extend(position);
  }
  if (box.isEmpty()) return;
  const Vec3 center = 0.5 * box.min() + 0.5 * box.max();
  for (Vec3& position : cloud.positions) position = center + rotation * (position - center);
  for (Vec3& normal : cloud.normals) normal = rotation * normal;
}

bool isShape(const std::string& input) { return input.starts_with(kShapePrefix); }

// Options that only a cloud or a mesh knows.
void requireNoFormOptions(const std::string& input, const FormOptions& options, bool rotationAllowed) {
  const char* given = nullptr;
  if (options.implicitKind != ImplicitKind::automatic) given = "the kind of implicit form";
  if (options.inputKind != InputKind::automatic) given = "the kind of input";
  if (options.rotationSeed && !rotationAllowed) given = "a rotation";
  if (given != nullptr) throw UsageError(input + ": " + given + " cannot be chosen for it");
}

}  // namespace

void throwIfInvalid(const FormOptions& options) {
  const std::vector<std::string> problems = validate(options);
  if (!problems.empty()) throw UsageError(problems.front());
}

InputRecord fileRecord(const fs::path& path, const std::string& kind, const std::string& format) {
  InputRecord record;
  record.kind = kind;
  record.name = path.string();
  record.format = format;
  record.sha256 = sha256OfFile(path);
  std::error_code error;
  record.bytes = fs::file_size(path, error);
  if (error) throw InputError(path.string() + ": " + error.message());
  return record;
}

const char* toString(Envelope envelope) { return envelope == Envelope::box ? "box" : "none"; }

std::vector<std::string> validate(const FormOptions& options) {
  std::vector<std::string> problems;
  if (!(options.margin >= 0 && options.margin <= 1)) {
    problems.push_back("margin: " + std::to_string(options.margin) + " is not in [0, 1]");
  }
  if (!(options.samples >= kFewestSamples && options.samples <= kMostSamples)) {
    problems.push_back("samples: " + std::to_string(options.samples) + " is not in [" + std::to_string(kFewestSamples) +
                       ", " + std::to_string(kMostSamples) + "]");
  }
  for (const std::string& problem : points::validate(options.prepare)) problems.push_back(problem);
  for (const std::string& problem : implicit::validate(options.poisson)) problems.push_back(problem);
  return problems;
}

PreparedPoints loadPoints(const fs::path& path, const FormOptions& options, const RunContext& context) {
  throwIfInvalid(options);
  requireRegularFile(path);
  PreparedPoints result;
  const RunContext recording = recordWarnings(context, result.warnings);
  if (options.inputKind == InputKind::mesh) {
    throw UsageError(path.string() + ": expected a cloud; --as points takes the vertices of a mesh as one");
  }
  context.report("read points", 0);
  points::ReadResult read = points::readPoints(path, recording);
  if (read.summary.faces > 0 && options.inputKind == InputKind::automatic) {
    throw InputError(path.string() + ": the file holds " + std::to_string(read.summary.faces) +
                     " faces and so is a mesh; --as points takes its vertices as a cloud");
  }
  result.input = fileRecord(path, "points", read.summary.format);
  if (options.rotationSeed) {
    result.input.rotationSeed = options.rotationSeed;
    rotate(read.cloud, randomRotation(*options.rotationSeed));
  }
  result.prepared = points::prepare(std::move(read.cloud), path.string(), options.prepare, recording);
  context.report("read points", 1);
  return result;
}

void fitPoissonForm(Form& form, const FormOptions& options, const RunContext& context) {
  const Stopwatch watch;
  form.record.frame = form.cloud.frame;
  form.record.envelope = options.envelope;
  form.record.margin = options.margin;
  const Box3 region = grown(form.cloud.boundingBox(), options.margin);
  const implicit::PoissonResult poisson =
      implicit::fitPoisson(form.cloud, region, options.poisson, recordWarnings(context, form.record.warnings));
  form.record.poisson = poisson.summary;
  form.tetrahedral = poisson.form;
  form.function = poisson.form;
  if (options.envelope == Envelope::box) {
    form.record.envelopeBox = region;
    form.function = implicit::enveloped(poisson.form, region);
  }
  form.secondsImplicit = watch.seconds();
}

Form formFromPoints(const fs::path& path, const FormOptions& options, const RunContext& context) {
  if (options.implicitKind == ImplicitKind::distance) {
    throw UsageError(path.string() + ": the signed distance is defined for closed meshes; a cloud needs Poisson");
  }
  const Stopwatch pointsWatch;
  PreparedPoints loaded = loadPoints(path, options, context);
  Form form;
  form.secondsPoints = pointsWatch.seconds();

  form.cloud = std::move(loaded.prepared.cloud);
  form.record.input = std::move(loaded.input);
  form.record.warnings = std::move(loaded.warnings);
  form.record.points = loaded.prepared.summary;
  fitPoissonForm(form, options, context);
  return form;
}

namespace {

// The record beside a form's file.
FormRecord recordOf(const fs::path& path) {
  const fs::path recordPath = fs::path(path).replace_extension(".json");
  return formRecord(readJson(recordPath), recordPath.string());
}

void requireCompanion(const fs::path& path, const fs::path& companion, const char* what) {
  if (fs::exists(companion)) return;
  throw InputError(path.string() + ": " + companion.string() + " is missing; a form comes with " + what);
}

void requireOrigin(const fs::path& path, const FormRecord& record, const Frame& frame) {
  if (frame.origin == record.frame.origin) return;
  throw InputError(fs::path(path).replace_extension(".json").string() + ": the origin is not the one in " +
                   path.string() + "; the two files do not belong together");
}

// The mesh that form.ply holds: read as it was the first time, but what was warned of then stands in the record.
void loadStoredMesh(Form& form, const fs::path& path, const RunContext& context) {
  RunContext silent = context;
  silent.log = [log = context.log](LogLevel level, std::string_view message) {
    if (log && level != LogLevel::warning) log(level, message);
  };
  form.mesh = std::make_shared<mesh::TriangleMesh>(mesh::readSolidMesh(path, silent).mesh);
  requireOrigin(path, form.record, form.mesh->frame);
  form.function = implicit::meshDistance(form.mesh, silent);
}

void loadStoredPoisson(Form& form, const fs::path& path, const RunContext& context) {
  const fs::path recordPath = fs::path(path).replace_extension(".json");
  const fs::path pointsPath = path.parent_path() / kFormPointsFile;
  if (!form.record.points) throw InputError(recordPath.string() + ": the key \"points\" is missing");
  form.cloud = points::readPoints(pointsPath, context).cloud;
  if (form.cloud.positions.size() != form.record.points->points) {
    throw InputError(pointsPath.string() + ": expected the " + std::to_string(form.record.points->points) +
                     " points that " + recordPath.string() + " names, found " +
                     std::to_string(form.cloud.positions.size()));
  }
  // The shift loses nothing (see points::prepare), so these are the local coordinates that the form was made from.
  form.cloud.frame = form.record.frame;
  for (Vec3& position : form.cloud.positions) position -= form.record.frame.origin;
  const implicit::FormFile file = implicit::readForm(path, context);
  form.tetrahedral = file.form;
  requireOrigin(path, form.record, file.frame);
  form.function = form.tetrahedral;
  if (form.record.envelopeBox) form.function = implicit::enveloped(form.tetrahedral, *form.record.envelopeBox);
}

}  // namespace

Form formFromFile(const fs::path& path, const RunContext& context) {
  requireRegularFile(path);
  const Stopwatch watch;
  Form form;
  form.source = path;
  const bool isMesh = lowerCaseExtension(path) == ".ply";
  const char* const companions = isMesh ? "its record (.json)" : "its record (.json) and its cloud (points.ply)";
  requireCompanion(path, fs::path(path).replace_extension(".json"), companions);
  if (!isMesh) requireCompanion(path, path.parent_path() / kFormPointsFile, companions);
  form.record = recordOf(path);
  if (isMesh) {
    loadStoredMesh(form, path, context);
  } else {
    loadStoredPoisson(form, path, context);
  }
  for (const std::string& warning : form.record.warnings) context.warn(warning);
  form.secondsImplicit = watch.seconds();
  return form;
}

bool isStoredMeshForm(const fs::path& path) {
  if (lowerCaseExtension(path) != ".ply") return false;
  const fs::path recordPath = fs::path(path).replace_extension(".json");
  std::error_code error;
  if (!fs::is_regular_file(recordPath, error)) return false;
  // Some other file's .json may have the same name.
  std::ifstream stream(recordPath, std::ios::binary);
  const Json json = Json::parse(stream, nullptr, false);
  if (!json.is_object() || json.value("schema", Json()) != kFormSchema) return false;
  const FormRecord record = formRecord(json, recordPath.string());
  return record.mesh && record.mesh->kind == ImplicitKind::distance;
}

fs::path formFileOf(const fs::path& folder) {
  const fs::path mesh = folder / kFormMeshFile;
  return isStoredMeshForm(mesh) ? mesh : folder / kFormFile;
}

Form formFromShape(const std::string& name, std::optional<std::uint64_t> rotationSeed) {
  Form form;
  form.function = implicit::namedShape(name);
  if (rotationSeed) {
    form.function = implicit::transformed(form.function, randomRotation(*rotationSeed), Vec3::Zero());
  }
  form.record.input.kind = "shape";
  form.record.input.name = name;
  form.record.input.rotationSeed = rotationSeed;
  return form;
}

Form formFromInput(const std::string& input, const FormOptions& options, const RunContext& context) {
  throwIfInvalid(options);
  if (isShape(input)) {
    requireNoFormOptions(input, options, true);
    return formFromShape(input.substr(kShapePrefix.size()), options.rotationSeed);
  }
  if (lowerCaseExtension(input) == ".vtu" || isStoredMeshForm(input)) {
    requireNoFormOptions(input, options, false);
    return formFromFile(input, context);
  }
  if (options.inputKind == InputKind::mesh) return formFromMesh(input, options, context);
  if (options.inputKind == InputKind::points) return formFromPoints(input, options, context);
  requireRegularFile(input);
  return mesh::holdsFaces(input, context) ? formFromMesh(input, options, context)
                                          : formFromPoints(input, options, context);
}

void writeForm(const Form& form, ArtifactStore& store) {
  if (!form.tetrahedral && !form.mesh) return;
  const bool isMesh = form.mesh != nullptr;
  if (form.source.empty()) {
    if (isMesh) {
      store.put(kFormMeshFile, [&](const fs::path& path) { mesh::writeMeshPly(path, *form.mesh); });
    } else {
      store.put(kFormFile,
                [&](const fs::path& path) { implicit::writeForm(path, *form.tetrahedral, form.record.frame); });
      store.put(kFormPointsFile, [&](const fs::path& path) { points::writePointsPly(path, form.cloud); });
    }
    store.put(kFormRecordFile, [&](const fs::path& path) { writeJson(path, formJson(form.record)); });
    return;
  }
  // The very bytes that the form was read from.
  const auto copy = [&store](const fs::path& from, const char* name) {
    store.put(name, [&from](const fs::path& to) {
      std::error_code error;
      fs::copy_file(from, to, error);
      if (error) throw EnvironmentError(to.string() + ": cannot copy " + from.string() + ": " + error.message());
    });
  };
  copy(form.source, isMesh ? kFormMeshFile : kFormFile);
  if (!isMesh) copy(form.source.parent_path() / kFormPointsFile, kFormPointsFile);
  copy(fs::path(form.source).replace_extension(".json"), kFormRecordFile);
}

}  // namespace voroform::pipeline
