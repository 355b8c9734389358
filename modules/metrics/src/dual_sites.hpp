// The sites of a dual tetrahedralization: some on S, the others inside.
#pragma once

#include <cstdint>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::metrics {

// Moves the sites towards the minimum of two energies (Yan et al. 2013, section 5): a site on S towards the centroid of
// its cell's piece of S, and back to S; one inside towards the centroid of its clipped cell.
class DualSites {
 public:
  // No site is on S at first. `reach`: how far one is projected at most. The form and the context must outlive this.
  DualSites(std::vector<Vec3> sites, const implicit::ImplicitFunction& f, double reach, const RunContext& context);

  const std::vector<Vec3>& positions() const { return positions_; }
  const std::vector<std::uint8_t>& onSurface() const { return onSurface_; }
  Index surfaceCount() const;

  // Projects the marked sites on S. Returns how many were not on S before and are now.
  Index project(const std::vector<std::uint8_t>& marked);

  // One step of Lloyd's method, accelerated by momentum (Nesterov 1983). Inner sites whose cell has got a fair piece of
  // S are projected too.
  void step();

 private:
  struct Targets {
    std::vector<Vec3> steps;            // from each site to its centroid
    std::vector<std::uint8_t> reaches;  // 1: the cell's piece of S is as large as befits a site on S
  };
  Targets targetsOf(const std::vector<Vec3>& sites) const;
  // Where site i goes if it wants to go to `place`: on S if it is on S, else inside; `stay` where that fails.
  Vec3 allowed(std::size_t i, const Vec3& place, const Vec3& stay) const;
  // `allowed` for all sites, `places` being overwritten.
  void moveAll(std::vector<Vec3>& places, const std::vector<Vec3>& stay) const;

  const implicit::ImplicitFunction& f_;
  const RunContext& context_;
  double reach_;
  int steps_ = 0;
  std::vector<Vec3> positions_;
  std::vector<Vec3> previous_;
  std::vector<std::uint8_t> onSurface_;
};

}  // namespace voroform::metrics
