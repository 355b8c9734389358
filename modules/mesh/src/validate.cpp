#include "voroform/mesh/validate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "boundary_topology.hpp"
#include "point_samples.hpp"
#include "self_intersections.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/mesh/moments.hpp"

namespace voroform::mesh {

namespace {

// At least this share of the point samples must be decidable, or the point location has shown nothing.
constexpr double kLocatedShare = 0.5;

void complain(Certificate& certificate, const Violations& violations, const std::string& what,
              const std::string& element) {
  if (violations.count == 0) return;
  certificate.problems.push_back(std::to_string(violations.count) + " " + what + ", the first at " + element + " " +
                                 std::to_string(violations.first));
}

// Do the arrays fit each other, so that they can be walked at all?
bool sound(const PolyhedralComplex& complex, Certificate& certificate) {
  const std::size_t faces = complex.faceCells.size();
  const auto& offsets = complex.faceOffsets;
  constexpr auto kMax = static_cast<std::size_t>(std::numeric_limits<Index>::max());
  std::string fault;
  if (faces > kMax || complex.vertices.size() > kMax || complex.cellCount < 0) {
    fault = "more faces or vertices than an index can name, or a negative number of cells";
  } else if (offsets.size() != faces + 1 || offsets.front() != 0 ||
             offsets.back() != static_cast<std::int64_t>(complex.faceVertices.size()) ||
             !std::is_sorted(offsets.begin(), offsets.end())) {
    fault = "the face offsets do not fit the faces";
  } else if (complex.faceTags.size() != faces) {
    fault = std::to_string(complex.faceTags.size()) + " face tags for " + std::to_string(faces) + " faces";
  } else if (!complex.cellSites.empty() && complex.cellSites.size() != static_cast<std::size_t>(complex.cellCount)) {
    fault = std::to_string(complex.cellSites.size()) + " sites for " + std::to_string(complex.cellCount) + " cells";
  }
  if (fault.empty()) return true;
  certificate.invalidFaces = std::max<Index>(1, static_cast<Index>(std::min(faces, kMax)));
  certificate.problems.push_back(fault);
  return false;
}

bool validFace(const PolyhedralComplex& complex, Index f, std::vector<Index>& lastFace) {
  const auto loop = complex.face(f);
  const auto [behind, ahead] = complex.faceCells[static_cast<std::size_t>(f)];
  bool valid = loop.size() >= 3 && behind >= 0 && behind < complex.cellCount && ahead >= kNone &&
               ahead < complex.cellCount && behind != ahead;
  for (const Index v : loop) {
    if (v < 0 || v >= static_cast<Index>(complex.vertices.size())) {
      valid = false;
    } else if (Index& last = lastFace[static_cast<std::size_t>(v)]; last == f) {
      valid = false;
    } else {
      last = f;
    }
  }
  return valid;
}

void checkFaces(const PolyhedralComplex& complex, Certificate& certificate) {
  Violations invalid;
  std::vector<Index> lastFace(complex.vertices.size(), kNone);
  for (Index f = 0; f < complex.faceCount(); ++f) {
    if (!validFace(complex, f, lastFace)) invalid.add(f);
  }
  certificate.invalidFaces = invalid.count;
  complain(certificate, invalid, "invalid faces (too few vertices, a vertex twice, an index out of range)", "face");
}

void checkCoordinates(const PolyhedralComplex& complex, Certificate& certificate) {
  Violations vertices;
  Violations sites;
  for (std::size_t v = 0; v < complex.vertices.size(); ++v) {
    if (!complex.vertices[v].allFinite()) vertices.add(static_cast<Index>(v));
  }
  for (std::size_t i = 0; i < complex.cellSites.size(); ++i) {
    if (!complex.cellSites[i].allFinite()) sites.add(static_cast<Index>(i));
  }
  certificate.nonFiniteVertices = vertices.count;
  complain(certificate, vertices, "vertices that are not finite", "vertex");
  complain(certificate, sites, "sites that are not finite", "cell");
}

void checkTopology(const PolyhedralComplex& complex, const CellFaces& rows, Certificate& certificate,
                   const RunContext& context) {
  const Violations open = openCells(complex, rows, context);
  certificate.openCells = open.count;
  complain(certificate, open, "open cells", "cell");
  const BoundaryTopology topology = boundaryTopology(complex);
  certificate.nonManifoldEdges = topology.nonManifoldEdges.count;
  certificate.nonManifoldVertices = topology.nonManifoldVertices.count;
  certificate.inconsistentEdges = topology.inconsistentEdges.count;
  certificate.components = topology.components;
  certificate.eulerCharacteristic = topology.eulerCharacteristic;
  complain(certificate, topology.nonManifoldEdges, "boundary edges without exactly two faces", "vertex");
  complain(certificate, topology.nonManifoldVertices, "boundary vertices with more than one fan", "vertex");
  complain(certificate, topology.inconsistentEdges, "boundary edges whose faces are turned against each other",
           "vertex");
}

void checkVolumes(const PolyhedralComplex& complex, const TriangleMesh& boundary, Certificate& certificate,
                  const RunContext& context) {
  Violations notPositive;
  double sum = 0;
  const std::vector<CellMoments> moments = cellMoments(complex, context);
  for (std::size_t cell = 0; cell < moments.size(); ++cell) {
    sum += moments[cell].volume;
    if (!(moments[cell].volume > 0)) notPositive.add(static_cast<Index>(cell));
  }
  certificate.nonPositiveVolumes = notPositive.count;
  complain(certificate, notPositive, "cells without a positive volume", "cell");
  certificate.volume = enclosedVolume(boundary);
  certificate.outward = certificate.volume > 0;
  if (!certificate.outward) certificate.problems.emplace_back("the boundary does not enclose a positive volume");
  certificate.volumeError = std::abs(sum - certificate.volume) / std::abs(certificate.volume);
  if (!(certificate.volumeError <= kVolumeConsistency)) {
    certificate.problems.push_back("the cells' volumes add up to " + std::to_string(sum) + ", the boundary encloses " +
                                   std::to_string(certificate.volume));
  }
}

void checkGeometry(const PolyhedralComplex& complex, const CellFaces& rows, const BoundarySurface& boundary,
                   const ValidateOptions& options, Certificate& certificate, const RunContext& context) {
  if (options.selfIntersections) {
    const SelfIntersections found = selfIntersections(boundary.mesh, context);
    constexpr std::int64_t kMax = std::numeric_limits<Index>::max();
    certificate.selfIntersections = static_cast<Index>(std::min(found.pairs, kMax));
    if (found.pairs > 0) {
      const auto source = [&](std::size_t i) {
        return std::to_string(boundary.sourceFaces[static_cast<std::size_t>(found.first[i])]);
      };
      certificate.problems.push_back(std::to_string(found.pairs) +
                                     " pairs of boundary triangles intersect, the first on the faces " + source(0) +
                                     " and " + source(1));
    }
  }
  if (options.pointSamples > 0) {
    const PointSamples samples =
        locateSamples(complex, rows, boundary.mesh, options.pointSamples, options.seed, context);
    certificate.pointSamples = samples.located;
    certificate.pointViolations = samples.violations.count;
    complain(certificate, samples.violations,
             "random points in several cells, or in no cell inside the boundary, or the reverse", "sample");
    if (samples.located < kLocatedShare * options.pointSamples) {
      certificate.problems.push_back("only " + std::to_string(samples.located) + " of " +
                                     std::to_string(options.pointSamples) + " random points could be located");
    }
  }
}

}  // namespace

Certificate validate(const PolyhedralComplex& complex, const ValidateOptions& options, const RunContext& context) {
  Certificate certificate;
  if (!sound(complex, certificate)) return certificate;
  if (complex.cellCount == 0) certificate.problems.emplace_back("no cells");
  checkFaces(complex, certificate);
  checkCoordinates(complex, certificate);
  // What follows walks the faces and would read out of range.
  if (certificate.invalidFaces > 0) return certificate;
  const CellFaces rows = cellFaces(complex);
  checkTopology(complex, rows, certificate, context);
  if (certificate.nonFiniteVertices == 0) {
    const BoundarySurface boundary = boundarySurface(complex);
    checkVolumes(complex, boundary.mesh, certificate, context);
    checkGeometry(complex, rows, boundary, options, certificate, context);
  }
  certificate.valid = certificate.problems.empty();
  return certificate;
}

}  // namespace voroform::mesh
