#include "voroform/baselines/fit_boundary.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace voroform::baselines {

namespace {

// As for fitted caps: no farther than this, in units of the square root of the area around the vertex.
constexpr double kMostShift = 0.25;
// Vertices keep this share of the way to the cube edge's ends clear.
constexpr double kEdgeShare = 0.05;
// A vertex lies on a grid line if its other coordinates are this near to whole numbers of cubes.
constexpr double kOnLine = 1e-9;
// What a tetrahedron keeps of its volume at least.
constexpr double kKeptVolume = 0.1;

// The boundary's vertices with the directions and ranges that they may move along.
struct BoundaryProblem {
  std::vector<Vec3> directions;
  std::vector<std::array<double, 2>> ranges;
  std::vector<std::array<Index, 3>> triangles;

  implicit::FitProblem view(const std::vector<Vec3>& positions) const {
    return {positions, directions, ranges, triangles};
  }
};

// Along the normals, in the range that the area around the vertex allows.
BoundaryProblem boundaryProblem(const mesh::PolyhedralComplex& complex) {
  BoundaryProblem problem;
  const std::size_t count = complex.vertices.size();
  problem.directions.assign(count, Vec3::Zero());
  problem.ranges.assign(count, {0.0, 0.0});
  std::vector<double> area(count, 0.0);
  std::vector<std::uint8_t> fixed(count, 0);
  for (Index f = 0; f < complex.faceCount(); ++f) {
    if (!complex.isBoundary(f)) continue;
    const auto loop = complex.face(f);
    if (complex.faceTags[static_cast<std::size_t>(f)] == mesh::FaceTag::envelope) {
      for (const Index v : loop) fixed[static_cast<std::size_t>(v)] = 1;
      continue;
    }
    for (std::size_t k = 2; k < loop.size(); ++k) {
      const std::array<Index, 3> triangle = {loop[0], loop[k - 1], loop[k]};
      const auto at = [&](std::size_t i) { return complex.vertices[static_cast<std::size_t>(triangle[i])]; };
      const Vec3 doubleArea = (at(1) - at(0)).cross(at(2) - at(0));
      for (const Index v : triangle) {
        problem.directions[static_cast<std::size_t>(v)] += doubleArea;
        area[static_cast<std::size_t>(v)] += 0.5 * doubleArea.norm();
      }
      problem.triangles.push_back(triangle);
    }
  }
  for (std::size_t v = 0; v < count; ++v) {
    const double length = problem.directions[v].norm();
    if (fixed[v] != 0 || !(length > 0)) {
      problem.directions[v] = Vec3::Zero();
      continue;
    }
    problem.directions[v] /= length;
    const double most = kMostShift * std::sqrt(area[v]);
    problem.ranges[v] = {-most, most};
  }
  return problem;
}

// Vertices on cube edges slide on them, between the edge's ends.
void slideOnEdges(BoundaryProblem& problem, const std::vector<Vec3>& positions, const CubeGrid& grid) {
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (problem.directions[v] == Vec3::Zero()) continue;
    const Vec3 place = (positions[v] - grid.origin) / grid.edge;
    int axis = -1;
    int whole = 0;
    for (int i = 0; i < 3; ++i) {
      if (std::abs(place[i] - std::round(place[i])) <= kOnLine) {
        ++whole;
      } else {
        axis = i;
      }
    }
    if (whole != 2) continue;
    const double along = place[axis] - std::floor(place[axis]);
    const double clear = (1 - kEdgeShare) * grid.edge;
    problem.directions[v] = problem.directions[v][axis] < 0 ? Vec3(-Vec3::Unit(axis)) : Vec3(Vec3::Unit(axis));
    const bool turned = problem.directions[v][axis] < 0;
    auto& [low, high] = problem.ranges[v];
    low = std::max(low, -clear * (turned ? 1 - along : along));
    high = std::min(high, clear * (turned ? along : 1 - along));
  }
}

std::vector<Vec3> moved(const std::vector<Vec3>& positions, const BoundaryProblem& problem,
                        const std::vector<double>& shifts) {
  std::vector<Vec3> result = positions;
  for (std::size_t v = 0; v < result.size(); ++v) result[v] += shifts[v] * problem.directions[v];
  return result;
}

// The four corners of each cell, from its faces.
std::vector<std::array<Index, 4>> cornersOfTetrahedra(const mesh::PolyhedralComplex& complex) {
  const mesh::CellFaces faces = mesh::cellFaces(complex);
  std::vector<std::array<Index, 4>> corners(static_cast<std::size_t>(complex.cellCount));
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const auto begin = static_cast<std::size_t>(faces.offsets[c]);
    const auto base = complex.face(faces.faces[begin]);
    const auto other = complex.face(faces.faces[begin + 1]);
    const auto apex = std::find_if(other.begin(), other.end(),
                                   [&](Index v) { return std::find(base.begin(), base.end(), v) == base.end(); });
    corners[c] = {base[0], base[1], base[2], *apex};
  }
  return corners;
}

double orientedVolume(const std::vector<Vec3>& positions, const std::array<Index, 4>& corners) {
  const auto at = [&](std::size_t i) -> const Vec3& { return positions[static_cast<std::size_t>(corners[i])]; };
  return (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) / 6;
}

BoundaryFit finish(mesh::PolyhedralComplex& complex, const BoundaryProblem& problem, const std::vector<double>& shifts,
                   BoundaryFit result) {
  complex.vertices = moved(complex.vertices, problem, shifts);
  result.moved = static_cast<Index>(std::count_if(shifts.begin(), shifts.end(), [](double s) { return s != 0; }));
  return result;
}

}  // namespace

BoundaryFit fitMarchingCubes(mesh::PolyhedralComplex& complex, const CubeGrid& grid,
                             const implicit::ImplicitFunction& f, const implicit::FitOptions& options,
                             const RunContext& context) {
  BoundaryProblem problem = boundaryProblem(complex);
  slideOnEdges(problem, complex.vertices, grid);
  BoundaryFit result;
  const auto shifts = implicit::fitShifts(problem.view(complex.vertices), f, options, context, result.summary);
  return finish(complex, problem, shifts, std::move(result));
}

BoundaryFit fitTetrahedra(mesh::PolyhedralComplex& complex, const implicit::ImplicitFunction& f,
                          const implicit::FitOptions& options, const RunContext& context) {
  const BoundaryProblem problem = boundaryProblem(complex);
  const auto cells = cornersOfTetrahedra(complex);
  BoundaryFit result;
  auto shifts = implicit::fitShifts(problem.view(complex.vertices), f, options, context, result.summary);
  // Taking back one shift may flatten another tetrahedron; with all of them taken back none is.
  for (bool again = true; again;) {
    again = false;
    const std::vector<Vec3> positions = moved(complex.vertices, problem, shifts);
    for (const auto& corners : cells) {
      const double before = orientedVolume(complex.vertices, corners);
      if (orientedVolume(positions, corners) * (before < 0 ? -1 : 1) >= kKeptVolume * std::abs(before)) continue;
      for (const Index v : corners) {
        double& shift = shifts[static_cast<std::size_t>(v)];
        if (shift == 0) continue;
        shift = 0;
        ++result.takenBack;
        again = true;
      }
    }
  }
  return finish(complex, problem, shifts, std::move(result));
}

}  // namespace voroform::baselines
