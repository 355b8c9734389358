// A region of the plane as a domain of sites.
#pragma once

#include "voroform/cvt/domain.hpp"
#include "voroform/mesh/planar_region.hpp"

namespace voroform::cvt {

// The region, cells clipped exactly: energy and gradient are exact up to rounding. Keeps a reference to the region.
class PlanarDomain final : public Domain<2> {
 public:
  explicit PlanarDomain(const mesh::PlanarRegion& region) : region_(region) {}

  Box2 bounds() const override { return region_.bounds(); }
  Box2 siteBox() const override;
  bool contains(const Vec2& p) const override { return region_.contains(p); }
  double volume() const override { return region_.area(); }
  Evaluation<2> evaluate(std::span<const Vec2> sites, const RunContext& context) const override;
  SiteGraph graph(std::span<const Vec2> sites, const RunContext& context) const override;

 private:
  const mesh::PlanarRegion& region_;
};

}  // namespace voroform::cvt
