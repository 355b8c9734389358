#include "particle_seeds.hpp"

#include <cmath>
#include <utility>

#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/core/random.hpp"

namespace voroform::metrics {

namespace {

// Cells of the seeding grid along a block's side.
constexpr int kBlock = 8;

// Projects the centers of the grid's cells near S, found by halving blocks as far as clearances allow.
class Seeder {
 public:
  Seeder(const implicit::ImplicitFunction& f, double edge, std::vector<Particle>& found)
      : f_(f), edge_(edge), found_(found) {}

  void visit(const Vec3& corner, int cells) {
    const double half = 0.5 * edge_ * cells;
    const Vec3 center = corner + Vec3::Constant(half);
    if (std::abs(f_.clearance(center)) > std::sqrt(3.0) * half) return;
    if (cells > 1) {
      for (unsigned child = 0; child < 8; ++child) {
        const Vec3 offset(child & 1U, child >> 1U & 1U, child >> 2U);
        visit(corner + half * offset, cells / 2);
      }
      return;
    }
    Particle particle{center, Vec3::Zero()};
    // A little beyond the cell, lest a grid aligned with S find nothing.
    constexpr double kBeyond = 1.1;
    if (!projectByNewton(f_, kBeyond * std::sqrt(3.0) * half, particle)) return;
    if (!f_.onEnvelope(particle.position)) found_.push_back(particle);
  }

 private:
  const implicit::ImplicitFunction& f_;
  double edge_;
  std::vector<Particle>& found_;
};

}  // namespace

bool projectByNewton(const implicit::ImplicitFunction& f, double limit, Particle& p) {
  constexpr int kMostSteps = 12;
  constexpr double kLastStep = 0.02;
  const Vec3 start = p.position;
  for (int k = 0; k < kMostSteps; ++k) {
    const Vec3 gradient = f.gradient(p.position);
    const double slope = gradient.norm();
    if (!(slope > 0)) return false;
    p.normal = gradient / slope;
    const double step = f.value(p.position) / slope;
    p.position -= step * p.normal;
    if (!((p.position - start).squaredNorm() <= limit * limit)) return false;
    if (std::abs(step) <= kLastStep * limit) return true;
  }
  return false;
}

ParticleGrid::ParticleGrid(std::span<const Particle> particles, double radius) : cellsPerUnit_(1 / radius) {
  Box3 box;
  for (const Particle& particle : particles) box.extend(particle.position);
  if (box.isEmpty()) return;
  origin_ = box.min();
  entries_.reserve(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    entries_.push_back({keyOf(cellOf(particles[i].position)), static_cast<std::uint32_t>(i)});
  }
  std::sort(entries_.begin(), entries_.end(),
            [](const Entry& a, const Entry& b) { return std::pair(a.key, a.particle) < std::pair(b.key, b.particle); });
}

std::vector<std::uint32_t> ParticleGrid::order() const {
  std::vector<std::uint32_t> result;
  result.reserve(entries_.size());
  for (const Entry& entry : entries_) result.push_back(entry.particle);
  return result;
}

// Two cells are left before the first, so that its neighbors have keys too.
std::array<std::int64_t, 3> ParticleGrid::cellOf(const Vec3& place) const {
  constexpr double kBefore = 2;
  constexpr double kMost = 1 << 20;
  const auto at = [&](Eigen::Index axis) {
    const double cell = std::floor((place[axis] - origin_[axis]) * cellsPerUnit_) + kBefore;
    return static_cast<std::int64_t>(std::clamp(cell, 1.0, kMost));
  };
  return {at(0), at(1), at(2)};
}

std::uint64_t ParticleGrid::keyOf(const std::array<std::int64_t, 3>& cell) {
  constexpr unsigned kBits = 21;
  return static_cast<std::uint64_t>(cell[2]) << 2 * kBits | static_cast<std::uint64_t>(cell[1]) << kBits |
         static_cast<std::uint64_t>(cell[0]);
}

std::vector<Particle> thinned(const std::vector<Particle>& particles, double radius, std::uint64_t seed) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> queue;
  queue.reserve(particles.size());
  for (std::size_t i = 0; i < particles.size(); ++i) {
    queue.emplace_back(randomBits(seed, RandomStream::sampling, i), static_cast<std::uint32_t>(i));
  }
  std::sort(queue.begin(), queue.end());
  const ParticleGrid grid(particles, radius);
  enum class State : std::uint8_t { open, kept, dropped };
  std::vector<State> states(particles.size(), State::open);
  for (const auto& [priority, i] : queue) {
    if (states[i] != State::open) continue;
    states[i] = State::kept;
    const Particle& kept = particles[i];
    grid.forEachNear(kept.position, [&](std::uint32_t j) {
      if (states[j] != State::open || !sameSheet(kept, particles[j])) return;
      if ((particles[j].position - kept.position).squaredNorm() < radius * radius) states[j] = State::dropped;
    });
  }
  std::vector<Particle> result;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (states[i] == State::kept) result.push_back(particles[i]);
  }
  return result;
}

std::vector<Particle> seedParticles(const implicit::ImplicitFunction& f, double radius, std::uint64_t seed,
                                    const RunContext& context) {
  Box3 box = f.bounds();
  if (box.isEmpty()) return {};
  // Several centers for each particle to be kept.
  const double edge = 0.6 * radius;
  box.min() -= Vec3::Constant(edge);
  box.max() += Vec3::Constant(edge);
  std::array<std::size_t, 3> blocks;
  constexpr double kMostBlocks = 1e9;
  double total = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double count = std::ceil(box.sizes()[static_cast<Eigen::Index>(axis)] / (kBlock * edge));
    total *= count;
    if (!(total <= kMostBlocks)) throw UsageError("particleSamples: the spacing is too small for the form's size");
    blocks[axis] = static_cast<std::size_t>(count);
  }
  const std::size_t rows = blocks[1] * blocks[2];
  std::vector<std::vector<Particle>> found(rows);
  parallelFor(context, rows, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) {
      Seeder seeder(f, edge, found[row]);
      for (std::size_t x = 0; x < blocks[0]; ++x) {
        const Vec3 place(static_cast<double>(x), static_cast<double>(row % blocks[1]),
                         static_cast<double>(row / blocks[1]));
        seeder.visit(box.min() + kBlock * edge * place, kBlock);
      }
    }
  });
  std::vector<Particle> particles;
  for (const auto& part : found) particles.insert(particles.end(), part.begin(), part.end());
  return thinned(particles, radius, seed);
}

}  // namespace voroform::metrics
