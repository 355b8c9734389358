// Densities ρ: where cells are to be small.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/core/types.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/planar_region.hpp"

namespace voroform::cvt {

// A density of the energy Σᵢ ∫_Ωᵢ ρ ‖x − xᵢ‖² dx. As the number of sites grows, cells of least energy all come to have
// the same share of it, so that a cell's size (the M-th root of its volume) goes with ρ^(−1/(M+2)), and sites lie as
// densely as ρ^(M/(M+2)) (Gersho 1979; Du, Faber and Gunzburger 1999, section 5.1). So a density is given by the wanted
// relative size of cells, s(p) ≥ 1, 1 where they are to be smallest: ρ = s^(−(M+2)), between ratio^(−(M+2)) and 1.
template <int M>
class Density {
 public:
  // `relativeSize` is called from many threads at once, also a little outside of the domain. What it returns is clamped
  // to [1, ratio]; throws UsageError if the ratio is not in [1, kMostRatio].
  Density(std::function<double(const Vec<M>&)> relativeSize, double ratio);

  // s(p): the wanted size of cells, relative to the smallest.
  double relativeSize(const Vec<M>& p) const;
  double value(const Vec<M>& p) const;
  void values(std::span<const Vec<M>> points, std::span<double> out) const;
  // Of sites, relative to the most there can be: ρ^(M/(M+2)), in (0, 1].
  double siteDensity(const Vec<M>& p) const;

  static constexpr double kMostRatio = 10;

 private:
  std::function<double(const Vec<M>&)> relativeSize_;
  double ratio_;
};

template <int M>
using DensityPtr = std::shared_ptr<const Density<M>>;

// The presets. Each gives one density from a solid, to the same bits for any number of threads.
enum class DensityKind {
  constant,   // ρ = 1
  boundary,   // small cells at the boundary, large ones inside
  curvature,  // small cells where the nearest piece of the surface is curved most
};
const char* toString(DensityKind kind);

struct DensityOptions {
  DensityKind kind = DensityKind::constant;
  // Size of the largest cells relative to the smallest, from 1 to Density::kMostRatio.
  double ratio = 3;
  // Of the boundary density: the depth, in the form's units, at which cells reach their full size. 0: kDefaultWidth
  // times the mean size of cells, (V/n)^(1/M).
  double width = 0;
};
inline constexpr double kDefaultWidth = 4;
// Every violation of the options, as sentences naming field, value and rule; empty if there is none.
std::vector<std::string> validate(const DensityOptions& options);

// s = 1 at the boundary, ratio from the depth `width` on, and 1 + (ratio − 1)·t²(3 − 2t) at the depth t·width. Depths
// below 0 count as 0.
template <int M>
DensityPtr<M> boundaryDensity(std::function<double(const Vec<M>&)> depth, double ratio, double width);

// The density of these options for a solid that n cells of mean size `cellSize` shall fill; null for a constant one.
// Depth and nearest surface come from a grid as fine as cells and band need. Its spacing is from 1/kMostIntervals to
// 1/kFewestIntervals of the form's longest side, and at most a quarter of the shortest if the former allows. Distances
// are Euclidean, to points where the grid's edges meet S.
//
// Curvature: the root mean square κ of S's principal curvatures (that of a sphere is 1/R, and saddles count), from
// differences of ∇f/‖∇f‖. The distance of a triangle to S is of the order κh²; so that it is the same everywhere, s =
// √(κ₀/κ) clamped to [1, ratio], with κ₀ the curvature that 5 % of the surface exceed. Each point inside has the
// value of the nearest piece of S, smoothed over neighboring nodes.
//
// Throws UsageError on bad options, MethodError if the grid meets no surface.
inline constexpr int kFewestIntervals = 64;
inline constexpr int kMostIntervals = 256;
DensityPtr<3> makeDensity(const implicit::ImplicitFunction& f, const DensityOptions& options, double cellSize,
                          const RunContext& context);
// The same in the plane; depth is exact. Throws UsageError for DensityKind::curvature: straight edges have none.
// Keeps a reference to the region.
DensityPtr<2> makeDensity(const mesh::PlanarRegion& region, const DensityOptions& options, double cellSize);

}  // namespace voroform::cvt
