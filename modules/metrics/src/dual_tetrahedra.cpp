#include "voroform/metrics/dual_tetrahedra.hpp"

#include <cmath>

#include "dual_sites.hpp"
#include "restricted_delaunay.hpp"
#include "voroform/core/error.hpp"
#include "voroform/cvt/energy.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::metrics {

namespace {

// How far a site is projected at most, in units of the cells' size h: boundary cells are hardly longer.
constexpr double kReach = 3;
// At the end, inner sites that turn up on the boundary are projected and the diagram is built again, so often at most.
constexpr int kExposedRounds = 5;

// 1 for the cells with a boundary face.
std::vector<std::uint8_t> boundaryCells(const mesh::PolyhedralComplex& complex) {
  std::vector<std::uint8_t> onBoundary(static_cast<std::size_t>(complex.cellCount), 0);
  for (Index face = 0; face < complex.faceCount(); ++face) {
    if (!complex.isBoundary(face)) continue;
    onBoundary[static_cast<std::size_t>(complex.faceCells[static_cast<std::size_t>(face)][0])] = 1;
  }
  return onBoundary;
}

struct Selected {
  voronoi::Diagram diagram;
  Selection selection;
  std::vector<std::uint8_t> boundary;  // of each site: 1 if it is a vertex of the boundary
};

// The tetrahedra of the sites, after inner sites on the boundary were projected.
Selected selectWithSurfaceSitesOnly(DualSites& sites, const implicit::ImplicitFunction& f, const RunContext& context) {
  for (int round = 0;; ++round) {
    Selected result;
    result.diagram = voronoi::buildDiagram(sites.positions(), cvt::siteDomain(f), context);
    result.selection = selectTetrahedra(result.diagram, sites.onSurface(), f, context);
    result.boundary = boundarySites(result.diagram, result.selection);
    if (round == kExposedRounds || sites.project(result.boundary) == 0) return result;
  }
}

void countSites(const Selected& selected, const DualSites& sites, DualSummary& summary) {
  const voronoi::Diagram& diagram = selected.diagram;
  std::vector<std::uint8_t> used(static_cast<std::size_t>(diagram.siteCount), 0);
  for (std::size_t t = 0; t < selected.selection.selected.size(); ++t) {
    if (selected.selection.selected[t] == 0) continue;
    for (const Index site : diagram.vertexSites[t]) used[static_cast<std::size_t>(site)] = 1;
  }
  for (std::size_t i = 0; i < used.size(); ++i) {
    const bool onSurface = sites.onSurface()[i] != 0;
    const bool onBoundary = selected.boundary[i] != 0;
    if (used[i] == 0) ++summary.droppedSites;
    if (onBoundary && !onSurface) ++summary.exposedSites;
    if (used[i] != 0 && onSurface && !onBoundary) ++summary.buriedSites;
  }
}

}  // namespace

std::vector<std::string> validate(const DualOptions& options) {
  std::vector<std::string> violations;
  if (options.iterations < 0) {
    violations.push_back("iterations is " + std::to_string(options.iterations) + ", but must be at least 0");
  }
  return violations;
}

DualResult dualTetrahedra(const mesh::PolyhedralComplex& cvt, const implicit::ImplicitFunction& f,
                          const DualOptions& options, const RunContext& context) {
  const Stopwatch watch;
  if (const auto violations = validate(options); !violations.empty()) throw UsageError(violations.front());
  if (cvt.cellCount == 0 || cvt.cellSites.size() != static_cast<std::size_t>(cvt.cellCount)) {
    throw UsageError("the complex has " + std::to_string(cvt.cellCount) + " cells and " +
                     std::to_string(cvt.cellSites.size()) + " sites: a dual needs cells, and one site for each");
  }
  const double volume = mesh::enclosedVolume(mesh::boundarySurface(cvt).mesh);
  const double cellSize = std::cbrt(volume / cvt.cellCount);
  if (!(cellSize > 0)) throw UsageError("the complex encloses no volume: a dual needs a solid");

  DualResult result;
  DualSummary& summary = result.summary;
  DualSites sites(cvt.cellSites, f, kReach * cellSize, context);
  const std::vector<std::uint8_t> marked = boundaryCells(cvt);
  const Index projected = sites.project(marked);
  for (int k = 0; k < options.iterations; ++k) {
    sites.step();
    context.report("dual", static_cast<double>(k + 1) / (options.iterations + 1));
  }
  const Selected selected = selectWithSurfaceSitesOnly(sites, f, context);
  result.complex = tetrahedralComplex(selected.diagram, selected.selection, f, cvt.frame);
  if (result.complex.cellCount == 0) {
    throw MethodError("the dual of " + std::to_string(cvt.cellCount) +
                      " cells has no tetrahedron inside the solid: use more sites");
  }

  for (std::size_t i = 0; i < marked.size(); ++i) {
    if (marked[i] != 0 && sites.onSurface()[i] == 0) ++summary.unprojectedSites;
  }
  summary.surfaceSites = sites.surfaceCount();
  summary.addedSurfaceSites = summary.surfaceSites - projected;
  countSites(selected, sites, summary);
  summary.removedTetrahedra = selected.selection.repairRemoved + selected.selection.flatRemoved;
  summary.flatTetrahedra = selected.selection.flatRemoved;
  summary.addedTetrahedra = selected.selection.repairAdded;
  const double enclosed = mesh::enclosedVolume(mesh::boundarySurface(result.complex).mesh);
  summary.volumeError = std::abs(enclosed - volume) / volume;
  summary.seconds = watch.seconds();
  context.report("dual", 1);
  return result;
}

}  // namespace voroform::metrics
