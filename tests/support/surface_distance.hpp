// Distances from the interior of boundary triangles to the zero set of f. Header-only test support.
#pragma once

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "voroform/core/parallel.hpp"
#include "voroform/core/random.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/implicit/roots.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::testing {

// The point of f = 0 on the line through p along f's gradient at p, found between two bracketing points.
inline Vec3 projectAlongGradient(const implicit::ImplicitFunction& f, const Vec3& p, double reach) {
  const double value = f.value(p);
  const Vec3 gradient = f.gradient(p);
  const double slope = gradient.norm();
  if (!(slope > 0)) throw std::runtime_error("no gradient to project along");
  const Vec3 direction = (value < 0 ? 1.0 : -1.0) * gradient / slope;
  std::int64_t evaluations = 0;
  for (double step = std::min(reach, 2 * std::abs(value) / slope + 1e-12 * reach);; step *= 2) {
    const Vec3 q = p + step * direction;
    const double other = f.value(q);
    if ((other < 0) != (value < 0)) {
      const double t = implicit::findRoot(f, p, q, value, other, 1e-13, implicit::RootFinder::itp, evaluations);
      return p + t * (q - p);
    }
    if (step > reach) throw std::runtime_error("no surface within reach");
  }
}

// Distance from p to the nearest point of S near p: the foot point slides in S's tangent plane until p lies on its
// normal.
inline double distanceToSurface(const implicit::ImplicitFunction& f, const Vec3& p, double reach) {
  Vec3 foot = projectAlongGradient(f, p, reach);
  double best = (foot - p).norm();
  for (int round = 0; round < 8; ++round) {
    const Vec3 normal = f.gradient(foot).normalized();
    const Vec3 offset = p - foot;
    const Vec3 tangential = offset - normal.dot(offset) * normal;
    if (tangential.norm() <= 1e-3 * best) break;
    foot = projectAlongGradient(f, foot + tangential, reach);
    best = std::min(best, (foot - p).norm());
  }
  return best;
}

struct SurfaceDistances {
  double mean = 0;
  double rms = 0;
  double max = 0;
  std::size_t samples = 0;
};

// `perTriangle` samples a triangle on average, uniform by area.
inline SurfaceDistances surfaceDistances(const implicit::ImplicitFunction& f, const mesh::TriangleMesh& mesh,
                                         std::size_t perTriangle, const RunContext& context) {
  std::vector<double> areas;
  double total = 0;
  for (const auto& t : mesh.triangles) {
    const auto v = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
    total += 0.5 * (v(1) - v(0)).cross(v(2) - v(0)).norm();
    areas.push_back(total);
  }
  const std::size_t samples = perTriangle * mesh.triangles.size();
  const double reach = 0.25 * f.bounds().diagonal().norm();
  struct Sums {
    double first = 0, second = 0, most = 0;
  };
  const Sums sums = parallelReduce(
      context, samples, 1024, Sums{},
      [&](std::size_t begin, std::size_t end, Sums sum) {
        for (std::size_t s = begin; s < end; ++s) {
          // Stratified along the cumulated area.
          const double at = (static_cast<double>(s) + randomUnit(1, RandomStream::sampling, 3 * s)) /
                            static_cast<double>(samples) * total;
          const auto i = static_cast<std::size_t>(
              std::min<std::ptrdiff_t>(std::upper_bound(areas.begin(), areas.end(), at) - areas.begin(),
                                       static_cast<std::ptrdiff_t>(areas.size()) - 1));
          double u = randomUnit(1, RandomStream::sampling, 3 * s + 1);
          double v = randomUnit(1, RandomStream::sampling, 3 * s + 2);
          if (u + v > 1) u = 1 - u, v = 1 - v;
          const auto& t = mesh.triangles[i];
          const Vec3 p = (1 - u - v) * mesh.vertices[static_cast<std::size_t>(t[0])] +
                         u * mesh.vertices[static_cast<std::size_t>(t[1])] +
                         v * mesh.vertices[static_cast<std::size_t>(t[2])];
          const double d = distanceToSurface(f, p, reach);
          sum.first += d;
          sum.second += d * d;
          sum.most = std::max(sum.most, d);
        }
        return sum;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a.first + b.first, a.second + b.second, std::max(a.most, b.most)};
      });
  const auto n = static_cast<double>(samples);
  return {sums.first / n, std::sqrt(sums.second / n), sums.most, samples};
}

}  // namespace voroform::testing
