#include "voroform/metrics/particles.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "particle_seeds.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/implicit/closest_point.hpp"

namespace voroform::metrics {

namespace {

constexpr std::size_t kGrain = 256;

// Lengths in units of the spacing.
constexpr double kSeedRadius = 0.79;  // a Poisson-disk sampling of this radius has as many points as a regular one
constexpr double kInteraction = 1.44;  // between the first and the second ring of neighbors (√3) of a hexagonal lattice
constexpr double kSkin = 0.3;          // by how much lists of neighbors reach farther
constexpr double kLongestStep = 0.2;
constexpr double kSettled = 0.004;       // mean step at which the system is at rest
constexpr double kGapRadius = 0.72;      // of an empty disk that gets a particle
constexpr double kCrowdedRadius = 0.54;  // nearer pairs lose one

// For each particle the numbers of those nearby on its sheet, in one list.
struct Neighbors {
  std::vector<std::size_t> offsets;
  std::vector<std::uint32_t> list;

  std::span<const std::uint32_t> of(std::size_t i) const {
    return {list.data() + offsets[i], offsets[i + 1] - offsets[i]};
  }
};

Neighbors findNeighbors(const std::vector<Particle>& particles, double radius, const RunContext& context) {
  const ParticleGrid grid(particles, radius);
  std::vector<std::vector<std::uint32_t>> parts((particles.size() + kGrain - 1) / kGrain);
  Neighbors result;
  result.offsets.assign(particles.size(), 0);
  parallelFor(context, particles.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t>& part = parts[begin / kGrain];
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t before = part.size();
      grid.forEachNear(particles[i].position, [&](std::uint32_t j) {
        if (j == i || !sameSheet(particles[i], particles[j])) return;
        if ((particles[j].position - particles[i].position).squaredNorm() < radius * radius) part.push_back(j);
      });
      result.offsets[i] = part.size() - before;
    }
  });
  exclusiveScan(result.offsets);
  result.list.reserve(result.offsets.back());
  for (const auto& part : parts) result.list.insert(result.list.end(), part.begin(), part.end());
  return result;
}

class System {
 public:
  System(const implicit::ImplicitFunction& f, double spacing, std::uint64_t seed, const RunContext& context)
      : f_(f), spacing_(spacing), seed_(seed), context_(context) {}

  bool start() {
    particles_ = seedParticles(f_, kSeedRadius * spacing_, seed_, context_);
    sortByPlace();
    return !particles_.empty();
  }

  void relax(int mostIterations) {
    Neighbors neighbors = findNeighbors(particles_, (kInteraction + kSkin) * spacing_, context_);
    double travelled = 0;
    for (int k = 0; k < mostIterations; ++k) {
      // Neighbors that were too far to be listed may have come near.
      if (2 * travelled > kSkin * spacing_) {
        neighbors = findNeighbors(particles_, (kInteraction + kSkin) * spacing_, context_);
        travelled = 0;
      }
      const Steps steps = step(neighbors);
      travelled += steps.longest;
      ++iterations_;
      if (steps.sum <= kSettled * spacing_ * static_cast<double>(particles_.size())) break;
    }
  }

  void adapt() {
    particles_ = thinned(particles_, kCrowdedRadius * spacing_, seed_);
    fillGaps();
    sortByPlace();
  }

  void finish(SurfaceSamples& result);

 private:
  struct Steps {
    double sum = 0;
    double longest = 0;
  };

  void sortByPlace() {
    const ParticleGrid grid(particles_, spacing_);
    std::vector<Particle> sorted;
    sorted.reserve(particles_.size());
    for (const std::uint32_t i : grid.order()) sorted.push_back(particles_[i]);
    particles_ = std::move(sorted);
  }

  Vec3 push(std::size_t i, std::span<const std::uint32_t> neighbors) const;
  Steps step(const Neighbors& neighbors);
  void proposeInGaps(std::size_t i, std::span<const std::uint32_t> neighbors, std::vector<Particle>& proposed) const;
  void fillGaps();

  const implicit::ImplicitFunction& f_;
  double spacing_;
  std::uint64_t seed_;
  const RunContext& context_;
  std::vector<Particle> particles_;
  std::vector<Particle> moved_;
  int iterations_ = 0;
};

