#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "site_candidates.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/initial_sites.hpp"

namespace voroform::cvt {

namespace {

template <int M>
using Mat = Eigen::Matrix<double, M, M>;

// Placements tried: as many as their sites, and a part of the points counted for them, come to this number, within
// limits. In space an evaluation of the energy costs several times as much.
template <int M>
constexpr double kPlacedSites = M == 2 ? 1'000'000 : 200'000;
constexpr double kCountedPart = 0.125;
constexpr std::size_t kFewestPlacements = 4;
constexpr std::size_t kMostPlacements = 96;
// The first guess of the spacing errs by less than this; steps by which that is widened, and narrowed again.
constexpr double kSpacingError = 0.03;
constexpr double kWidening = 0.1;
constexpr int kWidenings = 6;
constexpr int kNarrowings = 48;
// Ranges of exact spacings below this share of the error are not looked for.
constexpr double kLeastRange = 0.05;
// Near the axes' directions: tilts up to this angle, in radians.
constexpr double kSmallTilt = 0.03;

// Columns are the lattice's basis; a cell has the volume 1. In the plane rows run along x.
template <int M>
Mat<M> latticeBasis() {
  Mat<M> basis;
  if constexpr (M == 2) {
    const double a = std::sqrt(2 / std::numbers::sqrt3);
    basis << a, a / 2, 0, a * std::numbers::sqrt3 / 2;
  } else {
    const double edge = std::cbrt(2.0);
    basis << edge, 0, edge / 2, 0, edge, edge / 2, 0, 0, edge / 2;
  }
  return basis;
}

// How the lattice lies around the center of the domain's bounds, up to its spacing.
template <int M>
struct Placement {
  Mat<M> rotation = Mat<M>::Identity();
  Vec<M> offset = Vec<M>::Zero();  // of the center, in units of the basis
};

Mat<2> rotationOf(double angle) { return Eigen::Rotation2Dd(angle).toRotationMatrix(); }

// Dense rows or layers along the axes of the bounds, points symmetric about their center or nearly so. Boundaries are
// often parallel to the axes.
std::vector<Placement<2>> alignedPlacements(Placement<2> /*dimension*/) {
  std::vector<Placement<2>> placements;
  for (const double angle : {0.0, std::numbers::pi / 2}) {
    for (const double row : {0.0, 0.5}) {
      for (const double along : {0.0, 0.25, 0.5, 0.75}) placements.push_back({rotationOf(angle), {along, row}});
    }
  }
  return placements;
}

std::vector<Placement<3>> alignedPlacements(Placement<3> /*dimension*/) {
  const auto rotation = [](double angle, Index axis) -> Mat3 {
    return Eigen::AngleAxisd(angle, Vec3::Unit(axis)).toRotationMatrix();
  };
  std::vector<Placement<3>> placements;
  for (const Mat3& turn : {Mat3(Mat3::Identity()), rotation(std::numbers::pi / 4, 2), rotation(std::numbers::pi / 4, 0),
                           rotation(std::numbers::pi / 4, 1)}) {
    // A site, halfway between sites of the first and of the second order, and the corner of a cell.
    for (const Vec3& offset : {Vec3(0, 0, 0), Vec3(0, 0, 0.5), Vec3(0.5, 0, 0), Vec3(0.5, 0.25, 0)}) {
      placements.push_back({turn, offset});
    }
  }
  return placements;
}

Mat<2> randomTurn(std::uint64_t seed, Placement<2> /*dimension*/) {
  return rotationOf(2 * std::numbers::pi * randomUnit(seed, RandomStream::orientation, 0));
}
Mat3 randomTurn(std::uint64_t seed, Placement<3> /*dimension*/) { return randomRotation(seed); }

Mat<2> smallTurn(double angle, const Vec2& /*axis*/) { return rotationOf(angle); }
Mat3 smallTurn(double angle, const Vec3& axis) {
  return Eigen::AngleAxisd(angle, axis.stableNormalized()).toRotationMatrix();
}

// In turn: aligned with the axes, nearly so, and anyhow.
template <int M>
Placement<M> placement(std::uint64_t seed, std::size_t k) {
  static const std::vector<Placement<M>> aligned = alignedPlacements(Placement<M>{});
  Placement<M> result;
  if (k % 3 < 2 && k / 3 < aligned.size()) result = aligned[k / 3];
  if (k % 3 == 0 && k / 3 < aligned.size()) return result;
  const Box<M> unit(Vec<M>::Zero(), Vec<M>::Ones());
  const Box<M> cube(-Vec<M>::Ones(), Vec<M>::Ones());
  result.offset = randomInBox(seed, RandomStream::lattice, k, unit);
  const std::uint64_t turnSeed = randomBits(seed, RandomStream::latticeTurn, k);
  if (k % 3 == 1) {
    const double angle = kSmallTilt * (2 * randomUnit(turnSeed, RandomStream::latticeTurn, 0) - 1);
    const Vec<M> axis = randomInBox(turnSeed, RandomStream::orientation, 0, cube);
    result.rotation = smallTurn(angle, axis) * result.rotation;
  } else {
    result.rotation = randomTurn(turnSeed, Placement<M>{});
  }
  return result;
}

// Points about the origin, for spacing 1: those of the lattice that a box of these half sizes holds.
template <int M>
std::vector<Vec<M>> latticePoints(const Placement<M>& placement, const Vec<M>& halfSizes) {
  const Mat<M> basis = placement.rotation * latticeBasis<M>();
  // The coordinates c of p = basis·c in the box: |cᵢ| ≤ Σⱼ |basis⁻¹ᵢⱼ|·halfSizesⱼ.
  const Vec<M> reach = basis.inverse().cwiseAbs() * halfSizes + Vec<M>::Ones();
  const Eigen::Matrix<Index, M, 1> most = reach.template cast<Index>();
  const Box<M> box(-halfSizes, halfSizes);
  std::vector<Vec<M>> points;
  Eigen::Matrix<Index, M, 1> c = -most;
  while (true) {
    const Vec<M> p = basis * (c.template cast<double>() + placement.offset);
    if (box.contains(p)) points.push_back(p);
    Index axis = 0;
    while (axis < M && c[axis] == most[axis]) {
      c[axis] = -most[axis];
      ++axis;
    }
    if (axis == M) return points;
    ++c[axis];
  }
}

// A placed lattice and the spacing that puts the wanted number of its points inside, or nearly so.
template <int M>
class PlacedLattice {
 public:
  PlacedLattice(const Domain<M>& domain, double spacing, std::size_t count, const Placement<M>& placement,
                const RunContext& context)
      : domain_(domain), placement_(placement), context_(context), count_(static_cast<std::ptrdiff_t>(count)) {
    search(spacing);
  }

