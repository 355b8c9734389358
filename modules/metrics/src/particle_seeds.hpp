// Where a particle system starts, and how it finds its neighbors.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::metrics {

struct Particle {
  Vec3 position;
  Vec3 normal;
};

// Particles see each other only where their normals do not oppose: so neither through a thin solid nor across a narrow
// gap, yet around a box's edge.
inline bool sameSheet(const Particle& a, const Particle& b) {
  constexpr double kOpposed = -0.3;
  return a.normal.dot(b.normal) > kOpposed;
}

// Moves p to S by Newton's method along the gradient, which it leaves in the normal. False if S is not within `limit`
// that way. What is left is of second order in the last step, and that is at most a fiftieth of the limit.
bool projectByNewton(const implicit::ImplicitFunction& f, double limit, Particle& p);

// Particles in the cells of a regular grid, as a list that is sorted by cell.
class ParticleGrid {
 public:
  ParticleGrid(std::span<const Particle> particles, double radius);

  // Calls visit(j) for each particle in the cells around the place, at least those within the radius, in an order that
  // depends on the particles alone.
  template <class Visit>
  void forEachNear(const Vec3& place, const Visit& visit) const {
    const std::array<std::int64_t, 3> cell = cellOf(place);
    for (std::int64_t z = cell[2] - 1; z <= cell[2] + 1; ++z) {
      for (std::int64_t y = cell[1] - 1; y <= cell[1] + 1; ++y) {
        const std::uint64_t last = keyOf({cell[0] + 1, y, z});
        auto entry = std::lower_bound(entries_.begin(), entries_.end(), keyOf({cell[0] - 1, y, z}),
                                      [](const Entry& e, std::uint64_t key) { return e.key < key; });
        for (; entry != entries_.end() && entry->key <= last; ++entry) visit(entry->particle);
      }
    }
  }

  // The particles' numbers in the order of their cells.
  std::vector<std::uint32_t> order() const;

 private:
  struct Entry {
    std::uint64_t key;
    std::uint32_t particle;
  };

  std::array<std::int64_t, 3> cellOf(const Vec3& place) const;
  static std::uint64_t keyOf(const std::array<std::int64_t, 3>& cell);

  Vec3 origin_ = Vec3::Zero();
  double cellsPerUnit_ = 1;
  std::vector<Entry> entries_;
};

// Keeps particles in an order keyed by the seed, each if none that is kept lies within the radius on the same sheet
// (Poisson-disk sampling by dart throwing). Those kept stay in their order.
std::vector<Particle> thinned(const std::vector<Particle>& particles, double radius, std::uint64_t seed);

// A Poisson-disk sampling of S off the envelope, with no two particles of a sheet nearer than the radius.
std::vector<Particle> seedParticles(const implicit::ImplicitFunction& f, double radius, std::uint64_t seed,
                                    const RunContext& context);

}  // namespace voroform::metrics
