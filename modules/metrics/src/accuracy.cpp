#include "voroform/metrics/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "accuracy_lines.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/implicit/closest_point.hpp"
#include "voroform/mesh/closest_triangle.hpp"

namespace voroform::metrics {

namespace {

constexpr std::size_t kGrain = 256;
constexpr double kSamplesPerCellEdge = 3;
// The nearest point of S is looked for within these multiples of h, one after the other while none is found.
constexpr double kReaches[] = {2, 8, 32};
// Reach of the thesis's variant in multiples of h.
constexpr double kLineReach = 2;

enum class Outcome : std::uint8_t { found, unfound, envelope };

struct Measurement {
  AccuracyPair pair;
  Outcome outcome = Outcome::unfound;
  std::optional<double> alongNormal;
};

// The boundary's triangles without those of no area, which have no normal; first those off the envelope.
struct Boundary {
  mesh::TriangleMesh mesh;
  std::vector<Vec3> normals;
  std::size_t offEnvelope = 0;

  bool onEnvelope(Index triangle) const { return static_cast<std::size_t>(triangle) >= offEnvelope; }
};

Boundary boundaryOf(const mesh::PolyhedralComplex& complex) {
  mesh::BoundarySurface surface = mesh::boundarySurface(complex);
  Boundary result;
  for (const mesh::FaceTag tag : {mesh::FaceTag::surface, mesh::FaceTag::envelope}) {
    for (std::size_t t = 0; t < surface.mesh.triangles.size(); ++t) {
      if (complex.faceTags[static_cast<std::size_t>(surface.sourceFaces[t])] != tag) continue;
      const auto& triangle = surface.mesh.triangles[t];
      const auto corner = [&](std::size_t k) -> const Vec3& {
        return surface.mesh.vertices[static_cast<std::size_t>(triangle[k])];
      };
      const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
      const double length = normal.norm();
      if (!(length > 0)) continue;
      result.mesh.triangles.push_back(triangle);
      result.normals.push_back(normal / length);
    }
    if (tag == mesh::FaceTag::surface) result.offEnvelope = result.mesh.triangles.size();
  }
  result.mesh.frame = surface.mesh.frame;
  result.mesh.vertices = std::move(surface.mesh.vertices);
  return result;
}

// Regular samples of the triangles off the envelope, whose numbers are the same in the whole boundary.
MeshSamples samplesOf(const Boundary& boundary, const AccuracyOptions& options, const RunContext& context) {
  mesh::TriangleMesh measured = boundary.mesh;
  measured.triangles.resize(boundary.offEnvelope);
  SurfaceCvtOptions sampling;
  sampling.spacing = options.cellSize / kSamplesPerCellEdge;
  sampling.seed = options.seed;
  return surfaceCvt(measured, sampling, context);
}

// In [0, π]; precise for small angles too.
double angleBetween(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

// How far the plane through `point` with the unit normal given is from a line's origin along the line.
double planeAlong(const SampleLine& line, const Vec3& point, const Vec3& normal) {
  constexpr double kLeastCosine = 0.1;
  const double cosine = std::abs(line.direction.dot(normal));
  return std::abs((point - line.origin).dot(normal)) / std::max(cosine, kLeastCosine);
}

std::vector<Measurement> measureFromForm(const SurfaceSamples& samples, const Boundary& boundary, double reach,
                                         const RunContext& context) {
  const mesh::ClosestTriangle tree(boundary.mesh);
  const LineCrossings crossings(boundary.mesh);
  std::vector<Measurement> result(samples.points.size());
  parallelFor(context, result.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& p = samples.points[i];
      const mesh::ClosestTriangle::Hit hit = tree.find(p);
      const Vec3& normal = boundary.normals[static_cast<std::size_t>(hit.triangle)];
      Measurement& m = result[i];
      m.pair = {p, hit.point, hit.distance, angleBetween(samples.normals[i], normal)};
      m.outcome = boundary.onEnvelope(hit.triangle) ? Outcome::envelope : Outcome::found;
      if (m.outcome == Outcome::envelope) continue;
      SampleLine line = {p, samples.normals[i], 0, reach};
      line.guess = planeAlong(line, hit.point, normal);
      m.alongNormal = crossings.nearest(line);
    }
  });
  return result;
}

// The nearest points of S, with farther and farther reach for the few that need it.
std::vector<implicit::ClosestPoint> nearestOnForm(const implicit::ImplicitFunction& f, const std::vector<Vec3>& points,
                                                  double cellSize, const RunContext& context) {
  std::vector<implicit::ClosestPoint> result(points.size());
  std::vector<std::size_t> open(points.size());
  for (std::size_t i = 0; i < open.size(); ++i) open[i] = i;
  for (const double reach : kReaches) {
    std::vector<Vec3> queries;
    queries.reserve(open.size());
    for (const std::size_t i : open) queries.push_back(points[i]);
    const auto found = implicit::closestPoints(f, queries, reach * cellSize, context);
    std::vector<std::size_t> left;
    for (std::size_t k = 0; k < open.size(); ++k) {
      result[open[k]] = found[k];
      if (!found[k].found) left.push_back(open[k]);
    }
    open = std::move(left);
    if (open.empty()) break;
  }
  return result;
}

std::vector<Measurement> measureFromBoundary(const MeshSamples& samples, const Boundary& boundary,
                                             const implicit::ImplicitFunction& f, double cellSize,
                                             const RunContext& context) {
  const std::vector<implicit::ClosestPoint> nearest = nearestOnForm(f, samples.points, cellSize, context);
  std::vector<Measurement> result(samples.points.size());
  parallelFor(context, result.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const implicit::ClosestPoint& point = nearest[i];
      const Vec3& normal = boundary.normals[static_cast<std::size_t>(samples.triangles[i])];
      Measurement& m = result[i];
      SampleLine line = {samples.points[i], normal, 0, kLineReach * cellSize};
      if (point.found) {
        m.outcome = f.onEnvelope(point.position) ? Outcome::envelope : Outcome::found;
        m.pair = {samples.points[i], point.position, point.distance, angleBetween(point.normal, normal)};
        line.guess = planeAlong(line, point.position, point.normal);
      }
      if (m.outcome != Outcome::envelope) m.alongNormal = crossingOfForm(f, line, cellSize);
    }
  });
  return result;
}

