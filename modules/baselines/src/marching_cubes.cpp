#include "voroform/baselines/marching_cubes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "cube_patch.hpp"
#include "cube_topology.hpp"
#include "lattice.hpp"
#include "sparse_rows.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::baselines {

namespace {

// A vertex keeps this share of its edge clear of either end, so that no face degenerates.
constexpr double kEndClearance = 1e-6;
// Rows of cubes that one task emits.
constexpr std::size_t kRowGrain = 32;

void requireUsable(const CubeGrid& grid, const MarchingCubesOptions& options) {
  if (!(grid.edge > 0) || !std::isfinite(grid.edge) || !grid.origin.allFinite()) {
    throw UsageError("grid: the edge must be > 0 and finite, and the origin finite");
  }
  double corners = 1;
  for (const Index count : grid.cubes) {
    if (count < 1)
      throw UsageError("grid: at least one cube along each axis is needed, found " + std::to_string(count));
    corners *= static_cast<double>(count) + 1;
  }
  // Numbers of vertices and rows' keys must fit an index.
  if (corners > 0.5 * std::numeric_limits<Index>::max()) {
    throw UsageError("grid: too many cubes (" + std::to_string(grid.cubes[0]) + " × " + std::to_string(grid.cubes[1]) +
                     " × " + std::to_string(grid.cubes[2]) + ")");
  }
  if (!(options.rootTolerance > 0 && options.rootTolerance < 1)) {
    throw UsageError("rootTolerance: must lie in (0, 1), found " + std::to_string(options.rootTolerance));
  }
}

// The values at the corners, and the numbers of what the complex is made of: inside corners, cut edges, cells.
class Grid {
 public:
  Grid(const implicit::ImplicitFunction& f, const CubeGrid& cubes, const RunContext& context, std::int64_t& evaluations)
      : lattice_{cubes.origin, cubes.edge, {cubes.cubes[0] + 1, cubes.cubes[1] + 1, cubes.cubes[2] + 1}},
        cubes_(cubes.cubes),
        // A corner farther from S than a cube's diagonal belongs to no cube that S cuts: its sign suffices.
        values_(latticeValues(f, lattice_, std::sqrt(3.0) * cubes.edge, context, evaluations)),
        corners_(context, rowsOfCorners(), [&](std::size_t row, const auto& emit) { enumerateCorners(row, emit); }),
        edges_(context, rowsOfCorners(), [&](std::size_t row, const auto& emit) { enumerateEdges(row, emit); }),
        cells_(context, rowsOfCubes(), [&](std::size_t row, const auto& emit) { enumerateCells(row, emit); }) {}

  const Lattice& lattice() const { return lattice_; }
  const SparseRows& corners() const { return corners_; }
  const SparseRows& edges() const { return edges_; }
  const SparseRows& cells() const { return cells_; }

  // (j, k) of a row of corners, or of a row of cubes.
  std::array<Index, 2> placeOfCornerRow(std::size_t row) const { return place(row, lattice_.counts[1]); }
  std::array<Index, 2> placeOfCubeRow(std::size_t row) const { return place(row, cubes_[1]); }

  std::array<double, 8> valuesOf(Index i, Index j, Index k) const {
    std::array<double, 8> values{};
    for (std::size_t c = 0; c < 8; ++c) values[c] = value(i + (c & 1U), j + (c >> 1 & 1U), k + (c >> 2));
    return values;
  }
  double value(std::size_t i, std::size_t j, std::size_t k) const {
    return values_[lattice_.number(static_cast<Index>(i), static_cast<Index>(j), static_cast<Index>(k))];
  }

  Index cornerNumber(Index i, Index j, Index k) const { return corners_.find(cornerRow(j, k), i); }
  Index edgeNumber(Index i, Index j, Index k, int axis) const { return edges_.find(cornerRow(j, k), 3 * i + axis); }
  Index cellNumber(Index i, Index j, Index k) const { return cells_.find(cubeRow(j, k), i); }