  // Points inside beyond the wanted number.
  std::ptrdiff_t excess() const { return bestExcess_; }

  std::vector<Vec<M>> sites() {
    cover(best_);
    return pointsInside(
        domain_, points_.size(), [&](std::size_t i) { return at(i, best_); }, context_);
  }

 private:
  Vec<M> at(std::size_t i, double spacing) const { return domain_.bounds().center() + spacing * points_[i]; }

  // Sees to the points that fill the bounds at this spacing and at all larger ones.
  void cover(double spacing) {
    if (spacing >= leastSpacing_) return;
    leastSpacing_ = spacing;
    points_ = latticePoints<M>(placement_, domain_.bounds().sizes() / (2 * spacing));
  }

  std::ptrdiff_t excessAt(double spacing) {
    cover(spacing);
    const std::size_t inside = countInside(
        domain_, points_.size(), [&](std::size_t i) { return at(i, spacing); }, context_);
    const std::ptrdiff_t excess = static_cast<std::ptrdiff_t>(inside) - count_;
    if (std::abs(excess) < std::abs(bestExcess_)) {
      bestExcess_ = excess;
      best_ = spacing;
    }
    return excess;
  }

  // As the spacing grows, points leave the domain one by one, unless the placement has symmetries of the domain's.
  void search(double guess) {
    double dense = guess * (1 - kSpacingError);
    double loose = guess * (1 + kSpacingError);
    std::ptrdiff_t more = excessAt(dense);
    std::ptrdiff_t fewer = excessAt(loose);
    for (int step = 0; step < kWidenings && more < 0; ++step) more = excessAt(dense *= 1 - kWidening);
    for (int step = 0; step < kWidenings && fewer > 0; ++step) fewer = excessAt(loose *= 1 + kWidening);
    for (int step = 0; step < kNarrowings && more > 0 && fewer < 0 && bestExcess_ != 0; ++step) {
      // Where a straight line through both counts has the wanted one; every other time halfway, lest one end stay.
      const double share = step % 2 != 0 ? 0.5 : static_cast<double>(more) / static_cast<double>(more - fewer);
      const double between = dense + share * (loose - dense);
      const std::ptrdiff_t excess = excessAt(between);
      (excess > 0 ? dense : loose) = between;
      (excess > 0 ? more : fewer) = excess;
    }
    if (bestExcess_ == 0) best_ = 0.5 * (lastExact(best_, 1 - kSpacingError) + lastExact(best_, 1 + kSpacingError));
  }

