#include "voroform/implicit/poisson.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Poisson_reconstruction_function.h>
#include <CGAL/property_map.h>

#include "tetrahedron.hpp"
#include "voroform/core/error.hpp"
#include "voroform/implicit/tetrahedral_form.hpp"

namespace voroform::implicit {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using PointWithNormal = std::pair<Kernel::Point_3, Kernel::Vector_3>;
using PoissonFunction = CGAL::Poisson_reconstruction_function<Kernel>;
using Triangulation = PoissonFunction::Triangulation;

constexpr double kMostWrongNormals = 0.25;
constexpr const char* kAdvice =
    "check that the normals are consistent and point out of the solid, or leave them out of the file to have them "
    "estimated and oriented";

// The triangulation with f at its vertices, and the normals of those that are points of the cloud (else zero).
struct FlatPoisson {
  TetrahedralMesh mesh;
  std::vector<Vec3> normals;
};

// CGAL's own evaluation is neither thread-safe nor fast, so only its triangulation and values are taken over.
FlatPoisson flatten(const Triangulation& triangulation) {
  FlatPoisson flat;
  TetrahedralMesh& mesh = flat.mesh;
  mesh.vertices.reserve(triangulation.number_of_vertices());
  mesh.measured.reserve(triangulation.number_of_vertices());
  flat.normals.reserve(triangulation.number_of_vertices());
  for (auto v = triangulation.finite_vertices_begin(); v != triangulation.finite_vertices_end(); ++v) {
    const bool measured = v->type() == Triangulation::INPUT;
    v->index() = static_cast<unsigned int>(mesh.vertices.size());
    mesh.vertices.push_back({Vec3(v->point().x(), v->point().y(), v->point().z()), v->f()});
    mesh.measured.push_back(measured ? 1 : 0);
    const auto& n = v->normal();
    flat.normals.push_back(measured ? Vec3(n.x(), n.y(), n.z()) : Vec3(Vec3::Zero()));
  }
  for (auto c = triangulation.all_cells_begin(); c != triangulation.all_cells_end(); ++c) c->info() = kNone;
  Index count = 0;
  for (auto c = triangulation.finite_cells_begin(); c != triangulation.finite_cells_end(); ++c) c->info() = count++;
  mesh.tetrahedra.reserve(static_cast<std::size_t>(count));
  for (auto c = triangulation.finite_cells_begin(); c != triangulation.finite_cells_end(); ++c) {
    FormTetrahedron& tetrahedron = mesh.tetrahedra.emplace_back();
    for (int i = 0; i < 4; ++i) {
      tetrahedron.vertices[static_cast<std::size_t>(i)] = static_cast<Index>(c->vertex(i)->index());
      tetrahedron.neighbors[static_cast<std::size_t>(i)] = c->neighbor(i)->info();
    }
  }
  return flat;
}

// Surrounds the cloud with refinement points. CGAL decides by the signs on the convex hull where the outside is. A
// cloud that is evenly spread on a convex surface is its own hull and would get a random answer; besides, the surface
// would leave through the hull. The points lie on a spherical Fibonacci lattice, beyond the ball of 1.5 radii that CGAL
// refines.
void surround(Triangulation& triangulation) {
  constexpr int kCount = 100;
  constexpr double kRadii = 1.6;
  const auto ball = triangulation.bounding_sphere();
  const double radius = kRadii * std::sqrt(ball.squared_radius());
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < kCount; ++i) {
    const double z = 1 - (2 * i + 1.0) / kCount;
    const double ring = radius * std::sqrt(1 - z * z);
    const Kernel::Vector_3 offset(ring * std::cos(turn * i), ring * std::sin(turn * i), radius * z);
    triangulation.insert(Triangulation::Point(ball.center() + offset), Triangulation::STEINER,
                         Triangulation::Cell_handle(), CGAL::Poisson_visitor());
  }
}

FlatPoisson solve(const points::PointCloud& cloud, const RunContext& context) {
  std::vector<PointWithNormal> points;
  points.reserve(cloud.positions.size());
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3& p = cloud.positions[i];
    const Vec3& n = cloud.normals[i];
    points.emplace_back(Kernel::Point_3(p.x(), p.y(), p.z()), Kernel::Vector_3(n.x(), n.y(), n.z()));
  }
  try {
    PoissonFunction function(points.begin(), points.end(), CGAL::First_of_pair_property_map<PointWithNormal>(),
                             CGAL::Second_of_pair_property_map<PointWithNormal>());
    context.report("Poisson", 0.3);
    context.throwIfCancelled();
    // The function owns a triangulation that is not const; it just has no other way to reach it.
    surround(const_cast<Triangulation&>(function.tr()));
    if (!function.compute_implicit_function()) {
      throw MethodError(std::string("the Poisson solver failed; ") + kAdvice);
    }
    context.report("Poisson", 0.8);
    context.throwIfCancelled();
    return flatten(function.tr());
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw EnvironmentError("not enough memory for the Poisson reconstruction of " +
                           std::to_string(cloud.positions.size()) + " points");
  } catch (const std::exception& failure) {
    throw MethodError(std::string("the Poisson reconstruction failed (") + failure.what() + "); " + kAdvice);
  }
}

