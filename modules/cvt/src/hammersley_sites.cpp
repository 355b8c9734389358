#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>

#include "site_candidates.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/initial_sites.hpp"

namespace voroform::cvt {

namespace {

// Lengths tried with one shift, shifts along the first axis tried at the best of them, halvings between two of those;
// and how often all of it is begun anew with another shift.
constexpr int kLengths = 20;
constexpr int kSlides = 32;
constexpr int kHalvings = 60;
constexpr std::uint64_t kShifts = 8;
// Steps along the first axis from shift to shift: the golden section's, which never come close to each other.
constexpr double kSlideStep = 0.6180339887498949;

// Digits of i mirrored at the point.
template <std::uint64_t Base>
double radicalInverse(std::uint64_t i) {
  double result = 0;
  double digit = 1;
  for (; i != 0; i /= Base) {
    digit /= static_cast<double>(Base);
    result += digit * static_cast<double>(i % Base);
  }
  return result;
}

// A Hammersley sequence in a box, shifted modulo the box (Cranley and Patterson 1976).
template <int M>
struct Sequence {
  Box<M> box;
  Vec<M> shift = Vec<M>::Zero();  // of the unit cube
  std::size_t length = 0;

  Vec<M> operator()(std::size_t i) const {
    Vec<M> unit;
    unit[0] = static_cast<double>(i) / static_cast<double>(length);
    unit[1] = radicalInverse<2>(i);
    if constexpr (M == 3) unit[2] = radicalInverse<3>(i);
    unit += shift;
    return box.min() + (unit - unit.array().floor().matrix()).cwiseProduct(box.sizes());
  }
};

// Thins the sequence to the density of sites, by the next base's digits, so that what is left stays even.
template <int M>
struct Thinning {
  const Domain<M>& domain;
  bool operator()(std::size_t i, const Vec<M>& p) const {
    constexpr std::uint64_t kBase = M == 2 ? 3 : 5;
    return radicalInverse<kBase>(i) < domain.siteDensity(p);
  }
};

template <int M>
std::vector<Vec<M>> pointsOf(const Sequence<M>& sequence, const Domain<M>& domain, const RunContext& context) {
  return pointsInside(domain, sequence.length, sequence, context, Thinning<M>{domain});
}

template <int M>
Sequence<M> firstSequence(const Domain<M>& domain, std::size_t count, std::uint64_t seed, std::uint64_t shift) {
  Sequence<M> sequence;
  sequence.box = domain.bounds();
  for (Index axis = 0; axis < M; ++axis) {
    sequence.shift[axis] = randomUnit(seed, RandomStream::hammersley, M * shift + static_cast<std::uint64_t>(axis));
  }
  const double length = static_cast<double>(count) * sequence.box.volume() / domain.volume();
  sequence.length = static_cast<std::size_t>(std::clamp(length, 1.0, static_cast<double>(mostCandidates(count))));
  return sequence;
}

template <int M>
class Search {
 public:
  Search(const Domain<M>& domain, std::size_t count, const RunContext& context)
      : domain_(domain), count_(count), context_(context) {}

  // The sequence with the length and the shift along the first axis that put exactly the wanted number inside.
  std::optional<Sequence<M>> run(const Sequence<M>& first) const {
    const Sequence<M> best = bestLength(first);
    return excess(best) == 0 ? best : slide(best);
  }

 private:
  // Points inside beyond the wanted number.
  std::ptrdiff_t excess(const Sequence<M>& sequence) const {
    const std::size_t inside = countInside(domain_, sequence.length, sequence, context_, Thinning<M>{domain_});
    return static_cast<std::ptrdiff_t>(inside) - static_cast<std::ptrdiff_t>(count_);
  }