// The way to `self` from another particle, laid into the tangent plane of `self`. Around an edge it is the way over the
// edge, unfolded: by the straight one, edges would be far from everything and gather particles.
Vec3 unfolded(const Particle& self, const Particle& other) {
  constexpr double kBent = 0.85;
  const Vec3 apart = self.position - other.position;
  const Vec3 cross = self.normal.cross(other.normal);
  const double sine = cross.norm();
  if (self.normal.dot(other.normal) < kBent && sine > 0) {
    // In the plane across the edge, apart = a·(edge × normal) + b·(edge × other normal).
    const double a = apart.dot(other.normal) / sine;
    const double b = -apart.dot(self.normal) / sine;
    const Vec3 edge = cross / sine;
    if (a * b >= 0) return (a + b) * edge.cross(self.normal) + apart.dot(edge) * edge;
  }
  return apart;
}

// The tangential step that lowers the energy Σ (1 − d/σ)³ over the pairs nearer than σ: a Newton step of the particle
// alone, damped since all move at once. Of the Hessian only the part along the pair's line is kept, which is positive.
Vec3 System::push(std::size_t i, std::span<const std::uint32_t> neighbors) const {
  constexpr double kDamping = 0.6;
  constexpr double kRegularization = 0.1;
  const Particle& self = particles_[i];
  const Vec3 u = self.normal.unitOrthogonal();
  const Vec3 v = self.normal.cross(u);
  const double sigma = kInteraction * spacing_;
  Eigen::Vector2d force = Eigen::Vector2d::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
  for (const std::uint32_t j : neighbors) {
    const Vec3 apart = unfolded(self, particles_[j]);
    const double distance = apart.norm();
    if (distance >= sigma || !(distance > 0)) continue;
    const Eigen::Vector2d along = Eigen::Vector2d(apart.dot(u), apart.dot(v)) / distance;
    const double closeness = 1 - distance / sigma;
    force += closeness * closeness * along;
    hessian += 2 / sigma * closeness * along * along.transpose();
  }
  const double trace = hessian.trace();
  if (!(trace > 0)) return Vec3::Zero();
  hessian += kRegularization * trace * Eigen::Matrix2d::Identity();
  Eigen::Vector2d step = kDamping * hessian.inverse() * force;
  const double length = step.norm();
  const double longest = kLongestStep * spacing_;
  if (length > longest) step *= longest / length;
  return step.x() * u + step.y() * v;
}

System::Steps System::step(const Neighbors& neighbors) {
  moved_.resize(particles_.size());
  const Steps steps = parallelReduce(
      context_, particles_.size(), kGrain, Steps{},
      [&](std::size_t begin, std::size_t end, Steps part) {
        for (std::size_t i = begin; i < end; ++i) {
          Particle next = particles_[i];
          next.position += push(i, neighbors.of(i));
          // What would leave S or come onto the envelope stays.
          if (!projectByNewton(f_, 0.5 * spacing_, next) || f_.onEnvelope(next.position)) next = particles_[i];
          const double length = (next.position - particles_[i].position).norm();
          part.sum += length;
          part.longest = std::max(part.longest, length);
          moved_[i] = next;
        }
        return part;
      },
      [](const Steps& a, const Steps& b) {
        return Steps{a.sum + b.sum, std::max(a.longest, b.longest)};
      });
  particles_.swap(moved_);
  return steps;
}

// A particle one spacing away in each wide sector without neighbors.
void System::proposeInGaps(std::size_t i, std::span<const std::uint32_t> neighbors,
                           std::vector<Particle>& proposed) const {
  constexpr double kWide = 85 * std::numbers::pi / 180;
  const Particle& self = particles_[i];
  const Vec3 u = self.normal.unitOrthogonal();
  const Vec3 v = self.normal.cross(u);
  std::vector<double> angles;
  for (const std::uint32_t j : neighbors) {
    const Vec3 apart = particles_[j].position - self.position;
    if (apart.norm() < kInteraction * spacing_) angles.push_back(std::atan2(apart.dot(v), apart.dot(u)));
  }
  std::sort(angles.begin(), angles.end());
  if (angles.empty()) angles.push_back(0);
  angles.push_back(angles.front() + 2 * std::numbers::pi);
  for (std::size_t k = 0; k + 1 < angles.size(); ++k) {
    const double gap = angles[k + 1] - angles[k];
    const auto sectors = static_cast<int>(std::ceil(gap / kWide));
    for (int s = 1; s < sectors; ++s) {
      const double angle = angles[k] + gap * s / sectors;
      Particle next{self.position + spacing_ * (std::cos(angle) * u + std::sin(angle) * v), self.normal};
      if (!projectByNewton(f_, spacing_, next) || f_.onEnvelope(next.position)) continue;
      proposed.push_back(next);
    }
  }
}