  // The first corner on the grid's border that is inside, if there is one.
  void requireOutsideBorder() const {
    for (std::size_t row = 0; row < rowsOfCorners(); ++row) {
      const auto [j, k] = placeOfCornerRow(row);
      const bool borderRow = j == 0 || k == 0 || j + 1 == lattice_.counts[1] || k + 1 == lattice_.counts[2];
      for (std::int64_t n = corners_.begin(row); n < corners_.end(row); ++n) {
        const Index i = corners_.key(n);
        if (!borderRow && i != 0 && i + 1 != lattice_.counts[0]) continue;
        throw UsageError("grid: its border must lie outside the solid, but corner (" + std::to_string(i) + ", " +
                         std::to_string(j) + ", " + std::to_string(k) + ") is inside");
      }
    }
  }

 private:
  static std::array<Index, 2> place(std::size_t row, Index width) {
    const auto w = static_cast<std::size_t>(width);
    return {static_cast<Index>(row % w), static_cast<Index>(row / w)};
  }
  std::size_t rowsOfCorners() const {
    return static_cast<std::size_t>(lattice_.counts[1]) * static_cast<std::size_t>(lattice_.counts[2]);
  }
  std::size_t rowsOfCubes() const { return static_cast<std::size_t>(cubes_[1]) * static_cast<std::size_t>(cubes_[2]); }
  std::size_t cornerRow(Index j, Index k) const {
    return static_cast<std::size_t>(k) * static_cast<std::size_t>(lattice_.counts[1]) + static_cast<std::size_t>(j);
  }
  std::size_t cubeRow(Index j, Index k) const {
    return static_cast<std::size_t>(k) * static_cast<std::size_t>(cubes_[1]) + static_cast<std::size_t>(j);
  }
  const double* rowValues(Index j, Index k) const { return values_.data() + lattice_.number(0, j, k); }

  template <class Emit>
  void enumerateCorners(std::size_t row, const Emit& emit) const {
    const auto [j, k] = placeOfCornerRow(row);
    const double* values = rowValues(j, k);
    for (Index i = 0; i < lattice_.counts[0]; ++i) {
      if (values[i] < 0) emit(i);
    }
  }

  template <class Emit>
  void enumerateEdges(std::size_t row, const Emit& emit) const {
    const auto [j, k] = placeOfCornerRow(row);
    const double* values = rowValues(j, k);
    const double* nextY = j + 1 < lattice_.counts[1] ? rowValues(j + 1, k) : values;
    const double* nextZ = k + 1 < lattice_.counts[2] ? rowValues(j, k + 1) : values;
    for (Index i = 0; i < lattice_.counts[0]; ++i) {
      const bool inside = values[i] < 0;
      if (i + 1 < lattice_.counts[0] && inside != (values[i + 1] < 0)) emit(3 * i);
      if (inside != (nextY[i] < 0)) emit(3 * i + 1);
      if (inside != (nextZ[i] < 0)) emit(3 * i + 2);
    }
  }

  template <class Emit>
  void enumerateCells(std::size_t row, const Emit& emit) const {
    const auto [j, k] = placeOfCubeRow(row);
    const double* rows[] = {rowValues(j, k), rowValues(j + 1, k), rowValues(j, k + 1), rowValues(j + 1, k + 1)};
    const auto anyInside = [&](Index i) {
      return rows[0][i] < 0 || rows[1][i] < 0 || rows[2][i] < 0 || rows[3][i] < 0;
    };
    bool before = anyInside(0);
    for (Index i = 0; i < cubes_[0]; ++i) {
      const bool after = anyInside(i + 1);
      if (before || after) emit(i);
      before = after;
    }
  }

