// The command info: what a file is, its size, its validity.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <set>
#include <string>
#include <system_error>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "exit_codes.hpp"
#include "voroform/core/input_file.hpp"
#include "voroform/implicit/form_file.hpp"
#include "voroform/implicit/tetrahedral_form.hpp"
#include "voroform/mesh/formats.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/planar_formats.hpp"
#include "voroform/mesh/read_mesh.hpp"
#include "voroform/mesh/validate.hpp"
#include "voroform/pipeline/planar.hpp"
#include "voroform/points/read.hpp"

namespace voroform::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json boxJson(const Box3& box, const Frame& frame) {
  if (box.isEmpty()) return nullptr;
  const Vec3 low = box.min() + frame.origin;
  const Vec3 high = box.max() + frame.origin;
  return {{"min", {low.x(), low.y(), low.z()}}, {"max", {high.x(), high.y(), high.z()}}};
}

Json describeCells(const mesh::PolyhedralComplex& complex, const Settings& settings, const RunContext& context) {
  mesh::ValidateOptions options;
  options.seed = settings.seed;
  const mesh::Certificate certificate = mesh::validate(complex, options, context);
  Box3 box;
  for (const Vec3& vertex : complex.vertices) box.extend(vertex);
  return {{"kind", "cells"},
          {"cells", complex.cellCount},
          {"vertices", complex.vertices.size()},
          {"faces", complex.faceCount()},
          {"volume", certificate.volume},
          {"bounds", boxJson(box, complex.frame)},
          {"valid", certificate.valid},
          {"closed_cells", certificate.closedCells()},
          {"manifold_boundary", certificate.manifoldBoundary()},
          {"oriented", certificate.oriented()},
          {"self_intersections", certificate.selfIntersections},
          {"components", certificate.components},
          {"euler_characteristic", certificate.eulerCharacteristic},
          {"problems", certificate.problems}};
}

Json describeForm(const fs::path& path, const RunContext& context) {
  const implicit::FormFile file = implicit::readForm(path, context);
  return {{"kind", "form"},
          {"vertices", file.form->mesh().vertices.size()},
          {"tetrahedra", file.form->mesh().tetrahedra.size()},
          {"bounds_of_the_inside", boxJson(file.form->bounds(), file.frame)}};
}

Json describePoints(const fs::path& path, const RunContext& context) {
  const points::ReadResult read = points::readPoints(path, context);
  std::vector<Vec3> finite;
  std::copy_if(read.cloud.positions.begin(), read.cloud.positions.end(), std::back_inserter(finite),
               [](const Vec3& p) { return p.allFinite(); });
  Box3 box;
  for (const Vec3& p : finite) box.extend(p);
  const std::size_t finiteCount = finite.size();
  const auto key = [](const Vec3& p) { return std::array<double, 3>{p.x(), p.y(), p.z()}; };
  std::sort(finite.begin(), finite.end(), [&key](const Vec3& a, const Vec3& b) { return key(a) < key(b); });
  const auto distinct = std::unique(finite.begin(), finite.end());
  return {{"kind", read.summary.faces > 0 ? "mesh" : "points"},
          {"format", read.summary.format},
          {"records", read.summary.records},
          {"faces", read.summary.faces},
          {"normals", read.summary.normals},
          {"not_finite", read.cloud.positions.size() - finiteCount},
          {"duplicates", std::distance(distinct, finite.end())},
          {"bounds", boxJson(box, read.cloud.frame)}};
}

// A mesh as a solid's boundary; what keeps it from being one is told and is no failure of the command.
Json describeMesh(const fs::path& path, const RunContext& context) {
  Json json = {{"kind", "mesh"}};
  try {
    const mesh::MeshReadResult read = mesh::readSolidMesh(path, context);
    const mesh::MeshReadSummary& summary = read.summary;
    Box3 box;
    for (const Vec3& vertex : read.mesh.vertices) box.extend(vertex);
    json.update(Json{{"format", summary.format},
                     {"vertices", summary.vertices},
                     {"faces", summary.faces},
                     {"triangles", read.mesh.triangles.size()},
                     {"bounds", boxJson(box, read.mesh.frame)},
                     {"closed", true},
                     {"volume", mesh::enclosedVolume(read.mesh)},
                     {"components", summary.components},
                     {"euler_characteristic", mesh::eulerCharacteristic(read.mesh)},
                     {"self_intersections", mesh::meshIntersections(read.mesh, context).pairs},
                     {"welded", summary.welded},
                     {"degenerate", summary.degenerate},
                     {"unused_vertices", summary.unusedVertices},
                     {"turned_triangles", summary.turnedFaces}});
  } catch (const mesh::NotSolid& problem) {
    json.update(Json{{"format", problem.summary.format},
                     {"vertices", problem.summary.vertices},
                     {"faces", problem.summary.faces},
                     {"closed", false},
                     {"problem", problem.what()}});
  }
  return json;
}

Json describeRegion(const std::string& input, const RunContext& context) {
  const pipeline::PlanarInput read = pipeline::planarFromInput(input, context);
  const mesh::PlanarRegion& region = read.region;
  const Vec2 low = region.bounds().min();
  const Vec2 high = region.bounds().max();
  return {{"kind", "region"},
          {"format", read.record.format},
          {"rings", region.ringCount()},
          {"holes", region.holeCount()},
          {"points", region.points().size()},
          {"area", region.area()},
          {"bounds", {{"min", {low.x(), low.y()}}, {"max", {high.x(), high.y()}}}}};
}

// All kinds of .vtu are ours; the arrays that only some have stand in the header.
std::string headOf(const fs::path& path) {
  std::ifstream stream = openInputFile(path);
  std::string head(1 << 16, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(stream.gcount()));
  return head;
}

Json describeVtu(const fs::path& path, const Settings& settings, const RunContext& context) {
  const std::string head = headOf(path);
  if (head.find(mesh::kPlanarFormatField) != std::string::npos) {
    return {{"kind", "cells of a region of the plane"}, {"measures", "in the metrics.json beside it"}};
  }
  const bool holdsCells = head.find("face_offsets") != std::string::npos;
  return holdsCells ? describeCells(mesh::readCellsVtu(path), settings, context) : describeForm(path, context);
}

void printText(const Json& json) {
  for (const auto& [name, value] : json.items()) {
    std::string label = name;
    std::replace(label.begin(), label.end(), '_', ' ');
    std::cout << label << ": ";
    if (value.is_string()) {
      std::cout << value.get<std::string>();
    } else if (value.is_boolean()) {
      std::cout << (value.get<bool>() ? "yes" : "no");
    } else if (value.is_object() && value.contains("min")) {
      std::cout << value["min"].dump() << " to " << value["max"].dump();
    } else {
      std::cout << value.dump();
    }
    std::cout << '\n';
  }
}

}  // namespace

int runInfo(const Settings& settings, const CLI::App&, const RunContext& context) {
  const fs::path path = settings.input;
  requireRegularFile(path);
  std::error_code error;
  Json json = {{"file", path.string()}, {"bytes", fs::file_size(path, error)}};
  Json content;
  if (pipeline::isPlanarInput(settings.input)) {
    content = describeRegion(settings.input, context);
  } else if (path.extension() == ".vtu") {
    content = describeVtu(path, settings, context);
  } else {
    content = mesh::holdsFaces(path, context) ? describeMesh(path, context) : describePoints(path, context);
  }
  json.update(content);
  if (settings.json) {
    std::cout << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
  } else {
    printText(json);
  }
  return kExitDone;
}

}  // namespace voroform::cli
