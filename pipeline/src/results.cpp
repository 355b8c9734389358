#include "results.hpp"

#include "records.hpp"
#include "voroform/mesh/formats.hpp"
#include "voroform/pipeline/sha256.hpp"

namespace voroform::pipeline {

Json filesJson(const std::filesystem::path& folder, const std::vector<std::string>& names) {
  Json files = Json::object();
  for (const std::string& name : names) files[name] = sha256OfFile(folder / name);
  return files;
}

std::vector<std::string> writeResults(const Form& form, const Tessellation& tessellation, const WriteOptions& options,
                                      const std::filesystem::path& folder, const RunContext& context) {
  context.report("writing", 0);
  Tessellation const& t = tessellation;
  const auto volumes = [&t] {
    std::vector<double> values;
    values.reserve(t.measurement.moments.size());
    for (const mesh::CellMoments& moments : t.measurement.moments) values.push_back(moments.volume);
    return values;
  };
  ArtifactStore store(folder);
  writeForm(form, store);
  const std::vector<mesh::CellData> data = {
      {"volume", volumes()}, {"regularity", t.measurement.regularities}, {"boundary", t.measurement.boundaryFlags}};
  mesh::writeCellsVtu(store.path(kCellsFile), t.complex, data);
  context.throwIfCancelled();
  const mesh::BoundarySurface surface = mesh::boundarySurface(t.complex);
  mesh::writeSurfacePly(store.path("surface.ply"), surface, t.complex);
  mesh::writeSitesPly(store.path("sites.ply"), t.complex.cellSites, t.complex.frame);

  std::vector<std::string> warnings;
  for (const ExtraFormat format : options.formats) {
    switch (format) {
      case ExtraFormat::obj:
        mesh::writeSurfaceObj(store.path("surface.obj"), surface.mesh);
        break;
      case ExtraFormat::off:
        mesh::writeSurfaceOff(store.path("surface.off"), surface.mesh);
        break;
      case ExtraFormat::adjacency:
        mesh::writeAdjacency(store.path("adjacency.csv"), t.complex);
        break;
      case ExtraFormat::stl:
        warnings.emplace_back("surface.stl holds coordinates as 32-bit numbers, rounded to about 7 digits");
        context.warn(warnings.back());
        mesh::writeSurfaceStl(store.path("surface.stl"), surface.mesh);
        break;
    }
    context.throwIfCancelled();
  }

  Json json = metricsJson(form, t, options);
  for (std::string& warning : warnings) json["warnings"].push_back(std::move(warning));
  const std::vector<std::string> names = store.names();
  const std::filesystem::path metricsPath = store.path(kMetricsFile);
  json["sha256"] = filesJson(metricsPath.parent_path(), names);
  writeJson(metricsPath, json);
  context.throwIfCancelled();
  store.commit();
  context.report("writing", 1);
  return store.names();
}

}  // namespace voroform::pipeline
