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

void writeCells(const std::filesystem::path& path, const mesh::PolyhedralComplex& complex,
                const Measurement& measurement) {
  std::vector<double> volumes;
  volumes.reserve(measurement.moments.size());
  for (const mesh::CellMoments& moments : measurement.moments) volumes.push_back(moments.volume);
  const std::vector<mesh::CellData> data = {{"volume", std::move(volumes)},
                                            {"regularity", measurement.regularities},
                                            {"boundary", measurement.boundaryFlags}};
  mesh::writeCellsVtu(path, complex, data);
}

std::vector<std::string> writeResults(const Form& form, const Tessellation& tessellation, const WriteOptions& options,
                                      const std::filesystem::path& folder, const RunContext& context) {
  context.report("writing", 0);
  Tessellation const& t = tessellation;
  ArtifactStore store(folder);
  writeForm(form, store);
  using Path = std::filesystem::path;
  store.put(kCellsFile, [&](const Path& path) { writeCells(path, t.complex, t.measurement); });
  context.throwIfCancelled();
  const mesh::BoundarySurface surface = mesh::boundarySurface(t.complex);
  store.put("surface.ply", [&](const Path& path) { mesh::writeSurfacePly(path, surface, t.complex); });
  store.put("sites.ply", [&](const Path& path) { mesh::writeSitesPly(path, t.complex.cellSites, t.complex.frame); });

  std::vector<std::string> warnings;
  for (const ExtraFormat format : options.formats) {
    switch (format) {
      case ExtraFormat::obj:
        store.put("surface.obj", [&](const Path& path) { mesh::writeSurfaceObj(path, surface.mesh); });
        break;
      case ExtraFormat::off:
        store.put("surface.off", [&](const Path& path) { mesh::writeSurfaceOff(path, surface.mesh); });
        break;
      case ExtraFormat::adjacency:
        store.put("adjacency.csv", [&](const Path& path) { mesh::writeAdjacency(path, t.complex); });
        break;
      case ExtraFormat::stl:
        warnings.emplace_back("surface.stl holds coordinates as 32-bit numbers, rounded to about 7 digits");
        context.warn(warnings.back());
        store.put("surface.stl", [&](const Path& path) { mesh::writeSurfaceStl(path, surface.mesh); });
        break;
    }
    context.throwIfCancelled();
  }

  Json json = metricsJson(form, t, options);
  for (std::string& warning : warnings) json["warnings"].push_back(std::move(warning));
  json["sha256"] = filesJson(store.pathOf(""), store.names());
  store.put(kMetricsFile, [&](const Path& path) { writeJson(path, json); });
  context.throwIfCancelled();
  store.commit();
  context.report("writing", 1);
  return store.names();
}

}  // namespace voroform::pipeline
