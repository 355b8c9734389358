#include "voroform/implicit/tetrahedral_form.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "clearance_grid.hpp"
#include "rounding.hpp"
#include "tetrahedron.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::implicit {

namespace {

// Where f vanishes between two vertices of unlike signs.
Vec3 crossing(const FormVertex& a, const FormVertex& b) {
  return a.position + a.value / (a.value - b.value) * (b.position - a.position);
}

// The negative vertices, and the corners of the polygon f = 0.
struct NegativePart {
  explicit NegativePart(const TetrahedronFrame& frame) {
    for (const FormVertex* a : frame.vertex) {
      if (!(a->value < 0)) continue;
      ++negatives;
      box.extend(a->position);
      for (const FormVertex* b : frame.vertex) {
        if (b->value < 0) continue;
        anyZero = crossing(*a, *b);
        zeros.extend(anyZero);
      }
    }
    if (!zeros.isEmpty()) box.extend(zeros);
  }

  bool isMixed() const { return negatives > 0 && negatives < 4; }

  int negatives = 0;
  Box3 box;
  Box3 zeros;
  Vec3 anyZero = Vec3::Zero();
};

Box3 boxOf(const TetrahedronFrame& frame) {
  Box3 box;
  for (const FormVertex* vertex : frame.vertex) box.extend(vertex->position);
  return box;
}

}  // namespace

struct TetrahedralForm::Located {
  Index tetrahedron = kNone;
  std::array<double, 4> volumes{};  // of the point with each face
};

TetrahedralForm::TetrahedralForm(TetrahedralMesh mesh, int gridResolution, const RunContext& context, int walkLimit)
    : mesh_(std::move(mesh)), gridResolution_(gridResolution), walkLimit_(walkLimit) {
  if (gridResolution < 1) throw UsageError("the resolution of the clearance grid must be positive");
  const std::string problem = findProblem(mesh_);
  if (!problem.empty()) throw InputError(problem);
  computeBounds();
  buildStartGrid(context);
  context.throwIfCancelled();
  buildClearanceGrid(context);
}

TetrahedralForm::~TetrahedralForm() = default;

void TetrahedralForm::computeBounds() {
  double largest = 0;
  for (const FormVertex& vertex : mesh_.vertices) {
    hullBox_.extend(vertex.position);
    largest = std::max(largest, std::abs(vertex.value));
  }
  if (largest > 0) outsideValue_ = largest;
  Box3 box;
  const auto tetrahedra = static_cast<Index>(mesh_.tetrahedra.size());
  for (Index t = 0; t < tetrahedra; ++t) {
    const NegativePart part{TetrahedronFrame(mesh_, t)};
    if (part.negatives > 0) box.extend(part.box);
  }
  bounds_ = inflated(box);
}

