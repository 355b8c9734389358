#include "voroform/cvt/energy.hpp"

#include <utility>

#include "gather.hpp"
#include "voroform/voronoi/diagram.hpp"
#include "voroform/voronoi/weighted_moments.hpp"

namespace voroform::cvt {

namespace {

// Room around the form's bounds, in units of their diagonal.
constexpr double kDomainMargin = 0.1;

}  // namespace

Box3 siteDomain(const implicit::ImplicitFunction& f) {
  const Box3 bounds = f.bounds();
  const Vec3 margin = Vec3::Constant(kDomainMargin * bounds.diagonal().norm());
  return {bounds.min() - margin, bounds.max() + margin};
}

Evaluation<3> evaluateEnergy(std::span<const Vec3> sites, const implicit::ImplicitFunction& f,
                             const voronoi::ClipOptions& options, const RunContext& context,
                             const Density<3>* density) {
  Evaluation<3> result;
  voronoi::ClipOptions flat = options;
  flat.cap = voronoi::CapKind::flat;
  const voronoi::Diagram diagram = voronoi::buildDiagram(sites, siteDomain(f), context);
  const Stopwatch watch;
  const voronoi::ClippedDiagram clipped = voronoi::clip(diagram, f, flat, context);
  voronoi::WeightedMoments<3> weighted;
  if (density != nullptr) {
    const auto values = [&](std::span<const Vec3> points, std::span<double> out) { density->values(points, out); };
    weighted = voronoi::weightedMoments(diagram, clipped, values, context);
  } else {
    weighted.moments = voronoi::siteMoments(diagram, clipped, context);
  }
  result.moments = std::move(weighted.moments);
  gather(sites, weighted.volumes, result, context);
  result.secondsDelaunay = diagram.secondsDelaunay;
  result.secondsAfterDelaunay = diagram.secondsFlattening + watch.seconds();
  return result;
}

}  // namespace voroform::cvt