  // The number inside scatters about length·V/|box| and does not grow steadily with the length. Each step goes where
  // the share found inside so far promises the wanted number.
  Sequence<M> bestLength(Sequence<M> sequence) const {
    Sequence<M> best = sequence;
    std::ptrdiff_t leastExcess = 0;
    for (int step = 0; step < kLengths; ++step) {
      const std::ptrdiff_t found = excess(sequence);
      if (step == 0 || std::abs(found) < std::abs(leastExcess)) {
        best = sequence;
        leastExcess = found;
      }
      if (found == 0) break;
      const auto inside = static_cast<std::size_t>(found + static_cast<std::ptrdiff_t>(count_));
      const double perPoint = static_cast<double>(sequence.length) / std::max(0.25, static_cast<double>(inside));
      const double next = static_cast<double>(sequence.length) - perPoint * static_cast<double>(found);
      if (next > static_cast<double>(mostCandidates(count_))) throwTooThin(sequence.length, inside, count_);
      sequence.length = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(next)));
    }
    return best;
  }

  // While the sequence slides along the first axis, points cross the boundary one by one, as no two have a coordinate
  // in common: between a shift with too many points inside and one with too few there is one with the wanted number.
  std::optional<Sequence<M>> slide(const Sequence<M>& start) const {
    std::optional<Sequence<M>> more;
    std::optional<Sequence<M>> fewer;
    Sequence<M> sequence = start;
    for (int step = 0; step < kSlides && !(more && fewer); ++step) {
      const std::ptrdiff_t found = excess(sequence);
      if (found == 0) return sequence;
      (found > 0 ? more : fewer) = sequence;
      sequence.shift[0] = start.shift[0] + kSlideStep * (step + 1);
      sequence.shift[0] -= std::floor(sequence.shift[0]);
    }
    if (!more || !fewer) return std::nullopt;
    for (int step = 0; step < kHalvings; ++step) {
      sequence.shift[0] = 0.5 * (more->shift[0] + fewer->shift[0]);
      const std::ptrdiff_t found = excess(sequence);
      if (found == 0) return sequence;
      (found > 0 ? more : fewer) = sequence;
    }
    return std::nullopt;
  }

  const Domain<M>& domain_;
  std::size_t count_;
  const RunContext& context_;
};

}  // namespace

template <int M>
std::vector<Vec<M>> hammersleyPointsInside(const Domain<M>& domain, std::size_t count, std::uint64_t seed,
                                           const RunContext& context) {
  Sequence<M> sequence = firstSequence(domain, count, seed, 0);
  while (true) {
    std::vector<Vec<M>> inside = pointsInside(domain, sequence.length, sequence, context);
    if (2 * inside.size() >= count) return inside;
    if (4 * sequence.length > mostCandidates(count)) throwTooThin(sequence.length, inside.size(), count);
    sequence.length *= 4;
  }
}

template <int M>
std::vector<Vec<M>> hammersleySites(const Domain<M>& domain, Index count, std::uint64_t seed,
                                    const RunContext& context) {
  const auto wanted = static_cast<std::size_t>(count);
  const Search<M> search(domain, wanted, context);
  for (std::uint64_t shift = 0; shift < kShifts; ++shift) {
    const std::optional<Sequence<M>> found = search.run(firstSequence(domain, wanted, seed, shift));
    if (found) return inSpatialOrder<M>(pointsOf(*found, domain, context));
  }
  throw MethodError("no Hammersley sequence with exactly " + std::to_string(count) +
                    " points inside was found; take another number of sites or another kind of initial sites");
}

template std::vector<Vec2> hammersleyPointsInside<2>(const Domain<2>&, std::size_t, std::uint64_t, const RunContext&);
template std::vector<Vec3> hammersleyPointsInside<3>(const Domain<3>&, std::size_t, std::uint64_t, const RunContext&);
template std::vector<Vec2> hammersleySites<2>(const Domain<2>&, Index, std::uint64_t, const RunContext&);
template std::vector<Vec3> hammersleySites<3>(const Domain<3>&, Index, std::uint64_t, const RunContext&);

}  // namespace voroform::cvt