  Lattice lattice_;
  std::array<Index, 3> cubes_;
  std::vector<double> values_;
  SparseRows corners_;
  SparseRows edges_;
  SparseRows cells_;
};

struct Vertices {
  std::vector<Vec3> positions;         // inside corners, then cut edges
  std::vector<double> edgeParameters;  // by cut edge: the place of its vertex
};

Vertices placeVertices(const implicit::ImplicitFunction& f, const Grid& grid, const MarchingCubesOptions& options,
                       const RunContext& context, std::int64_t& evaluations) {
  Vertices vertices;
  const auto cornerCount = static_cast<std::size_t>(grid.corners().size());
  vertices.positions.resize(cornerCount + static_cast<std::size_t>(grid.edges().size()));
  vertices.edgeParameters.resize(static_cast<std::size_t>(grid.edges().size()));
  const auto placeRows = [&](std::size_t begin, std::size_t end, std::int64_t calls) {
    for (std::size_t row = begin; row < end; ++row) {
      const auto [j, k] = grid.placeOfCornerRow(row);
      for (std::int64_t n = grid.corners().begin(row); n < grid.corners().end(row); ++n) {
        vertices.positions[static_cast<std::size_t>(n)] = grid.lattice().point(grid.corners().key(n), j, k);
      }
      for (std::int64_t n = grid.edges().begin(row); n < grid.edges().end(row); ++n) {
        const Index i = grid.edges().key(n) / 3;
        std::array<Index, 3> upper = {i, j, k};
        ++upper[static_cast<std::size_t>(grid.edges().key(n) % 3)];
        const Vec3 a = grid.lattice().point(i, j, k);
        const Vec3 b = grid.lattice().point(upper[0], upper[1], upper[2]);
        const auto valueAt = [&](const std::array<Index, 3>& p) {
          return grid.value(static_cast<std::size_t>(p[0]), static_cast<std::size_t>(p[1]),
                            static_cast<std::size_t>(p[2]));
        };
        const double root = implicit::findRoot(f, a, b, valueAt({i, j, k}), valueAt(upper), options.rootTolerance,
                                               options.rootFinder, calls);
        const double t = std::clamp(root, kEndClearance, 1 - kEndClearance);
        vertices.edgeParameters[static_cast<std::size_t>(n)] = t;
        vertices.positions[cornerCount + static_cast<std::size_t>(n)] = a + t * (b - a);
      }
    }
    return calls;
  };
  evaluations +=
      parallelReduce(context, grid.corners().rowCount(), kRowGrain, std::int64_t{0}, placeRows, std::plus<>());
  return vertices;
}

// What one task emits. Vertices in the interior of cubes are numbered −1, −2, … until all tasks are done.
struct Chunk {
  mesh::PolyhedralComplex part;
  MarchingCubesSummary summary;
};

class CubeEmitter {
 public:
  CubeEmitter(const implicit::ImplicitFunction& f, const Grid& grid, const Vertices& vertices, Chunk& chunk)
      : f_(f), grid_(grid), vertices_(vertices), chunk_(chunk) {}

  void emit(Index i, Index j, Index k, Index cell) {
    place_ = {i, j, k};
    cell_ = cell;
    const std::array<double, 8> values = grid_.valuesOf(i, j, k);
    cube_ = {};
    unsigned inside = 0;
    for (std::size_t c = 0; c < 8; ++c) inside |= static_cast<unsigned>(values[c] < 0) << c;
    cut_ = inside != 0xFFU;
    if (cut_) {
      requireFinite(values);
      cube_ = analyzeCube(values);
      count();
    }
    cube_.insideCorners = static_cast<std::uint8_t>(inside);
    for (std::size_t axis = 0; axis < 3; ++axis) emitFace(2 * axis);
    if (cut_) emitPatch();
  }

