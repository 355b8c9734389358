#include "voroform/implicit/surface_fit.hpp"

#include <algorithm>
#include <cmath>

#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::implicit {

namespace {

constexpr std::size_t kGrain = 512;
constexpr int kMostIterations = 100;
// The residual's norm, relative to the right-hand side's, at which the conjugate gradients stop: the shifts are then
// far more exact than the linearization.
constexpr double kSolverTolerance = 1e-4;
// A quadrature point farther from S than this share of its triangle's longest edge sees another part of S.
constexpr double kReach = 1.0;
// A triangle with more quadrature points than this that do not find S does not follow it: it spans a gap or a groove
// narrower than itself.
constexpr int kMostUnfound = 3;

// Quadrature of degree four on a triangle, six points (Cowper 1973): barycentric coordinates and weights of sum 1.
struct QuadraturePoint {
  std::array<double, 3> barycentric;
  double weight;
};
constexpr double kA = 0.445948490915965;
constexpr double kB = 0.091576213509771;
constexpr double kWeightA = 0.223381589678011;
constexpr double kWeightB = 0.109951743655322;
constexpr std::array<QuadraturePoint, 6> kQuadrature = {{
    {{kA, kA, 1 - 2 * kA}, kWeightA},
    {{kA, 1 - 2 * kA, kA}, kWeightA},
    {{1 - 2 * kA, kA, kA}, kWeightA},
    {{kB, kB, 1 - 2 * kB}, kWeightB},
    {{kB, 1 - 2 * kB, kB}, kWeightB},
    {{1 - 2 * kB, kB, kB}, kWeightB},
}};

// S near a point, to first order: its signed distance (negative inside) and its normal.
struct Tangent {
  double distance = 0;
  Vec3 normal = Vec3::Zero();  // zero: S was not found
};

// Newton's step along the gradient, and the plane tangent to S's level where it leads.
Tangent tangentAt(const ImplicitFunction& f, const Vec3& p, double value, double reach) {
  const Vec3 gradient = f.gradient(p);
  const double squared = gradient.squaredNorm();
  if (!(squared > 0)) return {};
  const Vec3 step = value / squared * gradient;
  if (!(step.norm() <= reach)) return {};
  const Vec3 foot = p - step;
  const Vec3 footGradient = f.gradient(foot);
  const double norm = footGradient.norm();
  if (!(norm > 0)) return {};
  Tangent tangent;
  tangent.normal = footGradient / norm;
  tangent.distance = tangent.normal.dot(step) + f.value(foot) / norm;
  if (!(std::abs(tangent.distance) <= reach)) return {};
  return tangent;
}

// The normal equations, triangle by triangle: ½ sᵀKs + gᵀs with a symmetric 3 × 3 block for each triangle.
struct TriangleBlock {
  std::array<double, 6> matrix = {};  // (0,0) (1,1) (2,2) (0,1) (1,2) (2,0)
  std::array<double, 3> gradient = {};
  double area = 0;
  double squares = 0;  // ∫ distance²
  int unfound = 0;
};

class Fit {
 public:
  Fit(const FitProblem& problem, const ImplicitFunction& f, const FitOptions& options, const RunContext& context)
      : problem_(problem), f_(f), options_(options), context_(context), blocks_(problem.triangles.size()) {
    linkVertices();
    held_.assign(problem.positions.size(), 0);
  }

  void assemble(const std::vector<double>& shifts) {
    parallelFor(context_, blocks_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<Vec3> points;
      for (std::size_t t = begin; t < end; ++t) {
        for (const QuadraturePoint& q : kQuadrature) points.push_back(pointAt(problem_.triangles[t], q, shifts));
      }
      std::vector<double> values(points.size());
      f_.values(points, values);
      for (std::size_t t = begin; t < end; ++t) {
        blocks_[t] = block(t, shifts, points.data() + (t - begin) * kQuadrature.size(),
                           values.data() + (t - begin) * kQuadrature.size());
      }
    });
  }

