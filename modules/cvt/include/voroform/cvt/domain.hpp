// What the initialization and the optimization of sites know of the domain that the sites fill, in the plane (M = 2)
// and in space (M = 3).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "voroform/core/error.hpp"
#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/voronoi/site_moments.hpp"

namespace voroform::cvt {

// E = Σᵢ ∫_Ωᵢ ρ ‖x − xᵢ‖² dx over the clipped cells Ωᵢ, and what its gradient 2 mᵢ (xᵢ − cᵢ) needs (Liu et al. 2009).
// With a density ρ (density.hpp) masses and centroids are weighted by it, and each cell has a size of its own.
template <int M>
struct Evaluation {
  double energy = 0;
  double volume = 0;     // Σ mᵢ; with a density Σ |Ωᵢ|·(mᵢ/|Ωᵢ|)^(M/(M+2)), to stand in optimalEnergy()
  Index emptyCells = 0;  // sites whose cell is empty, or nearly so: mass below 1e-6·V/n
  double rmsMove = 0;    // rms‖cᵢ − xᵢ‖/h over the other sites, h = (V/n)^(1/M); with a density |Ωᵢ|^(1/M)
  double relativeGradient = 0;  // ‖g‖/‖X‖, g the gradient and X the sites' coordinates (thesis, section 4.2.4)
  double meanRegularity = 0;    // mean of G, weighted by ρ, over the other sites' cells
  std::vector<voronoi::Moments<M>> moments;  // of each site; zero for an empty cell
  double secondsDelaunay = 0;
  double secondsAfterDelaunay = 0;  // flattening, clipping, integrals
};

// Neighborhoods of sites within the domain.
struct SiteGraph {
  std::vector<std::array<Index, 2>> edges;  // sites a < b whose cells share a wall within the domain, ascending
  std::vector<std::uint8_t> onBoundary;     // of each site: 1 if the domain's boundary meets its cell
};

template <int M>
class Domain {
 public:
  virtual ~Domain() = default;
  // A box that holds the domain, and the larger one that sites may roam in.
  virtual Box<M> bounds() const = 0;
  virtual Box<M> siteBox() const = 0;
  virtual bool contains(const Vec<M>& p) const = 0;
  // Area or volume, to a few per cent at least: it sets scales.
  virtual double volume() const = 0;
  // How densely sites are to lie at p, relative to the most in the domain; in (0, 1].
  virtual double siteDensity(const Vec<M>& p) const { return static_cast<void>(p), 1.0; }
  // The energy of the sites. They must be distinct and inside siteBox(): MethodError otherwise.
  virtual Evaluation<M> evaluate(std::span<const Vec<M>> sites, const RunContext& context) const = 0;
  // The energy when the domain is grown by a layer of this thickness, at least 0, on its boundary: each cell's piece of
  // the boundary is swept outward along its normal, which leaves gaps at convex edges and overlaps at concave ones.
  // With a density the layer continues that of the boundary, and the thickness is that where sites lie most densely,
  // elsewhere in proportion to their spacing. Throws as evaluate does, MethodError if the domain cannot grow.
  virtual Evaluation<M> evaluateGrown(std::span<const Vec<M>> sites, double thickness,
                                      const RunContext& context) const {
    static_cast<void>(sites), static_cast<void>(thickness), static_cast<void>(context);
    throw MethodError("this domain cannot grow: matched subdivisions are not for it");
  }
  // Throws as evaluate does.
  virtual SiteGraph graph(std::span<const Vec<M>> sites, const RunContext& context) const = 0;
};

// G of the best lattice's cell: the hexagon's 5/(36·√3) for M = 2, the truncated octahedron's 19/(192·∛2) for M = 3.
template <int M>
double optimalRegularity();

// E_m = m·n·(V/n)^((m+2)/m)·G_m: the energy if all n cells had the shape of the best lattice's (thesis, equation 3.5).
// With a density ∫ ρ^(M/(M+2)) dx takes the place of V (Gersho 1979).
template <int M>
double optimalEnergy(Index sites, double volume);

}  // namespace voroform::cvt