 private:
  void requireFinite(const std::array<double, 8>& values) const {
    if (std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); })) return;
    throw MethodError("the form has no finite value at a corner of cube (" + std::to_string(place_[0]) + ", " +
                      std::to_string(place_[1]) + ", " + std::to_string(place_[2]) +
                      "), which its surface cuts: its inside oracle contradicts it, or its values overflow");
  }

  void count() {
    MarchingCubesSummary& summary = chunk_.summary;
    ++summary.cutCells;
    summary.disconnectedCells += cube_.insideParts > 1 ? 1 : 0;
    summary.tunnelledCells += cube_.hasTunnel() ? 1 : 0;
    ++summary.cases[static_cast<std::size_t>(baseCase(cube_.insideCorners))];
    // Each face belongs to two cubes: the one after it counts it.
    for (std::size_t face = 0; face < 6; face += 2) summary.ambiguousFaces += cube_.ambiguousFaces >> face & 1;
  }

  Index cornerVertex(int c) const {
    return grid_.cornerNumber(place_[0] + (c & 1), place_[1] + (c >> 1 & 1), place_[2] + (c >> 2));
  }
  Index edgeNumber(int edge) const {
    const int c = lowerCorner(edge);
    return grid_.edgeNumber(place_[0] + (c & 1), place_[1] + (c >> 1 & 1), place_[2] + (c >> 2), edge / 4);
  }
  Index edgeVertex(int edge) const { return static_cast<Index>(grid_.corners().size()) + edgeNumber(edge); }

  // The inside part of a lower face of the cube, shared with the cube below it.
  void emitFace(std::size_t face) {
    const auto& ring = kFaceCorners[face];
    const auto inside = [&](std::size_t s) { return (cube_.insideCorners >> ring[s % 4] & 1) != 0; };
    std::array<Index, 3> below = place_;
    Index neighbor = kNone;
    const bool joined = (cube_.joinedFaces >> face & 1) != 0;
    const bool apart = (cube_.ambiguousFaces >> face & 1) != 0 && !joined;
    loop_.clear();
    for (std::size_t s = 0; s < 4; ++s) {
      if (inside(s)) {
        loop_.push_back(cornerVertex(ring[s]));
        if (neighbor == kNone) {
          --below[face / 2];
          neighbor = grid_.cellNumber(below[0], below[1], below[2]);
        }
      }
      if (inside(s) != inside(s + 1)) loop_.push_back(edgeVertex(edgeBetween(ring[s], ring[(s + 1) % 4])));
    }
    if (loop_.empty()) return;
    if (!apart) {
      chunk_.part.addFace(loop_, cell_, neighbor);
      return;
    }
    // Two corners, each between the vertices before and after it.
    const std::size_t first = inside(0) ? 0 : 1;
    for (const std::size_t corner : {first, first + 3}) {
      chunk_.part.addFace(std::array{loop_[(corner + 5) % 6], loop_[corner], loop_[corner + 1]}, cell_, neighbor);
    }
  }

  void emitPatch() {
    std::array<double, 12> parameters{};
    std::array<Index, 12> vertexOfEdge{};
    for (std::size_t n = 0; n < cube_.loopOffsets[cube_.loopCount]; ++n) {
      const std::uint8_t edge = cube_.loopEdges[n];
      const Index number = edgeNumber(edge);
      parameters[edge] = vertices_.edgeParameters[static_cast<std::size_t>(number)];
      vertexOfEdge[edge] = static_cast<Index>(grid_.corners().size()) + number;
    }
    triangulateCut(cube_, parameters, patch_);

    std::vector<Vec3>& centers = chunk_.part.vertices;
    const auto firstCenter = static_cast<Index>(centers.size());
    const Lattice& lattice = grid_.lattice();
    for (const Vec3& center : patch_.interior) {
      centers.push_back(lattice.point(place_[0], place_[1], place_[2]) + lattice.spacing * center);
    }
    for (const auto& triangle : patch_.triangles) {
      std::array<Index, 3> corners{};
      Vec3 centroid = Vec3::Zero();
      for (std::size_t c = 0; c < 3; ++c) {
        const bool onEdge = triangle[c] < 12;
        const Index center = onEdge ? 0 : firstCenter + triangle[c] - 12;
        corners[c] = onEdge ? vertexOfEdge[triangle[c]] : -1 - center;
        centroid += (onEdge ? vertices_.positions[static_cast<std::size_t>(corners[c])]
                            : centers[static_cast<std::size_t>(center)]) /
                    3;
      }
      const bool envelope = f_.onEnvelope(centroid);
      chunk_.part.addFace(corners, cell_, kNone, envelope ? mesh::FaceTag::envelope : mesh::FaceTag::surface);
    }
  }

  const implicit::ImplicitFunction& f_;
  const Grid& grid_;
  const Vertices& vertices_;
  Chunk& chunk_;
  std::array<Index, 3> place_{};
  Index cell_ = kNone;
  bool cut_ = false;
  CubeTopology cube_;
  CubePatch patch_;
  std::vector<Index> loop_;
};

