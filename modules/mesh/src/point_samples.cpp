#include "point_samples.hpp"

#include <algorithm>
#include <vector>

#include "ray_crossing.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/core/random.hpp"
#include "voroform/mesh/box_tree.hpp"
#include "voroform/mesh/surface_locator.hpp"

namespace voroform::mesh {

namespace {

constexpr std::size_t kGrain = 256;
// How often a point too near to a face is drawn again.
constexpr std::uint64_t kDraws = 16;
// Boxes are grown by this share of their size, so that points fall outside of the solid, too.
constexpr double kMargin = 0.05;

Box3 grown(const Box3& box) {
  const Vec3 margin = kMargin * box.sizes();
  return {box.min() - margin, box.max() + margin};
}

class CellLocator {
 public:
  CellLocator(const PolyhedralComplex& complex, const CellFaces& rows, double tolerance, const RunContext& context)
      : complex_(complex), rows_(rows), tolerance_(tolerance), boxes_(static_cast<std::size_t>(complex.cellCount)) {
    parallelFor(context, boxes_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t cell = begin; cell < end; ++cell) boxes_[cell] = boxOf(cell);
    });
    tree_ = BoxTree(boxes_);
  }

  const std::vector<Box3>& boxes() const { return boxes_; }

  // Number of cells that hold the point; kNone if that is uncertain.
  Index count(const Vec3& point) const {
    Index cells = 0;
    bool uncertain = false;
    const Vec3 margin = Vec3::Constant(tolerance_);
    tree_.forEachOverlap(Box3(point - margin, point + margin), [&](Index cell) {
      if (uncertain) return;
      const Location location = locate(static_cast<std::size_t>(cell), point);
      if (location == Location::uncertain) uncertain = true;
      if (location == Location::inside) ++cells;
    });
    return uncertain ? kNone : cells;
  }

 private:
  const Vec3& vertex(Index v) const { return complex_.vertices[static_cast<std::size_t>(v)]; }

  Box3 boxOf(std::size_t cell) const {
    Box3 box;
    for (auto k = static_cast<std::size_t>(rows_.offsets[cell]); k < static_cast<std::size_t>(rows_.offsets[cell + 1]);
         ++k) {
      for (const Index v : complex_.face(rows_.faces[k])) box.extend(vertex(v));
    }
    return box;
  }

  Location locate(std::size_t cell, const Vec3& point) const {
    bool inside = false;
    for (auto k = static_cast<std::size_t>(rows_.offsets[cell]); k < static_cast<std::size_t>(rows_.offsets[cell + 1]);
         ++k) {
      const auto loop = complex_.face(rows_.faces[k]);
      for (std::size_t i = 2; i < loop.size(); ++i) {
        const Crossing crossing =
            rayCrossing(point, vertex(loop[0]), vertex(loop[i - 1]), vertex(loop[i]), 2, tolerance_);
        if (crossing == Crossing::uncertain) return Location::uncertain;
        if (crossing == Crossing::crossed) inside = !inside;
      }
    }
    return inside ? Location::inside : Location::outside;
  }

  const PolyhedralComplex& complex_;
  const CellFaces& rows_;
  double tolerance_;
  std::vector<Box3> boxes_;
  BoxTree tree_;
};

enum class Verdict : std::uint8_t { undecided, consistent, violation };

}  // namespace

PointSamples locateSamples(const PolyhedralComplex& complex, const CellFaces& rows, const TriangleMesh& boundary,
                           Index samples, std::uint64_t seed, const RunContext& context) {
  Box3 box;
  for (const Index v : complex.faceVertices) box.extend(complex.vertices[static_cast<std::size_t>(v)]);
  if (box.isEmpty() || samples <= 0 || complex.cellCount <= 0) return {};
  const double tolerance = locationTolerance(box);
  const CellLocator cells(complex, rows, tolerance, context);
  const SurfaceLocator surface(boundary, 0, tolerance);
  const Box3 everything = grown(box);

  const auto count = static_cast<std::uint64_t>(samples);
  const auto draw = [&](std::uint64_t key) {
    if (key % 2 == 0) return randomInBox(seed, RandomStream::validation, key, everything);
    // Far from the indices that randomInBox uses for the same key.
    const std::uint64_t bits = randomBits(seed, RandomStream::validation, ~key);
    const Box3& cellBox = cells.boxes()[bits % cells.boxes().size()];
    return randomInBox(seed, RandomStream::validation, key, cellBox.isEmpty() ? everything : grown(cellBox));
  };
  std::vector<Verdict> verdicts(static_cast<std::size_t>(samples), Verdict::undecided);
  parallelFor(context, verdicts.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::uint64_t attempt = 0; attempt < kDraws && verdicts[i] == Verdict::undecided; ++attempt) {
        // An even count keeps a sample's kind when it is drawn again.
        const Vec3 point = draw(i + attempt * (count + count % 2));
        const Index holders = cells.count(point);
        const Location location = surface.locate(point);
        if (holders == kNone || location == Location::uncertain) continue;
        verdicts[i] = holders == (location == Location::inside ? 1 : 0) ? Verdict::consistent : Verdict::violation;
      }
    }
  });
  PointSamples result;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    if (verdicts[i] != Verdict::undecided) ++result.located;
    if (verdicts[i] == Verdict::violation) result.violations.add(static_cast<Index>(i));
  }
  return result;
}

}  // namespace voroform::mesh
