// Integrals over one cell, split into simplices with a corner at its site, weighted by a density.
#pragma once

#include <cmath>
#include <span>
#include <vector>

#include "voroform/voronoi/weighted_moments.hpp"

namespace voroform::voronoi {

// Use for each cell: begin; add its simplices; finish.
template <int M>
class WeightedCell {
 public:
  explicit WeightedCell(const DensityValues<M>& density) : density_(density) {}

  void begin(const Vec<M>& site) {
    site_ = site;
    volume_ = 0;
    points_.clear();
    weights_.clear();
  }

  // The triangle of the site and a, b, or the tetrahedron of the site and a, b, c, all relative to the site; `volume`
  // counts negative where a simplex is to be taken away.
  void add(const Vec2& a, const Vec2& b, double volume);
  void add(const Vec3& a, const Vec3& b, const Vec3& c, double volume);

  void finish(Moments<M>& moments, double& volume) {
    values_.resize(points_.size());
    density_(points_, values_);
    moments = {};
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const double weight = weights_[k] * values_[k];
      const Vec<M> x = points_[k] - site_;
      moments.mass += weight;
      moments.first += weight * x;
      moments.second += weight * x.squaredNorm();
    }
    volume = volume_;
  }

 private:
  void addPoint(const Vec<M>& offset, double weight) {
    points_.push_back(site_ + offset);
    weights_.push_back(weight);
  }

  const DensityValues<M>& density_;
  Vec<M> site_ = Vec<M>::Zero();
  double volume_ = 0;
  std::vector<Vec<M>> points_;
  std::vector<double> weights_;
  std::vector<double> values_;
};

// The rule of degree 4 with 6 points (Cowper 1973; Dunavant 1985): two orbits (a, a, 1 − 2a).
template <>
inline void WeightedCell<2>::add(const Vec2& a, const Vec2& b, double volume) {
  struct Orbit {
    double share;
    double weight;
  };
  static const double kRoot = std::sqrt(38 - 44 * std::sqrt(0.4));
  static const Orbit kOrbits[2] = {
      {(8 - std::sqrt(10.0) + kRoot) / 18, (620 + std::sqrt(213125 - 53320 * std::sqrt(10.0))) / 3720},
      {(8 - std::sqrt(10.0) - kRoot) / 18, (620 - std::sqrt(213125 - 53320 * std::sqrt(10.0))) / 3720}};
  volume_ += volume;
  const Vec2 sum = a + b;
  for (const Orbit& orbit : kOrbits) {
    const Vec2 base = orbit.share * sum;
    const double rest = 1 - 3 * orbit.share;
    const double weight = orbit.weight * volume;
    addPoint(base, weight);
    addPoint(base + rest * a, weight);
    addPoint(base + rest * b, weight);
  }
}

// The rule of degree 5 with 14 points (Walkington 2000): two orbits (a, a, a, 1 − 3a) and one (a, a, ½ − a, ½ − a).
template <>
inline void WeightedCell<3>::add(const Vec3& a, const Vec3& b, const Vec3& c, double volume) {
  struct Orbit {
    double share;
    double weight;
  };
  constexpr Orbit kCornerOrbits[2] = {{0.31088591926330060980, 0.11268792571801585080},
                                      {0.092735250310891226402, 0.073493043116361949544}};
  constexpr Orbit kEdgeOrbit = {0.045503704125649649492, 0.042546020777081466438};
  volume_ += volume;
  const Vec3 sum = a + b + c;
  for (const Orbit& orbit : kCornerOrbits) {
    const Vec3 base = orbit.share * sum;
    const double rest = 1 - 4 * orbit.share;
    const double weight = orbit.weight * volume;
    addPoint(base, weight);
    addPoint(base + rest * a, weight);
    addPoint(base + rest * b, weight);
    addPoint(base + rest * c, weight);
  }
  const Vec3 base = kEdgeOrbit.share * sum;
  const double rest = 0.5 - 2 * kEdgeOrbit.share;
  const double weight = kEdgeOrbit.weight * volume;
  addPoint(base + rest * a, weight);
  addPoint(base + rest * b, weight);
  addPoint(base + rest * c, weight);
  addPoint(base + rest * (a + b), weight);
  addPoint(base + rest * (b + c), weight);
  addPoint(base + rest * (c + a), weight);
}

}  // namespace voroform::voronoi
