#include "voroform/cvt/hierarchy.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "site_candidates.hpp"
#include "subdivision.hpp"
#include "voroform/core/error.hpp"
#include "voroform/cvt/initial_sites.hpp"

namespace voroform::cvt {

namespace {

// What subdivision multiplies the sites of a lattice by.
template <int M>
inline constexpr Index kFactor = M == 2 ? 4 : 8;

// Sites and iterations of the trial that tells how many sites the boundary costs.
constexpr Index kTrialSites = 1000;
constexpr int kTrialIterations = 20;

// In space the coarsest level of SubdivisionRule::matched keeps so many sites by default: with fewer, cells are thicker
// than the thin parts of scans, and nearly all of them lie on the boundary.
constexpr Index kFewestCoarseSites = 500;

template <int M>
int logarithm(Index sites) {
  int result = 0;
  for (; sites >= kFactor<M>; sites /= kFactor<M>) ++result;
  return result;
}

// The domain as a coarser level is to see it.
template <int M>
class GrownDomain final : public Domain<M> {
 public:
  GrownDomain(const Domain<M>& domain, double thickness) : domain_(domain), thickness_(thickness) {}

  Box<M> bounds() const override { return domain_.bounds(); }
  Box<M> siteBox() const override { return domain_.siteBox(); }
  bool contains(const Vec<M>& p) const override { return domain_.contains(p); }
  double volume() const override { return domain_.volume(); }
  double siteDensity(const Vec<M>& p) const override { return domain_.siteDensity(p); }
  Evaluation<M> evaluate(std::span<const Vec<M>> sites, const RunContext& context) const override {
    return domain_.evaluateGrown(sites, thickness_, context);
  }
  Evaluation<M> evaluateGrown(std::span<const Vec<M>> sites, double thickness,
                              const RunContext& context) const override {
    return domain_.evaluateGrown(sites, thickness_ + thickness, context);
  }
  SiteGraph graph(std::span<const Vec<M>> sites, const RunContext& context) const override {
    return domain_.graph(sites, context);
  }

 private:
  const Domain<M>& domain_;
  double thickness_;
};

// How many sites each level needs for subdivision to give the next one's. Each piece of the boundary costs a number of
// edges that goes with its area in units of the cells': k' = a·k − c·k^((M−1)/M), where c hardly depends on k.
template <int M>
class MatchedCounts {
 public:
  void observe(std::size_t sites, std::size_t subdivided) {
    const auto k = static_cast<double>(sites);
    loss_ = (kFactor<M> * k - static_cast<double>(subdivided)) / surface(k);
  }
  // Of the level that is `subdivisions` before one of `sites` sites.
  Index before(Index sites, int subdivisions) const {
    double wanted = sites;
    for (int i = 0; i < subdivisions; ++i) {
      double k = wanted / kFactor<M>;
      for (int step = 0; step < 50; ++step) k = (wanted + loss_ * surface(k)) / kFactor<M>;
      wanted = std::clamp(k, wanted / kFactor<M>, wanted);
    }
    return std::max<Index>(1, static_cast<Index>(std::lround(wanted)));
  }

 private:
  static double surface(double k) { return std::pow(k, (M - 1.0) / M); }
  double loss_ = 0;
};

// b of the level that is `subdivisions` before the finest (thesis, section 4.1.2).
template <int M>
Index thesisCount(Index sites, int subdivisions) {
  for (int i = 0; i < subdivisions; ++i) sites /= kFactor<M>;
  return sites;
}

template <int M>
class HierarchyBuilder {
 public:
  HierarchyBuilder(const Domain<M>& domain, Index count, const HierarchyOptions& options,
                   const OptimizeOptions& optimization, const RunContext& context)
      : domain_(domain),
        count_(count),
        options_(options),
        optimization_(optimization),
        context_(context),
        subdivisions_(options.subdivisions < 0 ? defaultSubdivisions<M>(count, options.rule, options.fromLattice)
                                               : options.subdivisions) {
    optimization_.iterations = options.coarseIterations;
    optimization_.relativeError = 0;
    if (optimization_.optimizer == Optimizer::monteCarlo) optimization_.optimizer = Optimizer::lbfgs;
  }

  Hierarchy<M> build() {
    if (matched() && subdivisions_ > 0) runTrial();
    Hierarchy<M> result;
    std::vector<Vec<M>> sites = coarsest(countAt(subdivisions_));
    for (int left = subdivisions_; left > 0; --left) result.levels.push_back(refine(sites, left));
    result.sites = std::move(sites);
    return result;
  }

 private:
  bool matched() const { return options_.rule == SubdivisionRule::matched; }

  // Of the level that is `left` subdivisions before the finest.
  Index countAt(int left) const { return matched() ? counts_.before(count_, left) : thesisCount<M>(count_, left); }

