#include "voroform/cvt/implicit_domain.hpp"

#include <algorithm>

#include "clipped_sites.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/energy.hpp"

namespace voroform::cvt {

ImplicitDomain::ImplicitDomain(const implicit::ImplicitFunction& f, implicit::RootFinder rootFinder, std::uint64_t seed)
    : f_(f), rootFinder_(rootFinder), seed_(seed) {}

Box3 ImplicitDomain::bounds() const { return f_.bounds(); }

Box3 ImplicitDomain::siteBox() const { return siteDomain(f_); }

bool ImplicitDomain::contains(const Vec3& p) const {
  // By the oracle, and where it is silent by f.
  const double clearance = f_.clearance(p);
  return clearance < 0 || (clearance == 0 && f_.value(p) < 0);
}

double ImplicitDomain::volume() const {
  std::call_once(volumeEstimated_, [&] { volume_ = estimatedVolume(); });
  return volume_;
}

// Quasi-random, which costs less than an evaluation.
double ImplicitDomain::estimatedVolume() const {
  constexpr std::uint64_t kSamples = 20000;
  const Box3 box = bounds();
  std::uint64_t inside = 0;
  for (std::uint64_t k = 0; k < kSamples; ++k) {
    if (contains(quasiRandomInBox(seed_, k, box))) ++inside;
  }
  return static_cast<double>(std::max<std::uint64_t>(inside, 1)) / static_cast<double>(kSamples) * box.volume();
}

voronoi::ClipOptions ImplicitDomain::clipOptions() const {
  voronoi::ClipOptions options;
  options.rootFinder = rootFinder_;
  options.rootTolerance = kOptimizationRootTolerance;
  return options;
}

Evaluation<3> ImplicitDomain::evaluate(std::span<const Vec3> sites, const RunContext& context) const {
  return evaluateEnergy(sites, f_, clipOptions(), context, density_.get());
}

SiteGraph ImplicitDomain::graph(std::span<const Vec3> sites, const RunContext& context) const {
  const ClippedSites<3> cells = clipSites(sites, f_, clipOptions(), context);
  SiteGraph graph;
  for (std::size_t facet = 0; facet < cells.clip.facetStates.size(); ++facet) {
    const std::array<Index, 2>& pair = cells.diagram.facetSites[facet];
    if (cells.clip.facetStates[facet] != voronoi::ClippedDiagram::FacetState::outside &&
        cells.diagram.isReal(pair[1])) {
      graph.edges.push_back(pair);
    }
  }
  std::sort(graph.edges.begin(), graph.edges.end());
  graph.onBoundary.assign(sites.size(), 0);
  for (const Index site : cells.clip.loopSites) graph.onBoundary[static_cast<std::size_t>(site)] = 1;
  return graph;
}

}  // namespace voroform::cvt
