#include "voroform/cvt/energy.hpp"

#include "clipped_sites.hpp"

namespace voroform::cvt {

Box3 siteDomain(const implicit::ImplicitFunction& f) { return siteBoxAround<3>(f.bounds()); }

Evaluation<3> evaluateEnergy(std::span<const Vec3> sites, const implicit::ImplicitFunction& f,
                             const voronoi::ClipOptions& options, const RunContext& context,
                             const Density<3>* density) {
  const ClippedSites<3> cells = clipSites(sites, f, options, context);
  return evaluationOf<3>(sites, cells, momentsOf(cells, density, context), context);
}

}  // namespace voroform::cvt
