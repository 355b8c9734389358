#include <algorithm>
#include <string>

#include "site_candidates.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::cvt {

namespace {

// Candidates a round, in units of the sites still missing; and the most candidates a site wanted.
constexpr std::size_t kCandidatesPerRound = 4;
constexpr std::size_t kMostCandidates = 20000;

}  // namespace

std::size_t mostCandidates(std::size_t sites) { return kMostCandidates * (sites + 100); }

void throwTooThin(std::size_t tried, std::size_t inside, std::size_t sites) {
  throw MethodError("of " + std::to_string(tried) + " points in the form's bounds only " + std::to_string(inside) +
                    " lie inside, " + std::to_string(sites) +
                    " sites are wanted: the solid is empty or too thin; check the form or its envelope");
}

template <int M>
std::vector<Vec<M>> randomPointsInside(const Domain<M>& domain, std::size_t count, std::uint64_t seed,
                                       const RunContext& context) {
  const Box<M> bounds = domain.bounds();
  std::vector<Vec<M>> points;
  std::size_t tried = 0;
  while (points.size() < count) {
    if (tried >= mostCandidates(count)) throwTooThin(tried, points.size(), count);
    const std::size_t round = std::max<std::size_t>(kCandidateGrain, kCandidatesPerRound * (count - points.size()));
    const std::vector<Vec<M>> inside = pointsInside(
        domain, round, [&](std::size_t i) { return randomInBox(seed, RandomStream::sites, tried + i, bounds); },
        context,
        [&](std::size_t i, const Vec<M>& p) {
          return randomUnit(seed, RandomStream::thinning, tried + i) < domain.siteDensity(p);
        });
    tried += round;
    const std::size_t taken = std::min(inside.size(), count - points.size());
    points.insert(points.end(), inside.begin(), inside.begin() + static_cast<std::ptrdiff_t>(taken));
  }
  return points;
}

template <int M>
std::vector<Vec<M>> inSpatialOrder(const std::vector<Vec<M>>& points) {
  std::vector<Vec3> lifted(points.size(), Vec3::Zero());
  for (std::size_t i = 0; i < points.size(); ++i) lifted[i].template head<M>() = points[i];
  std::vector<Vec<M>> sorted;
  sorted.reserve(points.size());
  for (const Index i : voronoi::spatialOrder(lifted)) sorted.push_back(points[static_cast<std::size_t>(i)]);
  return sorted;
}

template <int M>
std::vector<Vec<M>> randomSites(const Domain<M>& domain, Index count, std::uint64_t seed, const RunContext& context) {
  return inSpatialOrder<M>(randomPointsInside(domain, static_cast<std::size_t>(count), seed, context));
}

template std::vector<Vec2> randomPointsInside<2>(const Domain<2>&, std::size_t, std::uint64_t, const RunContext&);
template std::vector<Vec3> randomPointsInside<3>(const Domain<3>&, std::size_t, std::uint64_t, const RunContext&);
template std::vector<Vec2> inSpatialOrder<2>(const std::vector<Vec2>&);
template std::vector<Vec3> inSpatialOrder<3>(const std::vector<Vec3>&);
template std::vector<Vec2> randomSites<2>(const Domain<2>&, Index, std::uint64_t, const RunContext&);
template std::vector<Vec3> randomSites<3>(const Domain<3>&, Index, std::uint64_t, const RunContext&);

}  // namespace voroform::cvt
