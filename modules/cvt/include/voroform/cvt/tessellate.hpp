// The clipped centroidal Voronoi tessellation of an implicit form: initial sites, optimization, clipping, complex.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/cvt/density.hpp"
#include "voroform/cvt/optimized_sites.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/implicit/roots.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"
#include "voroform/voronoi/clip.hpp"

namespace voroform::cvt {

struct TessellateOptions : SiteOptions {
  // Initial sites for Initialization::given, in the form's coordinates.
  std::vector<Vec3> given;
  // Where cells are to be small.
  DensityOptions density;
  // Caps of the result. The optimization itself always uses CapKind::flat, the cheapest.
  voronoi::CapKind cap = voronoi::CapKind::cvt3;
  // Fit the boundary to S in the mean square (voronoi::ClipOptions::fit): with the caps of cvt3 that is cvt4.
  bool fit = false;
  implicit::RootFinder rootFinder = implicit::RootFinder::itp;
  // Memory the run may take, in bytes; a larger estimate throws EnvironmentError before anything is allocated. 0:
  // usableMemory().
  std::uint64_t memoryLimit = 0;
};
// Every violation of the options, as sentences naming field, value and rule; empty if there is none.
std::vector<std::string> validate(const TessellateOptions& options);

struct TessellateSummary : SiteSummary {  // its energies are of flat caps
  Index emptySites = 0;                   // sites without a cell at the end: dropped
  Index movedSites = 0;  // of more than four cells that met at a point, moved apart by a millionth of their size
  voronoi::ClipSummary clip;
  double secondsClipping = 0;
};

struct TessellateResult {
  mesh::PolyhedralComplex complex;  // cell i belongs to complex.cellSites[i]
  TessellateSummary summary;
};

// Initial sites and their optimization; the kind of caps asked for plays no part in it, so that one optimization serves
// all kinds. The same bits for any number of threads. Throws UsageError on bad options, MethodError if f has no inside
// that the sites could be placed in, EnvironmentError if the memory does not suffice, Cancelled.
OptimizedSites<3> optimizeSites(const implicit::ImplicitFunction& f, const TessellateOptions& options,
                                const RunContext& context);

// The tessellation of these sites with the caps and the root finder of the options; the rest of the options is for
// optimizeSites.
TessellateResult tessellateSites(const OptimizedSites<3>& optimized, const implicit::ImplicitFunction& f,
                                 const Frame& frame, const TessellateOptions& options, const RunContext& context);

// Both in one: optimizeSites, then tessellateSites. Throws as optimizeSites does.
TessellateResult tessellate(const implicit::ImplicitFunction& f, const Frame& frame, const TessellateOptions& options,
                            const RunContext& context);

// The number of sites that a run starts with: of `given` ones, or as many as the options ask for.
Index siteCount(const SiteOptions& options, std::size_t given);
// What a run takes of memory, in the plane or in space, in bytes.
struct MemoryCost {
  std::uint64_t perSite = 0;  // with random sites; greedy edge-collapsing needs a multiple, for its samples
  std::uint64_t density = 0;  // 0: there is none, or it takes nothing
};
std::uint64_t estimatedMemory(const SiteOptions& options, Index sites, const MemoryCost& cost);
// Throws EnvironmentError if that is more than the limit, in bytes; 0: usableMemory().
void requireMemory(const SiteOptions& options, Index sites, const MemoryCost& cost, std::uint64_t limit);

// Peak memory in bytes that tessellate is estimated to take.
std::uint64_t estimatedMemory(const TessellateOptions& options);
// Throws EnvironmentError if that is more than the limit. tessellate checks it too; a caller that makes the form first
// can so fail before.
void requireMemory(const TessellateOptions& options);

}  // namespace voroform::cvt
