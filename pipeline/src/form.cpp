#include "voroform/pipeline/form.hpp"

#include <algorithm>
#include <cctype>
#include <string_view>
#include <system_error>

#include "records.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/implicit/form_file.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/implicit/tetrahedral_form.hpp"
#include "voroform/pipeline/sha256.hpp"
#include "voroform/points/read.hpp"
#include "warnings.hpp"

namespace voroform::pipeline {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kShapePrefix = "shape:";

std::string lowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

Box3 grown(const Box3& box, double margin) {
  const Vec3 border = Vec3::Constant(margin * box.diagonal().norm());
  return {box.min() - border, box.max() + border};
}

void throwIfInvalid(const FormOptions& options) {
  const std::vector<std::string> problems = validate(options);
  if (!problems.empty()) throw UsageError(problems.front());
}

}  // namespace

const char* toString(Envelope envelope) { return envelope == Envelope::box ? "box" : "none"; }

std::vector<std::string> validate(const FormOptions& options) {
  std::vector<std::string> problems;
  if (!(options.margin >= 0 && options.margin <= 1)) {
    problems.push_back("margin: " + std::to_string(options.margin) + " is not in [0, 1]");
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
    throw InputError(path.string() +
                     ": meshes cannot be tessellated yet; --as points takes the vertices of a mesh as a cloud");
  }
  context.report("read points", 0);
  points::ReadResult read = points::readPoints(path, recording);
  if (read.summary.faces > 0 && options.inputKind == InputKind::automatic) {
    throw InputError(path.string() + ": the file holds " + std::to_string(read.summary.faces) +
                     " faces and so is a mesh, which cannot be tessellated yet; --as points takes its vertices as a "
                     "cloud");
  }
  result.input.kind = "points";
  result.input.name = path.string();
  result.input.format = read.summary.format;
  result.input.sha256 = sha256OfFile(path);
  std::error_code error;
  result.input.bytes = fs::file_size(path, error);
  if (error) throw InputError(path.string() + ": " + error.message());
  result.prepared = points::prepare(std::move(read.cloud), path.string(), options.prepare, recording);
  context.report("read points", 1);
  return result;
}

Form formFromPoints(const fs::path& path, const FormOptions& options, const RunContext& context) {
  const Stopwatch pointsWatch;
  PreparedPoints loaded = loadPoints(path, options, context);
  Form form;
  form.secondsPoints = pointsWatch.seconds();

  const Stopwatch implicitWatch;
  form.cloud = std::move(loaded.prepared.cloud);
  form.record.input = std::move(loaded.input);
  form.record.warnings = std::move(loaded.warnings);
  form.record.points = loaded.prepared.summary;
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
  form.secondsImplicit = implicitWatch.seconds();
  return form;
}

Form formFromFile(const fs::path& path, const RunContext& context) {
  requireRegularFile(path);
  const Stopwatch watch;
  Form form;
  form.source = path;
  const fs::path recordPath = fs::path(path).replace_extension(".json");
  const fs::path pointsPath = path.parent_path() / kFormPointsFile;
  for (const fs::path& companion : {recordPath, pointsPath}) {
    if (!fs::exists(companion)) {
      throw InputError(path.string() + ": " + companion.string() +
                       " is missing; a form comes with its record (.json) and its cloud (points.ply)");
    }
  }
  form.record = formRecord(readJson(recordPath), recordPath.string());
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
  if (file.frame.origin != form.record.frame.origin) {
    throw InputError(recordPath.string() + ": the origin is not the one in " + path.string() +
                     "; the two files do not belong together");
  }
  form.function = form.tetrahedral;
  if (form.record.envelopeBox) form.function = implicit::enveloped(form.tetrahedral, *form.record.envelopeBox);
  for (const std::string& warning : form.record.warnings) context.warn(warning);
  form.secondsImplicit = watch.seconds();
  return form;
}

Form formFromShape(const std::string& name) {
  Form form;
  form.function = implicit::namedShape(name);
  form.record.input.kind = "shape";
  form.record.input.name = name;
  return form;
}

Form formFromInput(const std::string& input, const FormOptions& options, const RunContext& context) {
  if (input.starts_with(kShapePrefix)) return formFromShape(input.substr(kShapePrefix.size()));
  if (lowerExtension(input) == ".vtu") return formFromFile(input, context);
  return formFromPoints(input, options, context);
}

void writeForm(const Form& form, ArtifactStore& store) {
  if (!form.tetrahedral) return;
  if (form.source.empty()) {
    store.put(kFormFile,
              [&](const fs::path& path) { implicit::writeForm(path, *form.tetrahedral, form.record.frame); });
    store.put(kFormPointsFile, [&](const fs::path& path) { points::writePointsPly(path, form.cloud); });
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
  copy(form.source, kFormFile);
  copy(form.source.parent_path() / kFormPointsFile, kFormPointsFile);
  copy(fs::path(form.source).replace_extension(".json"), kFormRecordFile);
}

}  // namespace voroform::pipeline