DirectedAccuracy summarize(const std::vector<Measurement>& measurements, double variation) {
  DirectedAccuracy result;
  result.variation = variation;
  for (const Measurement& m : measurements) {
    if (m.outcome == Outcome::unfound) ++result.unfound;
    if (m.outcome == Outcome::envelope) ++result.envelope;
    if (m.outcome != Outcome::found) continue;
    ++result.samples;
    result.mean += m.pair.distance;
    result.rms += m.pair.distance * m.pair.distance;
    result.max = std::max(result.max, m.pair.distance);
    result.normalMean += m.pair.angle;
    result.normalRms += m.pair.angle * m.pair.angle;
  }
  if (result.samples == 0) return result;
  const auto count = static_cast<double>(result.samples);
  result.mean /= count;
  result.rms = std::sqrt(result.rms / count);
  result.normalMean /= count;
  result.normalRms = std::sqrt(result.normalRms / count);
  return result;
}

double meanOf(double a, double b) { return (a + b) / 2; }
double rootMeanSquare(double a, double b) { return std::sqrt((a * a + b * b) / 2); }

struct LineMeans {
  double mean = 0;
  double rms = 0;
  std::int64_t misses = 0;
};

LineMeans lineMeans(const std::vector<Measurement>& measurements, double reach) {
  LineMeans result;
  std::int64_t count = 0;
  for (const Measurement& m : measurements) {
    if (m.outcome == Outcome::envelope) continue;
    ++count;
    if (!m.alongNormal) ++result.misses;
    const double distance = m.alongNormal.value_or(reach);
    result.mean += distance;
    result.rms += distance * distance;
  }
  if (count == 0) return result;
  result.mean /= static_cast<double>(count);
  result.rms = std::sqrt(result.rms / static_cast<double>(count));
  return result;
}

