// The solid of an implicit form as a domain of sites.
#pragma once

#include <cstdint>
#include <mutex>
#include <utility>

#include "voroform/cvt/density.hpp"
#include "voroform/cvt/domain.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/implicit/roots.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::cvt {

// {f < 0}, cells closed by flat caps. Keeps a reference to f. Each question answered to the same bits for any number of
// threads.
class ImplicitDomain final : public Domain<3> {
 public:
  // The seed is for the estimate of the volume.
  explicit ImplicitDomain(const implicit::ImplicitFunction& f,
                          implicit::RootFinder rootFinder = implicit::RootFinder::itp, std::uint64_t seed = 0);
  // From now on the energy's density; null for ρ = 1.
  void setDensity(DensityPtr<3> density) { density_ = std::move(density); }

  Box3 bounds() const override;
  Box3 siteBox() const override;
  bool contains(const Vec3& p) const override;
  double volume() const override;
  double siteDensity(const Vec3& p) const override { return density_ ? density_->siteDensity(p) : 1; }
  Evaluation<3> evaluate(std::span<const Vec3> sites, const RunContext& context) const override;
  Evaluation<3> evaluateGrown(std::span<const Vec3> sites, double thickness, const RunContext& context) const override;
  SiteGraph graph(std::span<const Vec3> sites, const RunContext& context) const override;

 private:
  double estimatedVolume() const;
  voronoi::ClipOptions clipOptions() const;

  const implicit::ImplicitFunction& f_;
  implicit::RootFinder rootFinder_;
  std::uint64_t seed_;
  DensityPtr<3> density_;
  // Estimated when first asked for.
  mutable std::once_flag volumeEstimated_;
  mutable double volume_ = 0;
};

}  // namespace voroform::cvt