  // Fixes the vertices of triangles that do not follow S: how far S is from these says nothing about the moves.
  Index holdUnseen() {
    for (std::size_t t = 0; t < blocks_.size(); ++t) {
      if (blocks_[t].unfound <= kMostUnfound) continue;
      for (const Index v : problem_.triangles[t]) held_[static_cast<std::size_t>(v)] = 1;
    }
    return static_cast<Index>(std::count(held_.begin(), held_.end(), 1));
  }

  // Huber's weights (1964), a triangle at a time: what is far beyond the mean counts by its distance, not its square.
  // No triangle across a crease can follow it; in the mean square it would pull its neighbors off the flats beside it.
  void weigh() {
    double sum = 0;
    double area = 0;
    for (const TriangleBlock& block : blocks_) {
      sum += std::sqrt(block.squares * block.area);
      area += block.area;
    }
    const double most = area > 0 ? options_.huberScale * sum / area : 0;
    for (TriangleBlock& block : blocks_) {
      if (!(block.squares > most * most * block.area)) continue;
      const double weight = most / std::sqrt(block.squares / block.area);
      for (double& entry : block.matrix) entry *= weight;
      for (double& entry : block.gradient) entry *= weight;
    }
  }

  // Solves for the change of the shifts by conjugate gradients with the diagonal as preconditioner.
  std::vector<double> solve(const std::vector<double>& shifts, int& iterations) const {
    const std::size_t n = problem_.positions.size();
    std::vector<double> inverseDiagonal(n), x(n, 0.0), r(n), z(n), p(n), Ap(n);
    parallelFor(context_, n, kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        double diagonal = options_.damping * mass_[v], gradient = options_.damping * mass_[v] * shifts[v];
        forEachCorner(v, [&](const TriangleBlock& block, std::size_t corner, const auto&) {
          diagonal += block.matrix[corner];
          gradient += block.gradient[corner];
        });
        inverseDiagonal[v] = free(v) && diagonal > 0 ? 1 / diagonal : 0;
        r[v] = free(v) ? -gradient : 0;
        z[v] = p[v] = inverseDiagonal[v] * r[v];
      }
    });
    double rz = dot(r, z);
    const double first = rz;
    for (int i = 0; i < kMostIterations && rz > kSolverTolerance * kSolverTolerance * first; ++i, ++iterations) {
      multiply(p, Ap);
      const double alpha = rz / dot(p, Ap);
      parallelFor(context_, n, 8 * kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) {
          x[v] += alpha * p[v];
          r[v] -= alpha * Ap[v];
          z[v] = inverseDiagonal[v] * r[v];
        }
      });
      const double next = dot(r, z);
      const double beta = next / rz;
      rz = next;
      parallelFor(context_, n, 8 * kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t v = begin; v < end; ++v) p[v] = z[v] + beta * p[v];
      });
    }
    return x;
  }

  const std::vector<TriangleBlock>& blocks() const { return blocks_; }

 private:
  bool free(std::size_t v) const {
    return held_[v] == 0 && problem_.ranges[v][0] < problem_.ranges[v][1] && problem_.directions[v] != Vec3::Zero();
  }

  Vec3 positionOf(Index vertex, const std::vector<double>& shifts) const {
    const auto v = static_cast<std::size_t>(vertex);
    return problem_.positions[v] + shifts[v] * problem_.directions[v];
  }

  Vec3 pointAt(const std::array<Index, 3>& triangle, const QuadraturePoint& q,
               const std::vector<double>& shifts) const {
    Vec3 point = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) point += q.barycentric[k] * positionOf(triangle[k], shifts);
    return point;
  }

  TriangleBlock block(std::size_t t, const std::vector<double>& shifts, const Vec3* points,
                      const double* values) const {
    const auto& triangle = problem_.triangles[t];
    const Vec3 a = positionOf(triangle[0], shifts);
    const Vec3 b = positionOf(triangle[1], shifts);
    const Vec3 c = positionOf(triangle[2], shifts);
    const double reach =
        kReach * std::sqrt(std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()}));
    const Vec3 doubleArea = (b - a).cross(c - a);
    TriangleBlock block;
    block.area = 0.5 * doubleArea.norm();
    if (!(block.area > 0)) return block;
    const Vec3 normal = doubleArea.normalized();
    // Gradients of the barycentric coordinates, and the part of each vertex's direction that changes the distance.
    const std::array<Vec3, 3> gradients = {normal.cross(c - b) / (2 * block.area),
                                           normal.cross(a - c) / (2 * block.area),
                                           normal.cross(b - a) / (2 * block.area)};
    std::array<double, 3> lift;
    for (std::size_t k = 0; k < 3; ++k) {
      lift[k] = normal.dot(problem_.directions[static_cast<std::size_t>(triangle[k])]);
    }
    const double slopeWeight = options_.normalWeight * block.area;
    for (std::size_t i = 0; i < kQuadrature.size(); ++i) {
      const Tangent tangent = tangentAt(f_, points[i], values[i], reach);
      // S's other side, seen through a thin part, is not what the triangle follows.
      if (tangent.normal == Vec3::Zero() || tangent.normal.dot(doubleArea) <= 0) {
        ++block.unfound;
        continue;
      }
      const double weight = kQuadrature[i].weight * block.area;
      std::array<double, 3> along;
      for (std::size_t k = 0; k < 3; ++k) {
        along[k] = kQuadrature[i].barycentric[k] *
                   tangent.normal.dot(problem_.directions[static_cast<std::size_t>(triangle[k])]);
      }
      for (std::size_t k = 0; k < 3; ++k) {
        block.matrix[k] += weight * along[k] * along[k];
        block.matrix[3 + k] += weight * along[k] * along[(k + 1) % 3];
        block.gradient[k] += weight * along[k] * tangent.distance;
      }
      // The distance's slope along the triangle is the normal's tangential part.
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        const double scale = weight * slopeWeight * lift[k];
        block.matrix[k] += scale * lift[k] * gradients[k].squaredNorm();
        block.matrix[3 + k] += scale * lift[next] * gradients[k].dot(gradients[next]);
        block.gradient[k] += scale * gradients[k].dot(tangent.normal);
      }
      block.squares += weight * tangent.distance * tangent.distance;
    }
    return block;
  }

  void linkVertices() {
    const std::size_t n = problem_.positions.size();
    std::vector<std::uint32_t> counts(n, 0);
    for (const auto& triangle : problem_.triangles) {
      for (const Index v : triangle) ++counts[static_cast<std::size_t>(v)];
    }
    offsets_ = std::move(counts);
    exclusiveScan(offsets_);
    std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
    corners_.resize(3 * problem_.triangles.size());
    for (std::size_t t = 0; t < problem_.triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        corners_[next[static_cast<std::size_t>(problem_.triangles[t][k])]++] = static_cast<std::uint32_t>(3 * t + k);
      }
    }
    mass_.assign(n, 0.0);
    for (const auto& triangle : problem_.triangles) {
      const auto at = [&](std::size_t k) { return problem_.positions[static_cast<std::size_t>(triangle[k])]; };
      const double third = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 6;
      for (const Index v : triangle) mass_[static_cast<std::size_t>(v)] += third;
    }
  }

  // Calls visit(block, corner, triangle) for the triangles around a vertex.
  template <class Visit>
  void forEachCorner(std::size_t v, const Visit& visit) const {
    for (std::uint32_t i = offsets_[v]; i < offsets_[v + 1]; ++i) {
      const std::size_t t = corners_[i] / 3;
      visit(blocks_[t], corners_[i] % 3, problem_.triangles[t]);
    }
  }

  void multiply(const std::vector<double>& x, std::vector<double>& y) const {
    parallelFor(context_, x.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin; v < end; ++v) {
        if (!free(v)) {
          y[v] = 0;
          continue;
        }
        double sum = options_.damping * mass_[v] * x[v];
        forEachCorner(v, [&](const TriangleBlock& block, std::size_t k, const std::array<Index, 3>& triangle) {
          const std::size_t next = (k + 1) % 3;
          const std::size_t last = (k + 2) % 3;
          sum += block.matrix[k] * x[v] + block.matrix[3 + k] * x[static_cast<std::size_t>(triangle[next])] +
                 block.matrix[3 + last] * x[static_cast<std::size_t>(triangle[last])];
        });
        y[v] = sum;
      }
    });
  }

  double dot(const std::vector<double>& a, const std::vector<double>& b) const {
    return parallelReduce(
        context_, a.size(), 8 * kGrain, 0.0,
        [&](std::size_t begin, std::size_t end, double sum) {
          for (std::size_t v = begin; v < end; ++v) sum += a[v] * b[v];
          return sum;
        },
        [](double x, double y) { return x + y; });
  }

  const FitProblem& problem_;
  const ImplicitFunction& f_;
  const FitOptions& options_;
  const RunContext& context_;
  std::vector<TriangleBlock> blocks_;
  std::vector<std::uint32_t> offsets_;  // rows: vertices → corners
  std::vector<std::uint32_t> corners_;  // 3·triangle + corner
  std::vector<double> mass_;            // a third of the area around each vertex
  std::vector<std::uint8_t> held_;      // vertices of triangles that do not follow S
};

}  // namespace