std::vector<AccuracyPair> foundPairs(const std::vector<Measurement>& measurements) {
  std::vector<AccuracyPair> pairs;
  for (const Measurement& m : measurements) {
    if (m.outcome == Outcome::found) pairs.push_back(m.pair);
  }
  return pairs;
}

void requireSamples(const SurfaceSamples& samples, const AccuracyOptions& options) {
  if (!(options.cellSize > 0) || !std::isfinite(options.cellSize)) {
    throw UsageError("accuracy: cellSize must be above 0, got " + std::to_string(options.cellSize));
  }
  if (samples.points.empty() || samples.points.size() != samples.normals.size()) {
    throw UsageError("accuracy: samples of the form's surface are needed, each with its normal; got " +
                     std::to_string(samples.points.size()) + " points and " + std::to_string(samples.normals.size()) +
                     " normals");
  }
}

}  // namespace

Accuracy accuracy(const mesh::PolyhedralComplex& complex, const implicit::ImplicitFunction& f,
                  const SurfaceSamples& samples, const AccuracyOptions& options, const RunContext& context,
                  AccuracyPairs* pairs) {
  requireSamples(samples, options);
  const Stopwatch watch;
  const Boundary boundary = boundaryOf(complex);
  if (boundary.offEnvelope == 0) {
    throw MethodError("accuracy: the tessellation's boundary has no face off the envelope to measure");
  }
  const double reach = kLineReach * options.cellSize;
  const std::vector<Measurement> fromForm = measureFromForm(samples, boundary, reach, context);
  const double secondsFromForm = watch.seconds();

  const MeshSamples boundarySamples = samplesOf(boundary, options, context);
  const std::vector<Measurement> fromBoundary =
      measureFromBoundary(boundarySamples, boundary, f, options.cellSize, context);

  Accuracy result;
  result.fromForm = summarize(fromForm, samples.variation);
  result.fromBoundary = summarize(fromBoundary, boundarySamples.variation);
  if (result.fromForm.samples == 0) {
    throw MethodError("accuracy: the nearest point of the boundary lies on the envelope for each of the form's " +
                      std::to_string(fromForm.size()) + " samples");
  }
  if (result.fromBoundary.samples == 0) {
    throw MethodError("accuracy: no point of the form's surface lies near any of the boundary's " +
                      std::to_string(fromBoundary.size()) + " samples");
  }
  result.dmean = meanOf(result.fromForm.mean, result.fromBoundary.mean);
  result.drmse = rootMeanSquare(result.fromForm.rms, result.fromBoundary.rms);
  result.dmax = std::max(result.fromForm.max, result.fromBoundary.max);
  result.nmean = meanOf(result.fromForm.normalMean, result.fromBoundary.normalMean);
  result.nrmse = rootMeanSquare(result.fromForm.normalRms, result.fromBoundary.normalRms);
  const LineMeans formLines = lineMeans(fromForm, reach);
  const LineMeans boundaryLines = lineMeans(fromBoundary, reach);
  result.normalLine = {formLines.misses + boundaryLines.misses, meanOf(formLines.mean, boundaryLines.mean),
                       rootMeanSquare(formLines.rms, boundaryLines.rms)};
  result.cellSize = options.cellSize;
  Box3 box;
  for (const Vec3& point : samples.points) box.extend(point);
  result.diagonal = box.diagonal().norm();
  if (pairs != nullptr) {
    pairs->fromForm = foundPairs(fromForm);
    pairs->fromBoundary = foundPairs(fromBoundary);
  }
  result.seconds = watch.seconds();
  context.debug("accuracy: from the form " + std::to_string(secondsFromForm) + " s, sampling the boundary " +
                std::to_string(boundarySamples.seconds) + " s, from the boundary " +
                std::to_string(result.seconds - secondsFromForm - boundarySamples.seconds) + " s");
  return result;
}

}  // namespace voroform::metrics
