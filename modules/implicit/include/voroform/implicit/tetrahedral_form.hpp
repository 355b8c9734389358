// An implicit form that is linear in each tetrahedron of a Delaunay triangulation: what a Poisson fit yields, in flat
// arrays that any number of threads may read.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::implicit {

struct FormVertex {
  Vec3 position;
  double value = 0;
};

// vertices: positively oriented, so that (b−a)·((c−a)×(d−a)) > 0. neighbors[i] shares the face opposite vertices[i],
// kNone at the hull.
struct FormTetrahedron {
  std::array<Index, 4> vertices;
  std::array<Index, 4> neighbors;
};

struct TetrahedralMesh {
  std::vector<FormVertex> vertices;
  std::vector<FormTetrahedron> tetrahedra;
  // For each vertex 1 if it is a point of the cloud that the form was fitted to, else 0; or empty if that is unknown.
  std::vector<std::uint8_t> measured;
};

// What makes the mesh unusable as a form, in words (with the number of the vertex or tetrahedron); empty if nothing.
// Checks indices, finite numbers, orientation and the symmetry of the neighbors. Linear time.
std::string findProblem(const TetrahedralMesh& mesh);

// Renumbers vertices and tetrahedra along a space-filling curve, which makes evaluation several times faster.
void sortSpatially(TetrahedralMesh& mesh);

class ClearanceGrid;

// Evaluation walks from a tetrahedron that depends on the query point alone, so values depend on the point alone. A
// value is a convex combination of the tetrahedron's four values, so that its sign is theirs if they agree. Outside the
// triangulation's hull f is a positive constant.
class TetrahedralForm final : public ImplicitFunction {
 public:
  // The clearance grid has gridResolution voxels along the longest side of the bounds. A walk of more than walkLimit
  // steps (cyclic ones exist in triangulations that are not Delaunay) ends in a search of all tetrahedra.
  // Throws InputError if findProblem() finds one.
  TetrahedralForm(TetrahedralMesh mesh, int gridResolution, const RunContext& context, int walkLimit = kWalkLimit);
  ~TetrahedralForm() override;

  double value(const Vec3& p) const override;
  // Constant in each tetrahedron; zero outside the hull.
  Vec3 gradient(const Vec3& p) const override;
  // Empty if f is negative nowhere.
  Box3 bounds() const override { return bounds_; }
  void values(std::span<const Vec3> points, std::span<double> out) const override;
  double clearance(const Vec3& p) const override;

  // The tetrahedron that value() and gradient() use at p; kNone outside the hull.
  Index locate(const Vec3& p) const;
  const TetrahedralMesh& mesh() const { return mesh_; }
  int gridResolution() const { return gridResolution_; }

  static constexpr int kWalkLimit = 4096;

 private:
  struct Located;
  Located locateWithVolumes(const Vec3& p) const;
  Located walk(Index start, const Vec3& p) const;
  Located searchAll(const Vec3& p) const;
  std::size_t startCellOf(const Vec3& p) const;
  void computeBounds();
  void buildStartGrid(const RunContext& context);
  void buildClearanceGrid(const RunContext& context);

  TetrahedralMesh mesh_;
  int gridResolution_;
  int walkLimit_;
  double outsideValue_ = 1;
  Box3 hullBox_;
  Box3 bounds_;
  // Start grid: for each cell of a regular grid a tetrahedron close by.
  Vec3 startOrigin_ = Vec3::Zero();
  double cellsPerUnit_ = 0;
  std::array<int, 3> startCells_ = {1, 1, 1};
  std::vector<Index> startTetrahedra_;
  std::unique_ptr<const ClearanceGrid> clearanceGrid_;
};

}  // namespace voroform::implicit
