// The solid of an implicit form as a domain of sites.
#pragma once

#include <cstdint>

#include "voroform/cvt/domain.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/implicit/roots.hpp"

namespace voroform::cvt {

// {f < 0}, cells closed by flat caps. Keeps a reference to f. Each question answered to the same bits for any number of
// threads.
class ImplicitDomain final : public Domain<3> {
 public:
  // The seed is for the estimate of the volume.
  explicit ImplicitDomain(const implicit::ImplicitFunction& f,
                          implicit::RootFinder rootFinder = implicit::RootFinder::itp, std::uint64_t seed = 0);

  Box3 bounds() const override;
  Box3 siteBox() const override;
  bool contains(const Vec3& p) const override;
  double volume() const override;
  Evaluation<3> evaluate(std::span<const Vec3> sites, const RunContext& context) const override;
  SiteGraph graph(std::span<const Vec3> sites, const RunContext& context) const override;

 private:
  const implicit::ImplicitFunction& f_;
  implicit::RootFinder rootFinder_;
  std::uint64_t seed_;
};

}  // namespace voroform::cvt