void System::fillGaps() {
  const double radius = kGapRadius * spacing_;
  const Neighbors neighbors = findNeighbors(particles_, kInteraction * spacing_, context_);
  const ParticleGrid grid(particles_, radius);
  std::vector<std::vector<Particle>> parts((particles_.size() + kGrain - 1) / kGrain);
  parallelFor(context_, particles_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Particle> proposed;
    for (std::size_t i = begin; i < end; ++i) {
      proposed.clear();
      proposeInGaps(i, neighbors.of(i), proposed);
      for (const Particle& next : proposed) {
        bool free = true;
        grid.forEachNear(next.position, [&](std::uint32_t j) {
          free = free && ((particles_[j].position - next.position).squaredNorm() >= radius * radius ||
                          !sameSheet(particles_[j], next));
        });
        if (free) parts[begin / kGrain].push_back(next);
      }
    }
  });
  std::vector<Particle> additional;
  for (const auto& part : parts) additional.insert(additional.end(), part.begin(), part.end());
  additional = thinned(additional, radius, seed_);
  particles_.insert(particles_.end(), additional.begin(), additional.end());
}

// Puts the particles on S to within the roots' tolerance and measures how regular they are.
void System::finish(SurfaceSamples& result) {
  std::vector<Vec3> places;
  places.reserve(particles_.size());
  for (const Particle& particle : particles_) places.push_back(particle.position);
  const auto nearest = implicit::closestPoints(f_, places, spacing_, context_);
  std::vector<Particle> kept;
  for (const implicit::ClosestPoint& place : nearest) {
    if (place.found && !f_.onEnvelope(place.position)) kept.push_back({place.position, place.normal});
  }
  particles_ = std::move(kept);

  const Neighbors neighbors = findNeighbors(particles_, 2 * spacing_, context_);
  std::vector<double> distances;
  for (std::size_t i = 0; i < particles_.size(); ++i) {
    double squared = std::numeric_limits<double>::infinity();
    for (const std::uint32_t j : neighbors.of(i)) {
      squared = std::min(squared, (particles_[j].position - particles_[i].position).squaredNorm());
    }
    if (std::isfinite(squared)) distances.push_back(std::sqrt(squared));
    result.points.push_back(particles_[i].position);
    result.normals.push_back(particles_[i].normal);
  }
  double sum = 0;
  for (const double distance : distances) sum += distance;
  const double mean = distances.empty() ? 0 : sum / static_cast<double>(distances.size());
  double squares = 0;
  for (const double distance : distances) squares += (distance - mean) * (distance - mean);
  result.meanSpacing = mean;
  if (mean > 0) result.variation = std::sqrt(squares / static_cast<double>(distances.size())) / mean;
  result.iterations = iterations_;
}

}  // namespace

SurfaceSamples particleSamples(const implicit::ImplicitFunction& f, const ParticleOptions& options,
                               const RunContext& context) {
  if (!(options.spacing > 0) || !std::isfinite(options.spacing)) {
    throw UsageError("particleSamples: the spacing must be positive and finite");
  }
  const Stopwatch watch;
  System system(f, options.spacing, options.seed, context);
  SurfaceSamples result;
  if (system.start()) {
    constexpr int kRounds = 3;
    constexpr int kIterationsBetween = 10;
    constexpr int kIterationsAtLast = 40;
    for (int round = 0; round < kRounds; ++round) {
      context.report("particles", static_cast<double>(round) / (kRounds + 1));
      system.relax(kIterationsBetween);
      system.adapt();
    }
    system.relax(kIterationsAtLast);
    system.finish(result);
  }
  if (result.points.empty()) {
    throw MethodError(
        "particleSamples: no point of the surface was found; is the form negative nowhere, or the spacing (" +
        std::to_string(options.spacing) + ") larger than the shape?");
  }
  result.seconds = watch.seconds();
  context.report("particles", 1);
  return result;
}

}  // namespace voroform::metrics