  std::vector<Vec<M>> coarsest(Index count) const {
    return options_.fromLattice ? latticeSites(domain_, count, optimization_.seed, context_)
                                : randomSites(domain_, count, optimization_.seed, context_);
  }

  void runTrial() {
    const Index count = std::min(kTrialSites, std::max<Index>(1, count_ / kFactor<M>));
    std::vector<Vec<M>> sites = randomSites(domain_, count, optimization_.seed, context_);
    OptimizeOptions options = optimization_;
    options.iterations = kTrialIterations;
    optimize(domain_, sites, options, quiet());
    counts_.observe(sites.size(), sites.size() + domain_.graph(sites, context_).edges.size());
    cellSize_ = std::pow(domain_.evaluate(sites, context_).volume / static_cast<double>(count_), 1.0 / M);
  }

  // Optimizes the sites of a level that is `left` subdivisions before the finest and makes them the next one's.
  HierarchyLevel refine(std::vector<Vec<M>>& sites, int left) {
    const Stopwatch watch;
    HierarchyLevel level;
    level.sites = static_cast<Index>(sites.size());
    if (matched()) {
      const GrownDomain<M> grown(domain_, (std::ldexp(1.0, left) - 1) / 2 * cellSize_);
      level.optimization = optimize<M>(grown, sites, optimization_, quiet());
    } else {
      level.optimization = optimize(domain_, sites, optimization_, quiet());
    }
    std::vector<Vec<M>> finer = subdivide(domain_, sites, domain_.graph(sites, context_), context_);
    level.subdivided = static_cast<Index>(finer.size());
    counts_.observe(sites.size(), finer.size());
    level.inserted = countAt(left - 1) - level.subdivided;
    if (level.inserted < 0) {
      removeSites(domain_, finer, -level.inserted, context_);
    } else if (level.inserted > 0) {
      const Placement placement = matched() ? Placement::largestFirst : Placement::boundaryAtRandom;
      insertSites(domain_, finer, level.inserted, placement, left, optimization_.seed, context_);
    }
    sites = inSpatialOrder<M>(finer);
    context_.report("subdivide", 1 - (left - 1.0) / subdivisions_);
    level.seconds = watch.seconds();
    return level;
  }

  // Progress is reported by level.
  RunContext quiet() const {
    RunContext context = context_;
    context.progress = nullptr;
    return context;
  }

  const Domain<M>& domain_;
  Index count_;
  HierarchyOptions options_;
  OptimizeOptions optimization_;
  const RunContext& context_;
  int subdivisions_;
  MatchedCounts<M> counts_;
  double cellSize_ = 0;  // of the finest level, where sites are to lie most densely
};

}  // namespace

const char* toString(SubdivisionRule rule) {
  switch (rule) {
    case SubdivisionRule::insertion:
      return "insertion";
    case SubdivisionRule::matched:
      return "matched";
  }
  return "";
}

template <int M>
int mostSubdivisions(Index sites) {
  return std::max(0, logarithm<M>(sites) - 1);
}

template <int M>
int defaultSubdivisions(Index sites, SubdivisionRule rule, bool fromLattice) {
  const int most = mostSubdivisions<M>(sites);
  if (fromLattice) return std::min(most, 1);
  if (rule == SubdivisionRule::insertion || M == 2) return most;
  int result = std::min(most, 1);
  while (result < most && thesisCount<M>(sites, result + 1) >= kFewestCoarseSites) ++result;
  return result;
}

template <int M>
Hierarchy<M> hierarchicalSites(const Domain<M>& domain, Index count, const HierarchyOptions& options,
                               const OptimizeOptions& optimization, const RunContext& context) {
  if (count < 1) throw UsageError("sites is " + std::to_string(count) + ", but must be at least 1");
  if (options.subdivisions > logarithm<M>(count)) {
    throw UsageError("subdivisions is " + std::to_string(options.subdivisions) + ", but " + std::to_string(count) +
                     " sites can come of at most " + std::to_string(logarithm<M>(count)));
  }
  if (options.coarseIterations < 1) {
    throw UsageError("coarseIterations is " + std::to_string(options.coarseIterations) + ", but must be at least 1");
  }
  if (const auto violations = validate(optimization); !violations.empty()) throw UsageError(violations.front());
  return HierarchyBuilder<M>(domain, count, options, optimization, context).build();
}

template int mostSubdivisions<2>(Index);
template int mostSubdivisions<3>(Index);
template int defaultSubdivisions<2>(Index, SubdivisionRule, bool);
template int defaultSubdivisions<3>(Index, SubdivisionRule, bool);
template Hierarchy<2> hierarchicalSites<2>(const Domain<2>&, Index, const HierarchyOptions&, const OptimizeOptions&,
                                           const RunContext&);
template Hierarchy<3> hierarchicalSites<3>(const Domain<3>&, Index, const HierarchyOptions&, const OptimizeOptions&,
                                           const RunContext&);

}  // namespace voroform::cvt