void TetrahedralForm::buildStartGrid(const RunContext& context) {
  // As many cells as tetrahedra in the box: a cell is then about as large as a tetrahedron.
  const Box3 box = bounds_.isEmpty() ? hullBox_ : bounds_;
  std::vector<Vec3> centroids(mesh_.tetrahedra.size());
  std::size_t inside = 0;
  for (std::size_t t = 0; t < centroids.size(); ++t) {
    Vec3 sum = Vec3::Zero();
    for (const Index v : mesh_.tetrahedra[t].vertices) sum += mesh_.vertices[static_cast<std::size_t>(v)].position;
    centroids[t] = 0.25 * sum;
    if (box.contains(centroids[t])) ++inside;
  }
  constexpr double kFewestCells = 64;
  constexpr double kMostCellsAlongSide = 512;
  const Vec3 sizes = box.sizes().cwiseMax(1e-3 * box.sizes().maxCoeff());
  const double cellEdge = std::max(std::cbrt(sizes.prod() / std::max(kFewestCells, static_cast<double>(inside))),
                                   sizes.maxCoeff() / kMostCellsAlongSide);
  if (!(cellEdge > 0)) throw InputError("the triangulation has no extent");
  cellsPerUnit_ = 1 / cellEdge;
  startOrigin_ = box.min();
  std::size_t total = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    startCells_[axis] =
        std::max(1, static_cast<int>(std::ceil(sizes[static_cast<Eigen::Index>(axis)] * cellsPerUnit_)));
    total *= static_cast<std::size_t>(startCells_[axis]);
  }
  // First the tetrahedron of the lowest number with its centroid in the cell; for cells without one that of the cell
  // before, in either direction; and from there the one that holds the cell's center.
  std::vector<Index> seeds(total, kNone);
  for (std::size_t t = 0; t < centroids.size(); ++t) {
    if (!box.contains(centroids[t])) continue;
    Index& seed = seeds[startCellOf(centroids[t])];
    if (seed == kNone) seed = static_cast<Index>(t);
  }
  Index previous = kNone;
  for (Index& seed : seeds) previous = seed = seed == kNone ? previous : seed;
  previous = 0;
  for (auto seed = seeds.rbegin(); seed != seeds.rend(); ++seed) previous = *seed = *seed == kNone ? previous : *seed;

  startTetrahedra_ = seeds;
  constexpr std::size_t kGrain = 4096;
  parallelFor(context, total, kGrain, [&](std::size_t begin, std::size_t end) {
    const auto nx = static_cast<std::size_t>(startCells_[0]);
    const auto ny = static_cast<std::size_t>(startCells_[1]);
    for (std::size_t cell = begin; cell < end; ++cell) {
      const Vec3 place(static_cast<double>(cell % nx) + 0.5, static_cast<double>(cell / nx % ny) + 0.5,
                       static_cast<double>(cell / nx / ny) + 0.5);
      const Located located = walk(seeds[cell], startOrigin_ + cellEdge * place);
      if (located.tetrahedron != kNone) startTetrahedra_[cell] = located.tetrahedron;
    }
  });
}

std::size_t TetrahedralForm::startCellOf(const Vec3& p) const {
  std::array<std::size_t, 3> cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double coordinate = (p[i] - startOrigin_[i]) * cellsPerUnit_;
    cell[axis] = static_cast<std::size_t>(std::clamp(coordinate, 0.0, startCells_[axis] - 1.0));
  }
  return (cell[2] * static_cast<std::size_t>(startCells_[1]) + cell[1]) * static_cast<std::size_t>(startCells_[0]) +
         cell[0];
}

TetrahedralForm::Located TetrahedralForm::walk(Index start, const Vec3& p) const {
  Index current = start;
  Index previous = kNone;
  for (int step = 0; step < walkLimit_; ++step) {
    const TetrahedronFrame frame(mesh_, current);
    const std::array<double, 4> volumes = frame.subvolumes(p);
    const std::array<Index, 4>& neighbors = mesh_.tetrahedra[static_cast<std::size_t>(current)].neighbors;
    // Toward the face with the most negative volume. Never back: in exact arithmetic the point cannot lie there, and
    // rounding must not make the walk swing between two tetrahedra.
    std::size_t exit = 4;
    double worst = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (volumes[i] < worst && (neighbors[i] == kNone || neighbors[i] != previous)) {
        worst = volumes[i];
        exit = i;
      }
    }
    if (exit == 4) return {current, volumes};
    if (neighbors[exit] == kNone) return {};
    previous = current;
    current = neighbors[exit];
  }
  return searchAll(p);
}

TetrahedralForm::Located TetrahedralForm::searchAll(const Vec3& p) const {
  Located best;
  constexpr double kTolerance = 1e-12;  // a point this far outside of all, by volumes, lies outside the hull
  double bestShare = -kTolerance;
  const auto tetrahedra = static_cast<Index>(mesh_.tetrahedra.size());
  for (Index t = 0; t < tetrahedra; ++t) {
    const TetrahedronFrame frame(mesh_, t);
    const std::array<double, 4> volumes = frame.subvolumes(p);
    double total = 0;
    for (const double volume : volumes) total += std::abs(volume);
    const double share = *std::min_element(volumes.begin(), volumes.end()) / total;
    if (share > bestShare) {
      bestShare = share;
      best = {t, volumes};
    }
  }
  return best;
}

TetrahedralForm::Located TetrahedralForm::locateWithVolumes(const Vec3& p) const {
  if (!hullBox_.contains(p)) return {};
  return walk(startTetrahedra_[startCellOf(p)], p);
}

