// Regions and sites of the plane, for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "voroform/core/random.hpp"
#include "voroform/mesh/planar_region.hpp"
#include "voroform/mesh/planar_tessellation.hpp"

namespace voroform::testing {

using Rings = std::vector<std::vector<Vec2>>;

inline double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

inline double signedArea(const std::vector<Vec2>& ring) {
  double sum = 0;
  for (std::size_t k = 0; k < ring.size(); ++k) sum += cross(ring[k], ring[(k + 1) % ring.size()]);
  return sum / 2;
}

// A sequence of random numbers in [0, 1).
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : seed_(seed) {}
  double next() { return randomUnit(seed_, RandomStream::test, index_++); }
  Vec2 inBox(const Box2& box) {
    const double x = next();
    const double y = next();
    return box.min() + Vec2(x, y).cwiseProduct(box.sizes());
  }

 private:
  std::uint64_t seed_;
  std::uint64_t index_ = 0;
};

// A ring with corners at random distances from the center, between the two radii, in random directions.
inline std::vector<Vec2> jaggedRing(const Vec2& center, double inner, double outer, int corners, Draws& draws) {
  std::vector<Vec2> ring;
  for (int k = 0; k < corners; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.8 * draws.next()) / corners;
    const double radius = inner + (outer - inner) * draws.next();
    ring.push_back(center + radius * Vec2(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

// An outer ring about the origin between radii 4 and 7, up to four holes in it, and an island in the first hole.
inline Rings jaggedRings(std::uint64_t seed) {
  Draws draws(seed);
  Rings rings = {jaggedRing(Vec2(0, 0), 4, 7, 5 + static_cast<int>(60 * draws.next()), draws)};
  const Vec2 centers[] = {{1.2, 1.2}, {-1.2, 1.2}, {-1.2, -1.2}, {1.2, -1.2}};
  const int holes = static_cast<int>(5 * draws.next());
  for (int k = 0; k < holes; ++k) {
    rings.push_back(jaggedRing(centers[k], 0.6, 1.1, 5 + static_cast<int>(20 * draws.next()), draws));
  }
  if (holes > 0) rings.push_back(jaggedRing(centers[0], 0.1, 0.25, 5, draws));
  return rings;
}

inline std::vector<Vec2> sitesInBox(std::size_t count, std::uint64_t seed, const Box2& box) {
  Draws draws(seed);
  std::vector<Vec2> sites;
  for (std::size_t i = 0; i < count; ++i) sites.push_back(draws.inBox(box));
  return sites;
}

inline std::vector<Vec2> sitesInside(const mesh::PlanarRegion& region, std::size_t count, std::uint64_t seed) {
  Draws draws(seed);
  std::vector<Vec2> sites;
  while (sites.size() < count) {
    const Vec2 site = draws.inBox(region.bounds());
    if (region.contains(site)) sites.push_back(site);
  }
  return sites;
}

}  // namespace voroform::testing