  // With symmetries a range of spacings has the same number inside: about where it ends, on the way from an exact
  // spacing to a multiple of it.
  double lastExact(double exact, double factor) {
    if (excessAt(exact * (1 + kLeastRange * (factor - 1))) != 0) return exact;
    double other = exact * factor;
    for (int step = 0; step < 8; ++step) {
      const double middle = 0.5 * (exact + other);
      (excessAt(middle) == 0 ? exact : other) = middle;
    }
    return exact;
  }

  const Domain<M>& domain_;
  const Placement<M>& placement_;
  const RunContext& context_;
  std::ptrdiff_t count_;
  std::vector<Vec<M>> points_;
  double leastSpacing_ = std::numeric_limits<double>::infinity();
  double best_ = 0;
  std::ptrdiff_t bestExcess_ = std::numeric_limits<std::ptrdiff_t>::max();
};

// The energy of the sites moved to the centroids of their cells, the cells unchanged: closer to what the optimization
// will make of them than their own. Relative to the volume that the cells fill, as caps may miss thin parts.
template <int M>
double centroidalEnergy(const Evaluation<M>& evaluation) {
  double energy = evaluation.energy;
  for (const voronoi::Moments<M>& cell : evaluation.moments) {
    if (cell.mass > 0) energy -= cell.first.squaredNorm() / cell.mass;
  }
  return energy / optimalEnergy<M>(static_cast<Index>(evaluation.moments.size()), evaluation.volume);
}

}  // namespace

template <int M>
std::vector<Vec<M>> latticeSites(const Domain<M>& domain, Index count, std::uint64_t seed, const RunContext& context) {
  const auto wanted = static_cast<std::size_t>(count);
  const double spacing = std::pow(domain.volume() / static_cast<double>(count), 1.0 / M);
  const double points = domain.bounds().volume() / std::pow(spacing, M);
  if (!(points < static_cast<double>(mostCandidates(wanted)))) {
    throw MethodError("a lattice with " + std::to_string(count) + " points inside would have more than " +
                      std::to_string(mostCandidates(wanted)) + " in the form's bounds: the solid is empty or too thin");
  }
  const auto placements = std::clamp(static_cast<std::size_t>(kPlacedSites<M> / (count + kCountedPart * points)),
                                     kFewestPlacements, kMostPlacements);
  std::vector<Vec<M>> best;
  std::size_t leastMiss = std::numeric_limits<std::size_t>::max();
  double leastEnergy = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < placements && (k < kFewestPlacements || !best.empty()); ++k) {
    const Placement<M> placed = placement<M>(seed, k);
    PlacedLattice<M> lattice(domain, spacing, wanted, placed, context);
    const auto miss = static_cast<std::size_t>(std::abs(lattice.excess()));
    if (miss > leastMiss) continue;
    if (miss < leastMiss) leastEnergy = std::numeric_limits<double>::infinity();
    std::vector<Vec<M>> sites = inSpatialOrder<M>(lattice.sites());
    if (sites.empty()) continue;
    leastMiss = miss;
    const double energy = centroidalEnergy(domain.evaluate(sites, context));
    if (energy < leastEnergy) {
      leastEnergy = energy;
      best = std::move(sites);
    }
  }
  if (best.empty()) {
    throw MethodError("no lattice has a point inside where " + std::to_string(count) +
                      " are wanted: the solid is empty or too thin; check the form or its envelope");
  }
  return best;
}

template std::vector<Vec2> latticeSites<2>(const Domain<2>&, Index, std::uint64_t, const RunContext&);
template std::vector<Vec3> latticeSites<3>(const Domain<3>&, Index, std::uint64_t, const RunContext&);

}  // namespace voroform::cvt
