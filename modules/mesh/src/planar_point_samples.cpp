#include "planar_point_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "voroform/core/parallel.hpp"
#include "voroform/core/random.hpp"
#include "voroform/mesh/box_tree.hpp"

namespace voroform::mesh {

namespace {

constexpr std::size_t kGrain = 256;
// How often a point too near to an edge is drawn again.
constexpr std::uint64_t kDraws = 16;
// Boxes are grown by this share of their size, so that points fall outside of the region, too.
constexpr double kMargin = 0.05;
// Points nearer to an edge than this share of the region's diagonal, or almost as near to two sites, are undecided.
constexpr double kTolerance = 1e-10;

Box2 grown(const Box2& box) {
  const Vec2 margin = kMargin * box.sizes();
  return {box.min() - margin, box.max() + margin};
}

Box3 flat(const Box2& box) { return {Vec3(box.min().x(), box.min().y(), 0), Vec3(box.max().x(), box.max().y(), 0)}; }

enum class Verdict : std::uint8_t { undecided, consistent, violation };

class CellLocator {
 public:
  CellLocator(const PlanarTessellation& tessellation, double tolerance)
      : tessellation_(tessellation), tolerance_(tolerance) {
    std::vector<Box3> flatBoxes;
    for (Index cell = 0; cell < tessellation.cellCount(); ++cell) {
      Box2 box;
      forEachEdge(cell, [&](const Vec2& a, const Vec2&, Index) { box.extend(a); });
      boxes_.push_back(box);
      // An empty box would lie everywhere and nowhere.
      flatBoxes.push_back(flat(box.isEmpty() ? Box2(Vec2::Zero(), Vec2::Zero()) : box));
    }
    tree_ = BoxTree(flatBoxes);
  }

  const std::vector<Box2>& boxes() const { return boxes_; }

  Verdict examine(const Vec2& point, bool isInside) const {
    Index holder = kNone;
    bool uncertain = false;
    bool violated = false;
    const Vec2 margin = Vec2::Constant(tolerance_);
    tree_.forEachOverlap(flat(Box2(point - margin, point + margin)), [&](Index cell) {
      const std::optional<int> winding = windingNumber(cell, point);
      if (!winding) uncertain = true;
      if (uncertain || *winding == 0) return;
      if (*winding != 1 || holder != kNone) violated = true;
      holder = cell;
    });
    if (uncertain) return Verdict::undecided;
    if (violated || (holder != kNone) != isInside) return Verdict::violation;
    return holder == kNone ? Verdict::consistent : nearest(holder, point);
  }

 private:
  // Calls visit(from, to, neighbor) for each edge of the cell.
  template <class Visit>
  void forEachEdge(Index cell, const Visit& visit) const {
    for (std::size_t l = tessellation_.firstLoop(cell); l < tessellation_.endLoop(cell); ++l) {
      const auto loop = tessellation_.loop(l);
      const auto neighbors = tessellation_.loopNeighbors(l);
      for (std::size_t k = 0; k < loop.size(); ++k) {
        visit(tessellation_.vertices[static_cast<std::size_t>(loop[k])],
              tessellation_.vertices[static_cast<std::size_t>(loop[(k + 1) % loop.size()])], neighbors[k]);
      }
    }
  }

  // Nothing if the point is too near to an edge.
  std::optional<int> windingNumber(Index cell, const Vec2& point) const {
    int winding = 0;
    bool uncertain = false;
    forEachEdge(cell, [&](const Vec2& a, const Vec2& b, Index) {
      if ((a.y() <= point.y()) == (b.y() <= point.y())) return;
      const Vec2 along = b - a;
      const Vec2 to = point - a;
      const double cross = along.x() * to.y() - along.y() * to.x();
      if (std::abs(cross) <= tolerance_ * along.norm()) uncertain = true;
      if (b.y() > a.y() && cross > 0) ++winding;
      if (b.y() < a.y() && cross < 0) --winding;
    });
    if (uncertain) return std::nullopt;
    return winding;
  }

  Verdict nearest(Index cell, const Vec2& point) const {
    const auto site = [&](Index i) -> const Vec2& { return tessellation_.sites[static_cast<std::size_t>(i)]; };
    const double own = (point - site(cell)).norm();
    Verdict verdict = Verdict::consistent;
    forEachEdge(cell, [&](const Vec2&, const Vec2&, Index neighbor) {
      if (neighbor != kNone && (point - site(neighbor)).norm() < own - tolerance_) verdict = Verdict::violation;
    });
    return verdict;
  }

  const PlanarTessellation& tessellation_;
  double tolerance_;
  std::vector<Box2> boxes_;
  BoxTree tree_;
};

}  // namespace

double coordinateRounding(const PlanarRegion& region) {
  const Box2& box = region.bounds();
  const double largest = std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  return 4 * std::numeric_limits<double>::epsilon() * largest;
}

PlanarPointSamples locateSamples(const PlanarTessellation& tessellation, const PlanarRegion& region, Index samples,
                                 std::uint64_t seed, const RunContext& context) {
  if (samples <= 0 || tessellation.cellCount() == 0) return {};
  const double tolerance = kTolerance * region.bounds().diagonal().norm() + coordinateRounding(region);
  const CellLocator cells(tessellation, tolerance);
  const Box2 everything = grown(region.bounds());

  const auto count = static_cast<std::uint64_t>(samples);
  const auto draw = [&](std::uint64_t key) {
    if (key % 2 == 0) return randomInBox(seed, RandomStream::validation, key, everything);
    // Far from the indices that randomInBox uses for the same key.
    const std::uint64_t bits = randomBits(seed, RandomStream::validation, ~key);
    const Box2& cellBox = cells.boxes()[bits % cells.boxes().size()];
    return randomInBox(seed, RandomStream::validation, key, cellBox.isEmpty() ? everything : grown(cellBox));
  };
  std::vector<Verdict> verdicts(static_cast<std::size_t>(samples), Verdict::undecided);
  parallelFor(context, verdicts.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      for (std::uint64_t attempt = 0; attempt < kDraws && verdicts[i] == Verdict::undecided; ++attempt) {
        // An even count keeps a sample's kind when it is drawn again.
        const Vec2 point = draw(i + attempt * (count + count % 2));
        const double distance = region.signedDistance(point);
        if (std::abs(distance) > tolerance) verdicts[i] = cells.examine(point, distance < 0);
      }
    }
  });
  PlanarPointSamples result;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    if (verdicts[i] != Verdict::undecided) ++result.located;
    if (verdicts[i] == Verdict::violation) result.violations.add(static_cast<Index>(i));
  }
  return result;
}

}  // namespace voroform::mesh
