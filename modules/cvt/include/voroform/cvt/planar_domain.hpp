// A region of the plane as a domain of sites.
#pragma once

#include <utility>

#include "voroform/cvt/density.hpp"
#include "voroform/cvt/domain.hpp"
#include "voroform/mesh/planar_region.hpp"

namespace voroform::cvt {

// The region, cells clipped exactly: energy and gradient are exact up to rounding, with a
// density up to the quadrature (voronoi/weighted_moments.hpp). Keeps a reference to the region.
class PlanarDomain final : public Domain<2> {
 public:
  explicit PlanarDomain(const mesh::PlanarRegion& region) : region_(region) {}
  // From now on the energy's density; null for ρ = 1.
  void setDensity(DensityPtr<2> density) { density_ = std::move(density); }

  Box2 bounds() const override { return region_.bounds(); }
  Box2 siteBox() const override;
  bool contains(const Vec2& p) const override { return region_.contains(p); }
  double volume() const override { return region_.area(); }
  double siteDensity(const Vec2& p) const override { return density_ ? density_->siteDensity(p) : 1; }
  Evaluation<2> evaluate(std::span<const Vec2> sites, const RunContext& context) const override;
  Evaluation<2> evaluateGrown(std::span<const Vec2> sites, double thickness, const RunContext& context) const override;
  SiteGraph graph(std::span<const Vec2> sites, const RunContext& context) const override;

 private:
  const mesh::PlanarRegion& region_;
  DensityPtr<2> density_;
};

}  // namespace voroform::cvt
