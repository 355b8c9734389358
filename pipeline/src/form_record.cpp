#include "records.hpp"

#include <fstream>

#include "voroform/core/error.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/core/output_file.hpp"

namespace voroform::pipeline {

namespace {

constexpr const char* kDistanceKind = "distance";

Json vectorJson(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json prepareJson(const points::PrepareSummary& summary) {
  return {{"records", summary.records},
          {"non_finite", summary.nonFinite},
          {"zero_normals", summary.zeroNormals},
          {"duplicates", summary.duplicates},
          {"unoriented", summary.unoriented},
          {"normals_estimated", summary.normalsEstimated},
          {"points", summary.points},
          {"spacing", summary.spacing}};
}

Json poissonJson(const implicit::PoissonSummary& summary) {
  return {{"kind", "poisson"},
          {"vertices", summary.vertices},
          {"tetrahedra", summary.tetrahedra},
          {"sign_turned", summary.signTurned},
          {"wrong_normal_share", summary.wrongNormalShare}};
}

Json meshJson(const MeshRecord& record) {
  Json json = {{"vertices", record.summary.vertices},
               {"faces", record.summary.faces},
               {"welded", record.summary.welded},
               {"degenerate", record.summary.degenerate},
               {"unused_vertices", record.summary.unusedVertices},
               {"turned_faces", record.summary.turnedFaces},
               {"turned", record.summary.turned},
               {"components", record.summary.components}};
  if (record.kind == ImplicitKind::poisson) {
    json["samples"] = record.samples;
    json["seed"] = record.seed;
  }
  return json;
}

// Access to a JSON object that names the file and the key in its messages.
class Reader {
 public:
  Reader(const Json& json, std::string name) : json_(json), name_(std::move(name)) {
    if (!json_.is_object()) throw InputError(name_ + ": expected an object, found " + std::string(json_.type_name()));
  }

  bool has(const char* key) const { return json_.contains(key) && !json_.at(key).is_null(); }

  Reader object(const char* key) const { return {at(key), name_ + ", " + key}; }

  template <class T>
  T get(const char* key) const {
    return valueAs<T>(at(key), key, name_);
  }

  Vec3 vector(const char* key) const {
    const auto values = get<std::vector<double>>(key);
    if (values.size() != 3) throw InputError(name_ + ": the key \"" + key + "\" needs three numbers");
    return {values[0], values[1], values[2]};
  }

 private:
  const Json& at(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) throw InputError(name_ + ": the key \"" + key + "\" is missing");
    return *found;
  }

  const Json& json_;
  std::string name_;
};

InputRecord inputRecord(const Reader& reader) {
  InputRecord input;
  input.kind = reader.get<std::string>("kind");
  input.name = reader.get<std::string>("name");
  if (reader.has("format")) input.format = reader.get<std::string>("format");
  if (reader.has("sha256")) input.sha256 = reader.get<std::string>("sha256");
  if (reader.has("bytes")) input.bytes = reader.get<std::uint64_t>("bytes");
  if (reader.has("rotation_seed")) input.rotationSeed = reader.get<std::uint64_t>("rotation_seed");
  return input;
}

MeshRecord meshRecord(const Reader& reader, bool isDistance) {
  MeshRecord record;
  record.summary.vertices = reader.get<std::uint64_t>("vertices");
  record.summary.faces = reader.get<std::uint64_t>("faces");
  record.summary.welded = reader.get<std::uint64_t>("welded");
  record.summary.degenerate = reader.get<std::uint64_t>("degenerate");
  record.summary.unusedVertices = reader.get<std::uint64_t>("unused_vertices");
  record.summary.turnedFaces = reader.get<std::uint64_t>("turned_faces");
  record.summary.turned = reader.get<bool>("turned");
  record.summary.components = reader.get<Index>("components");
  record.kind = isDistance ? ImplicitKind::distance : ImplicitKind::poisson;
  if (!isDistance) {
    record.samples = reader.get<Index>("samples");
    record.seed = reader.get<std::uint64_t>("seed");
  }
  return record;
}

points::PrepareSummary prepareSummary(const Reader& reader) {
  points::PrepareSummary summary;
  summary.records = reader.get<std::uint64_t>("records");
  summary.nonFinite = reader.get<std::uint64_t>("non_finite");
  summary.zeroNormals = reader.get<std::uint64_t>("zero_normals");
  summary.duplicates = reader.get<std::uint64_t>("duplicates");
  summary.unoriented = reader.get<std::uint64_t>("unoriented");
  summary.normalsEstimated = reader.get<bool>("normals_estimated");
  summary.points = reader.get<std::uint64_t>("points");
  summary.spacing = reader.get<double>("spacing");
  return summary;
}

implicit::PoissonSummary poissonSummary(const Reader& reader) {
  implicit::PoissonSummary summary;
  summary.vertices = reader.get<Index>("vertices");
  summary.tetrahedra = reader.get<Index>("tetrahedra");
  summary.signTurned = reader.get<bool>("sign_turned");
  summary.wrongNormalShare = reader.get<double>("wrong_normal_share");
  return summary;
}

}  // namespace

Json versionsJson() {
  return {{"voroform", VOROFORM_VERSION},
          {"cgal", VOROFORM_CGAL_VERSION},
          {"eigen", VOROFORM_EIGEN_VERSION},
          {"ceres", VOROFORM_CERES_VERSION}};
}

Json inputJson(const InputRecord& input) {
  Json json = {{"kind", input.kind}, {"name", input.name}};
  if (!input.format.empty()) json["format"] = input.format;
  if (!input.sha256.empty()) {
    json["bytes"] = input.bytes;
    json["sha256"] = input.sha256;
  }
  if (input.rotationSeed) json["rotation_seed"] = *input.rotationSeed;
  return json;
}

std::optional<std::uint64_t> rotationSeed(const Json& input, const std::string& name) {
  const Reader reader(input, name);
  if (!reader.has("rotation_seed")) return std::nullopt;
  return reader.get<std::uint64_t>("rotation_seed");
}

Json formJson(const FormRecord& record) {
  Json json = {{"schema", kFormSchema},
               {"input", inputJson(record.input)},
               {"options", {{"envelope", toString(record.envelope)}, {"margin", record.margin}}},
               {"versions", versionsJson()},
               {"origin", vectorJson(record.frame.origin)}};
  if (record.envelopeBox) {
    json["envelope"] = {{"min", vectorJson(record.envelopeBox->min())}, {"max", vectorJson(record.envelopeBox->max())}};
  } else {
    json["envelope"] = nullptr;
  }
  if (record.mesh) json["mesh"] = meshJson(*record.mesh);
  if (record.points) json["points"] = prepareJson(*record.points);
  if (record.poisson) {
    json["implicit"] = poissonJson(*record.poisson);
  } else if (record.mesh) {
    json["implicit"] = {{"kind", kDistanceKind}};
  }
  json["warnings"] = record.warnings;
  return json;
}

FormRecord formRecord(const Json& json, const std::string& name) {
  const Reader reader(json, name);
  const auto schema = reader.get<std::string>("schema");
  if (schema != kFormSchema) {
    throw InputError(name + ": expected the schema \"" + kFormSchema + "\", found \"" + schema + "\"");
  }
  FormRecord record;
  record.input = inputRecord(reader.object("input"));
  const Reader options = reader.object("options");
  const auto envelope = options.get<std::string>("envelope");
  if (envelope != toString(Envelope::box) && envelope != toString(Envelope::none)) {
    throw InputError(name + ", options: expected the envelope box or none, found \"" + envelope + "\"");
  }
  record.envelope = envelope == toString(Envelope::box) ? Envelope::box : Envelope::none;
  record.margin = options.get<double>("margin");
  record.frame.origin = reader.vector("origin");
  if (reader.has("envelope")) {
    const Reader box = reader.object("envelope");
    record.envelopeBox = Box3(box.vector("min"), box.vector("max"));
  }
  if (record.envelopeBox.has_value() != (record.envelope == Envelope::box) ||
      (record.envelopeBox && record.envelopeBox->isEmpty())) {
    throw InputError(name + ": the envelope's box does not agree with the options");
  }
  if (reader.has("points")) record.points = prepareSummary(reader.object("points"));
  bool isDistance = false;
  if (reader.has("implicit")) {
    const Reader implicit = reader.object("implicit");
    isDistance = implicit.get<std::string>("kind") == kDistanceKind;
    if (!isDistance) record.poisson = poissonSummary(implicit);
  }
  if (isDistance || reader.has("mesh")) record.mesh = meshRecord(reader.object("mesh"), isDistance);
  if (record.mesh) record.mesh->summary.format = record.input.format;
  record.warnings = reader.get<std::vector<std::string>>("warnings");
  return record;
}

Json readJson(const std::filesystem::path& path) {
  std::ifstream stream = openInputFile(path);
  try {
    return Json::parse(stream);
  } catch (const Json::exception& error) {
    throw InputError(path.string() + ": not valid JSON: " + error.what());
  }
}

void writeJson(const std::filesystem::path& path, const Json& json) {
  OutputFile file(path);
  file.stream() << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  file.commit();
}

}  // namespace voroform::pipeline