Index TetrahedralForm::locate(const Vec3& p) const { return locateWithVolumes(p).tetrahedron; }

double TetrahedralForm::value(const Vec3& p) const {
  const Located located = locateWithVolumes(p);
  if (located.tetrahedron == kNone) return outsideValue_;
  const FormTetrahedron& tetrahedron = mesh_.tetrahedra[static_cast<std::size_t>(located.tetrahedron)];
  double sum = 0;
  double total = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double weight = std::max(located.volumes[i], 0.0);
    sum += weight * mesh_.vertices[static_cast<std::size_t>(tetrahedron.vertices[i])].value;
    total += weight;
  }
  // No positive volume: a tetrahedron so flat that its volume is lost in rounding.
  if (!(total > 0)) return mesh_.vertices[static_cast<std::size_t>(tetrahedron.vertices[0])].value;
  return sum / total;
}

void TetrahedralForm::values(std::span<const Vec3> points, std::span<double> out) const {
  if (points.size() != out.size()) throw std::invalid_argument("values: as many results as points are needed");
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = TetrahedralForm::value(points[i]);
}

Vec3 TetrahedralForm::gradient(const Vec3& p) const {
  const Index t = locate(p);
  if (t == kNone) return Vec3::Zero();
  const TetrahedronFrame frame(mesh_, t);
  if (!frame.isFlat()) return frame.gradient();
  // A sliver's own gradient is noise: take its roundest neighbor's.
  Index roundest = t;
  double best = frame.determinant / frame.lengthCubed();
  for (const Index n : mesh_.tetrahedra[static_cast<std::size_t>(t)].neighbors) {
    if (n == kNone) continue;
    const TetrahedronFrame other(mesh_, n);
    const double roundness = other.determinant / other.lengthCubed();
    if (roundness > best) {
      best = roundness;
      roundest = n;
    }
  }
  const Vec3 gradient = TetrahedronFrame(mesh_, roundest).gradient();
  return gradient.allFinite() ? gradient : Vec3(Vec3::Zero());
}

void TetrahedralForm::buildClearanceGrid(const RunContext& context) {
  if (bounds_.isEmpty()) return;
  auto grid = std::make_unique<ClearanceGrid>(bounds_, gridResolution_);
  const auto tetrahedra = static_cast<Index>(mesh_.tetrahedra.size());
  for (Index t = 0; t < tetrahedra; ++t) {
    const TetrahedronFrame frame(mesh_, t);
    const NegativePart part(frame);
    if (part.negatives == 0) continue;
    if (part.isMixed()) {
      if (frame.isFlat()) {
        grid->mark(boxOf(frame), Vec3::Zero(), Vec3::Zero());
      } else {
        grid->mark(part.zeros, part.anyZero, frame.gradient());
      }
    }
    // Where f is negative at the hull it jumps to a positive constant.
    const FormTetrahedron& tetrahedron = mesh_.tetrahedra[static_cast<std::size_t>(t)];
    for (std::size_t face = 0; face < 4; ++face) {
      if (tetrahedron.neighbors[face] != kNone) continue;
      Box3 box;
      bool negative = false;
      for (std::size_t i = 0; i < 4; ++i) {
        if (i == face) continue;
        box.extend(frame.vertex[i]->position);
        negative = negative || frame.vertex[i]->value < 0;
      }
      if (!negative) continue;
      const Vec3& a = frame.vertex[(face + 1) % 4]->position;
      const Vec3& b = frame.vertex[(face + 2) % 4]->position;
      const Vec3& c = frame.vertex[(face + 3) % 4]->position;
      const Vec3 normal = (b - a).cross(c - a);
      const bool needle = !(normal.squaredNorm() > 1e-12 * (b - a).squaredNorm() * (c - a).squaredNorm());
      grid->mark(box, a, needle ? Vec3(Vec3::Zero()) : normal);
    }
  }
  context.throwIfCancelled();
  grid->finish([this](const Vec3& p) { return value(p) < 0; }, context);
  clearanceGrid_ = std::move(grid);
}

double TetrahedralForm::clearance(const Vec3& p) const { return clearanceGrid_ ? clearanceGrid_->clearance(p) : 0.0; }

}  // namespace voroform::implicit