std::vector<std::string> validate(const FitOptions& options) {
  std::vector<std::string> violations;
  if (!(options.damping >= 0)) {
    violations.push_back("damping is " + std::to_string(options.damping) + ", but must be at least 0");
  }
  if (!(options.normalWeight >= 0)) {
    violations.push_back("normalWeight is " + std::to_string(options.normalWeight) + ", but must be at least 0");
  }
  if (!(options.huberScale > 0)) {
    violations.push_back("huberScale is " + std::to_string(options.huberScale) + ", but must be above 0");
  }
  if (options.rounds < 1) {
    violations.push_back("rounds is " + std::to_string(options.rounds) + ", but must be at least 1");
  }
  return violations;
}

std::vector<double> fitShifts(const FitProblem& problem, const ImplicitFunction& f, const FitOptions& options,
                              const RunContext& context, FitSummary& summary) {
  if (const auto violations = validate(options); !violations.empty()) throw UsageError(violations.front());
  const Stopwatch watch;
  std::vector<double> shifts(problem.positions.size(), 0.0);
  Fit fit(problem, f, options, context);
  summary.samples = static_cast<std::int64_t>(kQuadrature.size() * problem.triangles.size());
  for (int round = 0; round < options.rounds; ++round) {
    fit.assemble(shifts);
    double squares = 0;
    double area = 0;
    summary.unfound = 0;
    for (const TriangleBlock& block : fit.blocks()) {
      squares += block.squares;
      area += block.area;
      summary.unfound += block.unfound;
    }
    if (round == 0) {
      summary.rmsBefore = area > 0 ? std::sqrt(squares / area) : 0;
      summary.held = fit.holdUnseen();
    } else {
      fit.weigh();
    }
    const std::vector<double> change = fit.solve(shifts, summary.iterations);
    summary.bounded = 0;
    for (std::size_t v = 0; v < shifts.size(); ++v) {
      const double wanted = shifts[v] + change[v];
      shifts[v] = std::clamp(wanted, problem.ranges[v][0], problem.ranges[v][1]);
      if (shifts[v] != wanted) ++summary.bounded;
    }
  }
  summary.seconds = watch.seconds();
  return shifts;
}

}  // namespace voroform::implicit