void add(MarchingCubesSummary& total, const MarchingCubesSummary& part) {
  total.cutCells += part.cutCells;
  total.disconnectedCells += part.disconnectedCells;
  total.tunnelledCells += part.tunnelledCells;
  total.ambiguousFaces += part.ambiguousFaces;
  for (std::size_t c = 0; c < total.cases.size(); ++c) total.cases[c] += part.cases[c];
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

// Joins the chunks in their order; frees each as it goes.
void join(std::vector<Chunk>& chunks, mesh::PolyhedralComplex& complex) {
  std::size_t faces = 0;
  std::size_t corners = 0;
  std::size_t centers = 0;
  for (const Chunk& chunk : chunks) {
    faces += chunk.part.faceCells.size();
    corners += chunk.part.faceVertices.size();
    centers += chunk.part.vertices.size();
  }
  complex.vertices.reserve(complex.vertices.size() + centers);
  complex.faceOffsets.reserve(faces + 1);
  complex.faceVertices.reserve(corners);
  complex.faceCells.reserve(faces);
  complex.faceTags.reserve(faces);
  for (Chunk& chunk : chunks) {
    const mesh::PolyhedralComplex part = std::move(chunk.part);
    const auto firstCenter = static_cast<Index>(complex.vertices.size());
    const auto firstCorner = static_cast<std::int64_t>(complex.faceVertices.size());
    append(complex.vertices, part.vertices);
    for (const Index vertex : part.faceVertices) {
      complex.faceVertices.push_back(vertex >= 0 ? vertex : firstCenter - 1 - vertex);
    }
    for (std::size_t f = 1; f < part.faceOffsets.size(); ++f) {
      complex.faceOffsets.push_back(firstCorner + part.faceOffsets[f]);
    }
    append(complex.faceCells, part.faceCells);
    append(complex.faceTags, part.faceTags);
  }
}

}  // namespace

MarchingCubesResult marchingCubes(const implicit::ImplicitFunction& f, const Frame& frame, const CubeGrid& cubeGrid,
                                  const MarchingCubesOptions& options, const RunContext& context) {
  requireUsable(cubeGrid, options);
  const Stopwatch stopwatch;
  MarchingCubesResult result;
  MarchingCubesSummary& summary = result.summary;
  const Grid grid(f, cubeGrid, context, summary.evaluations);
  grid.requireOutsideBorder();
  context.report("marching cubes", 0.3);
  Vertices vertices = placeVertices(f, grid, options, context, summary.evaluations);
  context.report("marching cubes", 0.5);

  const std::size_t rows = grid.cells().rowCount();
  std::vector<Chunk> chunks((rows + kRowGrain - 1) / kRowGrain);
  parallelFor(context, rows, kRowGrain, [&](std::size_t begin, std::size_t end) {
    CubeEmitter emitter(f, grid, vertices, chunks[begin / kRowGrain]);
    for (std::size_t row = begin; row < end; ++row) {
      const auto [j, k] = grid.placeOfCubeRow(row);
      for (std::int64_t n = grid.cells().begin(row); n < grid.cells().end(row); ++n) {
        emitter.emit(grid.cells().key(n), j, k, static_cast<Index>(n));
      }
    }
  });
  for (const Chunk& chunk : chunks) add(summary, chunk.summary);

  result.complex.frame = frame;
  result.complex.cellCount = static_cast<Index>(grid.cells().size());
  result.complex.vertices = std::move(vertices.positions);
  join(chunks, result.complex);
  context.report("marching cubes", 1);
  summary.seconds = stopwatch.seconds();
  return result;
}

}  // namespace voroform::baselines