// One direction of ∇f for each vertex: the average over the tetrahedra around by volume, then smoothed over the
// measured neighbors a few times. A fit to random normals follows each point's own normal, but not that of its
// neighborhood.
std::vector<Vec3> smoothGradients(const TetrahedralMesh& mesh) {
  constexpr int kPasses = 3;
  std::vector<Vec3> gradients(mesh.vertices.size(), Vec3::Zero());
  for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
    const TetrahedronFrame frame(mesh, static_cast<Index>(t));
    if (frame.isFlat()) continue;
    const Vec3 weighted = frame.determinant * frame.gradient();
    for (const Index v : mesh.tetrahedra[t].vertices) gradients[static_cast<std::size_t>(v)] += weighted;
  }
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<Vec3> smoothed(gradients.size(), Vec3::Zero());
    for (const FormTetrahedron& tetrahedron : mesh.tetrahedra) {
      Vec3 sum = Vec3::Zero();
      for (const Index v : tetrahedron.vertices) {
        if (mesh.measured[static_cast<std::size_t>(v)] != 0) sum += gradients[static_cast<std::size_t>(v)].normalized();
      }
      for (const Index v : tetrahedron.vertices) smoothed[static_cast<std::size_t>(v)] += sum;
    }
    gradients = std::move(smoothed);
  }
  return gradients;
}

// Share of the measured vertices where n·∇f < 0.
double shareAgainstNormals(const FlatPoisson& flat) {
  const std::vector<Vec3> gradients = smoothGradients(flat.mesh);
  std::size_t against = 0;
  std::size_t measured = 0;
  for (std::size_t v = 0; v < gradients.size(); ++v) {
    if (flat.mesh.measured[v] == 0) continue;
    ++measured;
    if (flat.normals[v].dot(gradients[v]) < 0) ++against;
  }
  return measured > 0 ? static_cast<double>(against) / static_cast<double>(measured) : 0.0;
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g %%", 100 * share);
  return text;
}

void judgeNormals(const FlatPoisson& flat, PoissonSummary& summary, const RunContext& context) {
  const double against = shareAgainstNormals(flat);
  summary.signTurned = against > 0.5;
  summary.wrongNormalShare = summary.signTurned ? 1 - against : against;
  if (summary.wrongNormalShare > kMostWrongNormals) {
    throw MethodError("the normals of " + percent(against) + " of the points contradict the fitted form; " + kAdvice);
  }
  if (summary.signTurned) {
    context.warn(
        "all normals seem to be flipped (they point into the solid); the form was turned to be negative inside");
  }
  if (summary.wrongNormalShare > 0) {
    context.warn("the normals of " + percent(summary.wrongNormalShare) + " of the points contradict the fitted form");
  }
}

void requireSurfaceIn(const Box3& region, const TetrahedralForm& form) {
  bool negative = false;
  bool positive = false;
  const auto take = [&](double value) { (value < 0 ? negative : positive) = true; };
  for (const FormVertex& vertex : form.mesh().vertices) {
    if (region.contains(vertex.position)) take(vertex.value);
  }
  constexpr int kSamples = 24;  // along each axis, for regions between the vertices
  for (int i = 0; i < kSamples * kSamples * kSamples && !(negative && positive); ++i) {
    const Vec3 cell(i % kSamples, i / kSamples % kSamples, i / kSamples / kSamples);
    take(form.value(region.min() + region.sizes().cwiseProduct((cell.array() + 0.5).matrix()) / kSamples));
  }
  if (!negative) throw MethodError(std::string("the fitted form has no inside near the points; ") + kAdvice);
  if (!positive) throw MethodError(std::string("the fitted form has no outside near the points; ") + kAdvice);
}

}  // namespace

std::vector<std::string> validate(const PoissonOptions& options) {
  std::vector<std::string> violations;
  if (options.gridResolution < 16 || options.gridResolution > 512) {
    violations.push_back("the resolution of the clearance grid is " + std::to_string(options.gridResolution) +
                         " and must be in [16, 512]");
  }
  return violations;
}

PoissonResult fitPoisson(const points::PointCloud& cloud, const Box3& region, const PoissonOptions& options,
                         const RunContext& context) {
  for (const std::string& violation : validate(options)) throw UsageError(violation);
  if (cloud.normals.size() != cloud.positions.size() || cloud.positions.empty()) {
    throw InputError("a Poisson reconstruction needs points with normals");
  }
  const Stopwatch stopwatch;
  context.report("Poisson", 0);
  FlatPoisson flat = solve(cloud, context);
  PoissonResult result;
  judgeNormals(flat, result.summary, context);
  flat.normals = {};
  sortSpatially(flat.mesh);
  result.summary.vertices = static_cast<Index>(flat.mesh.vertices.size());
  result.summary.tetrahedra = static_cast<Index>(flat.mesh.tetrahedra.size());
  context.report("Poisson", 0.9);
  try {
    result.form = std::make_shared<TetrahedralForm>(std::move(flat.mesh), options.gridResolution, context);
  } catch (const InputError& problem) {
    throw MethodError(std::string("the Poisson reconstruction is unusable: ") + problem.what() + "; " + kAdvice);
  }
  requireSurfaceIn(region, *result.form);
  result.summary.seconds = stopwatch.seconds();
  context.report("Poisson", 1);
  return result;
}

}  // namespace voroform::implicit
