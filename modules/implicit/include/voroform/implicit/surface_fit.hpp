// Least-squares fit of a triangulated surface to S, each vertex moving along one direction.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::implicit {

// Triangles whose vertices lie on S (or near it). Vertex i may move to positions[i] + s·directions[i] with s in
// ranges[i]; a zero direction or an empty range fixes it.
struct FitProblem {
  std::span<const Vec3> positions;
  std::span<const Vec3> directions;                 // unit, or zero
  std::span<const std::array<double, 2>> ranges;    // lowest ≤ 0 and highest ≥ 0 shift
  std::span<const std::array<Index, 3>> triangles;  // counter-clockwise seen from outside; only those that follow S
};

struct FitOptions {
  // Weight of the shifts themselves, Σ (a third of the area around vertex i)·sᵢ², against Σ area·distance²; at least 0.
  // It keeps directions almost tangent to S from running far for little.
  double damping = 0.02;
  // Weight of the normals: of ∫ area·|∇δ|² against ∫ δ², ∇ along the triangle; at least 0.
  double normalWeight = 0.05;
  // From the second round on, triangles whose root-mean-square distance is this many times the mean over all of them
  // or more count by their distance instead of its square; above 0, infinity for plain least squares. On surfaces
  // without creases that are few triangles.
  double huberScale = 1.5;
  // Rounds of sampling and solving, at least 1; each begins with the vertices where the last one left them.
  int rounds = 2;
};
std::vector<std::string> validate(const FitOptions& options);

struct FitSummary {
  std::int64_t samples = 0;  // quadrature points, of one round
  std::int64_t unfound = 0;  // of them, those without S nearby: left out
  int iterations = 0;        // of the conjugate gradients, in all rounds
  Index bounded = 0;         // vertices stopped by the end of their range
  Index held = 0;            // vertices of triangles that S cannot be seen from: they stay
  double rmsBefore = 0;  // √(∫ distance² / area) over the triangles, by the quadrature, at the first round's start
  double seconds = 0;
};

// The shifts s that minimize ∫ distance(x, S)² dx over the moved triangles, to first order in s about where each round
// starts: with δ the signed distance at a quadrature point and n S's normal there, Σ area·w·(δ + Σ bᵢ sᵢ n·dᵢ)². The
// integral is by a quadrature of degree four (six points a triangle). Vertices of triangles from most of whose points
// no S is found stay. The same bits for any number of threads.
std::vector<double> fitShifts(const FitProblem& problem, const ImplicitFunction& f, const FitOptions& options,
                              const RunContext& context, FitSummary& summary);

}  // namespace voroform::implicit
