// Forms of triangle meshes: the signed distance, and the Poisson form of samples (thesis, figure 5.7).
#include <algorithm>
#include <cmath>

#include "form_parts.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/mesh_distance.hpp"
#include "warnings.hpp"

namespace voroform::pipeline {

namespace {

// Points uniform by area, one in each of `count` equal parts of the area in the order of the triangles, with the
// triangles' normals.
points::PointCloud sample(const mesh::TriangleMesh& mesh, Index count, std::uint64_t seed) {
  const auto corner = [&](std::size_t t, std::size_t i) -> const Vec3& {
    return mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][i])];
  };
  std::vector<double> areaUpTo;
  areaUpTo.reserve(mesh.triangles.size());
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    area += (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).norm();
    areaUpTo.push_back(area);
  }
  points::PointCloud cloud;
  cloud.frame = mesh.frame;
  cloud.positions.reserve(static_cast<std::size_t>(count));
  cloud.normals.reserve(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i) {
    const auto key = 3 * static_cast<std::uint64_t>(i);
    const double share = (i + randomUnit(seed, RandomStream::meshSampling, key)) / count;
    const auto found = std::upper_bound(areaUpTo.begin(), areaUpTo.end() - 1, share * area);
    const auto t = static_cast<std::size_t>(found - areaUpTo.begin());
    const double u = std::sqrt(randomUnit(seed, RandomStream::meshSampling, key + 1));
    const double v = randomUnit(seed, RandomStream::meshSampling, key + 2);
    const Vec3 ab = corner(t, 1) - corner(t, 0);
    const Vec3 ac = corner(t, 2) - corner(t, 0);
    cloud.positions.push_back(corner(t, 0) + u * ((1 - v) * ab + v * ac));
    cloud.normals.push_back(ab.cross(ac).normalized());
  }
  return cloud;
}

// World coordinates, as files hold them.
points::PointCloud inWorld(points::PointCloud cloud) {
  for (Vec3& position : cloud.positions) position += cloud.frame.origin;
  cloud.frame = Frame();
  return cloud;
}

}  // namespace

Form formFromMesh(const std::filesystem::path& path, const FormOptions& options, const RunContext& context) {
  throwIfInvalid(options);
  const bool isDistance = options.implicitKind != ImplicitKind::poisson;
  Form form;
  const RunContext recording = recordWarnings(context, form.record.warnings);
  const Stopwatch watch;
  context.report("read mesh", 0);
  mesh::MeshReadResult read = mesh::readSolidMesh(path, recording);
  form.record.input = fileRecord(path, "mesh", read.summary.format);
  form.record.mesh = MeshRecord();
  form.record.mesh->summary = std::move(read.summary);
  if (options.rotationSeed) {
    form.record.input.rotationSeed = options.rotationSeed;
    read.mesh = mesh::rotated(read.mesh, randomRotation(*options.rotationSeed));
  }
  context.report("read mesh", 1);
  if (isDistance) {
    form.secondsPoints = watch.seconds();
    const Stopwatch distanceWatch;
    form.mesh = std::make_shared<mesh::TriangleMesh>(std::move(read.mesh));
    form.record.frame = form.mesh->frame;
    form.function = implicit::meshDistance(form.mesh, recording);
    form.secondsImplicit = distanceWatch.seconds();
    return form;
  }
  form.record.mesh->kind = ImplicitKind::poisson;
  form.record.mesh->samples = options.samples;
  form.record.mesh->seed = options.seed;
  points::PrepareResult prepared = points::prepare(inWorld(sample(read.mesh, options.samples, options.seed)),
                                                   path.string(), options.prepare, recording);
  form.cloud = std::move(prepared.cloud);
  form.record.points = prepared.summary;
  form.secondsPoints = watch.seconds();
  fitPoissonForm(form, options, context);
  return form;
}

}  // namespace voroform::pipeline
