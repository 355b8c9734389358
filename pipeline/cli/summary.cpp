#include "summary.hpp"

#include <cstdio>

namespace voroform::cli {

namespace {

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

std::string percent(double share) { return number(100 * share) + " %"; }

std::string plural(std::uint64_t count, const std::string& thing, const std::string& things) {
  return std::to_string(count) + " " + (count == 1 ? thing : things);
}

std::string plural(std::uint64_t count, const std::string& thing) { return plural(count, thing, thing + "s"); }

}  // namespace

void printPoints(std::ostream& out, const points::PrepareSummary& summary) {
  out << "points: " << summary.points << " of " << plural(summary.records, "record");
  if (summary.nonFinite > 0) out << ", " << summary.nonFinite << " not finite";
  if (summary.zeroNormals > 0) out << ", " << summary.zeroNormals << " without a normal's direction";
  if (summary.duplicates > 0) out << ", " << plural(summary.duplicates, "duplicate");
  if (summary.unoriented > 0) out << ", " << summary.unoriented << " that could not be oriented";
  out << "; spacing " << number(summary.spacing) << '\n';
  out << "normals: "
      << (summary.normalsEstimated ? "estimated, oriented along a minimum spanning tree" : "as in the file") << '\n';
}

void printForm(std::ostream& out, const pipeline::FormRecord& record) {
  if (record.input.kind == "shape") {
    out << "form: the shape " << record.input.name << '\n';
    return;
  }
  if (record.mesh) {
    const mesh::MeshReadSummary& mesh = record.mesh->summary;
    out << "mesh: " << plural(mesh.faces, "face") << ", "
        << plural(static_cast<std::uint64_t>(mesh.components), "component");
    if (mesh.welded > 0) out << ", " << mesh.welded << " vertices welded";
    if (mesh.degenerate > 0) out << ", " << plural(mesh.degenerate, "triangle") << " without area left out";
    if (mesh.unusedVertices > 0)
      out << ", " << plural(mesh.unusedVertices, "vertex of no face", "vertices of no face") << " left out";
    if (mesh.turnedFaces > 0) out << ", " << plural(mesh.turnedFaces, "triangle") << " turned";
    out << '\n';
    if (!record.poisson) {
      out << "form: the signed distance to the mesh\n";
      return;
    }
  }
  if (record.points) printPoints(out, *record.points);
  if (record.poisson) {
    out << "form: Poisson, " << record.poisson->vertices << " vertices, " << record.poisson->tetrahedra
        << " tetrahedra; " << percent(record.poisson->wrongNormalShare) << " of the normals point against it\n";
  }
  out << "envelope: ";
  if (record.envelopeBox) {
    out << "the cloud's bounding box grown by " << percent(record.margin) << " of its diagonal\n";
  } else {
    out << "none\n";
  }
}

void printOptimization(std::ostream& out, const cvt::OptimizeSummary& summary) {
  out << "optimization: " << plural(static_cast<std::uint64_t>(summary.iterationsDone), "iteration") << ", "
      << plural(static_cast<std::uint64_t>(summary.evaluations), "evaluation") << ", ended by "
      << cvt::toString(summary.stop) << "; energy " << percent(summary.relativeError) << " above its optimum\n";
}

void printMeasurement(std::ostream& out, const mesh::PolyhedralComplex& complex,
                      const pipeline::Measurement& measurement, bool hasCloud) {
  const mesh::Certificate& certificate = measurement.certificate;
  const metrics::Fidelity& fidelity = measurement.fidelity;
  out << "cells: " << complex.cellCount << ", " << measurement.regularity.boundary.cells
      << " of them at the boundary\n";
  out << "valid: " << (certificate.valid ? "yes" : "no") << "; "
      << plural(static_cast<std::uint64_t>(certificate.components), "component") << ", Euler number "
      << certificate.eulerCharacteristic << ", " << certificate.selfIntersections << " self-intersections, "
      << certificate.pointViolations << " of " << certificate.pointSamples << " points in doubt\n";
  for (const std::string& problem : certificate.problems) out << "  " << problem << '\n';
  out << "volume: " << number(certificate.volume) << ", " << percent(fidelity.volumeError) << " from the form's; "
      << percent(fidelity.missedShare) << " of the inside in no cell\n";
  out << "boundary: " << percent(fidelity.envelopeShare) << " on the envelope";
  if (hasCloud) out << ", " << percent(fidelity.unsupportedShare) << " farther than four spacings from any point";
  out << '\n';
  out << "regularity: mean " << number(measurement.regularity.all.mean) << ", largest "
      << number(measurement.regularity.all.max) << ", optimum " << number(measurement.regularity.optimal) << '\n';
}

void printPlanar(std::ostream& out, const pipeline::PlanarInput& input, const pipeline::PlanarResult& result) {
  const mesh::PlanarRegion& region = input.region;
  const pipeline::PlanarMeasurement& measurement = result.measurement;
  const mesh::PlanarCertificate& certificate = measurement.certificate;
  out << "region: " << input.record.name << ", " << plural(region.ringCount(), "ring") << " of "
      << plural(region.points().size(), "point") << ", area " << number(region.area()) << '\n';
  printOptimization(out, result.summary);
  out << "cells: " << result.tessellation.cellCount() << ", " << measurement.regularity.boundary.cells
      << " of them at the boundary\n";
  out << "valid: " << (certificate.valid ? "yes" : "no") << "; areas add up to the region's but for "
      << number(certificate.areaError) << " of it, " << certificate.pointViolations << " of "
      << certificate.pointSamples << " points in doubt\n";
  for (const std::string& problem : certificate.problems) out << "  " << problem << '\n';
  const metrics::RegularityStatistics& all = measurement.regularity.all;
  out << "regularity: mean " << number(all.mean) << ", median " << number(all.median) << ", largest " << number(all.max)
      << ", optimum " << number(measurement.regularity.optimal) << '\n';
}

void printAccuracy(std::ostream& out, const std::optional<metrics::Accuracy>& accuracy) {
  if (!accuracy) return;
  out << "accuracy: mean distance " << number(accuracy->dmean) << " (" << percent(accuracy->dmean / accuracy->cellSize)
      << " of the cell size), root mean square " << number(accuracy->drmse) << ", largest " << number(accuracy->dmax)
      << "; normals off by " << number(accuracy->nmean) << " on average, root mean square " << number(accuracy->nrmse)
      << " (radians)\n";
}

void printFiles(std::ostream& out, const std::filesystem::path& folder, const std::vector<std::string>& names) {
  out << "wrote " << folder.string() << ":";
  for (const std::string& name : names) out << ' ' << name;
  out << '\n';
}

}  // namespace voroform::cli
