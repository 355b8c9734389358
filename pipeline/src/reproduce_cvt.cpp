#include "reproduce_cvt.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "rank_records.hpp"
#include "voroform/core/error.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/metrics/regularity.hpp"
#include "voroform/pipeline/form.hpp"
#include "voroform/pipeline/planar.hpp"
#include "voroform/pipeline/rank_statistics.hpp"
#include "voroform/pipeline/site_options.hpp"

namespace voroform::pipeline {

namespace {

// The stop of the thesis's optimizations (section 4.2.4): ‖g‖/‖X‖.
constexpr double kThesisTolerance = 1e-10;
// The thesis's ball: its volume follows from the energies of table 4.6.
constexpr double kBallVolume = 1.421;
// Published and own mean G may differ by so much, in units of 10⁻²: what seeds do.
constexpr double kTolerance = 0.01;

constexpr const char* kTables[] = {"3.2", "4.1", "4.2",        "4.3",        "4.4",        "4.5",
                                   "4.6", "4.7", "figure-3.8", "figure-3.9", "figure-4.10"};

// What one row of a table was made with: the name of the method may go on with a number of iterations or subdivisions
// ("random 2 iterations", "hierarchical-random 3 subdivisions").
struct Row {
  std::string dataSet;
  Index sites = 0;
  std::string method;
  double relativeError = 0;  // Algorithm 1's, of figures 3.8 and 3.9
  auto operator<=>(const Row&) const = default;
};

struct Outcome {
  std::map<std::string, double> values;  // by criterion
  cvt::SiteSummary summary;
};

Row rowOf(const PublishedFigure& figure) {
  constexpr std::string_view kError = "relative error ";
  Row row{figure.dataSet, *figure.sites, figure.method, 0};
  if (figure.criterion.starts_with(kError)) row.relativeError = std::stod(figure.criterion.substr(kError.size()));
  return row;
}

cvt::SiteOptions siteOptionsOf(const Row& row, const ReproduceOptions& options, std::uint64_t seed) {
  cvt::SiteOptions result;
  result.sites = row.sites;
  result.seed = seed;
  result.iterations = options.iterations.value_or(kCvtIterations);
  result.convergence = 0;
  result.gradientTolerance = kThesisTolerance;
  result.relativeError = row.relativeError;
  std::string name = row.method.substr(0, row.method.find(' '));
  if (name.size() < row.method.size()) {
    const int number = std::stoi(row.method.substr(name.size() + 1));
    (row.method.ends_with("iterations") ? result.iterations : result.subdivisions) = number;
  } else if (name == "hierarchical-lattice") {
    result.subdivisions = 1;  // as the thesis has it (section 4.2.3)
  }
  if (name == "monte-carlo") {
    result.optimizer = cvt::Optimizer::monteCarlo;
    name = "random";
  }
  result.initialization = initializationNamed(name).value();
  // Table 4.1 counts what the thesis's own rule inserts.
  if (options.table == "4.1") {
    result.subdivisionRule = cvt::SubdivisionRule::insertion;
  }
  if (options.table == "4.2") {
    // The levels of one hierarchy: each is the finest of a hierarchy that ends there.
    result.subdivisions = 0;
    for (Index sites = row.sites; sites > 10; sites /= 4) ++result.subdivisions;
  }
  return result;
}

void addRegularity(Outcome& outcome, const metrics::RegularityStatistics& statistics) {
  outcome.values["Gmax"] = 100 * statistics.max;
  outcome.values["Gmean"] = 100 * statistics.mean;
  outcome.values["Gmedian"] = 100 * statistics.median;
  outcome.values["Grmse"] = 1000 * statistics.rmse;
}

void addSummary(Outcome& outcome, const Row& row, cvt::SiteSummary summary) {
  outcome.values["E"] = summary.energy;
  outcome.values["seconds"] = summary.secondsInitial + summary.secondsOptimization;
  if (row.relativeError > 0) outcome.values["relative error"] = summary.relativeError;
  for (std::size_t level = 0; level < summary.levels.size(); ++level) {
    const std::string next = std::to_string(level + 1);
    if (level == 0) outcome.values["k0"] = summary.levels[0].sites;
    outcome.values["k" + next] = summary.levels[level].subdivided;
    outcome.values["b" + next + "-k" + next] = summary.levels[level].inserted;
  }
  outcome.summary = std::move(summary);
}

Outcome runPlanar(const Row& row, const cvt::SiteOptions& sites, const RunContext& context) {
  PlanarOptions options;
  static_cast<cvt::SiteOptions&>(options) = sites;
  PlanarResult result = tessellatePlanar(planarFromInput("shape2d:" + row.dataSet, context), options, context);
  Outcome outcome;
  addRegularity(outcome, result.measurement.regularity.all);
  addSummary(outcome, row, std::move(result.summary));
  return outcome;
}

Outcome runSolid(const implicit::ImplicitFunction& f, const Row& row, const cvt::SiteOptions& sites,
                 const RunContext& context) {
  cvt::TessellateOptions options;
  static_cast<cvt::SiteOptions&>(options) = sites;
  options.fit = true;  // the caps that come closest to the solid
  cvt::OptimizedSites<3> optimized = cvt::optimizeSites(f, options, context);
  const mesh::PolyhedralComplex complex = cvt::tessellateSites(optimized, f, {}, options, context).complex;
  const std::vector<mesh::CellMoments> moments = mesh::cellMoments(complex, context);
  Outcome outcome;
  addRegularity(outcome, metrics::regularity(complex, metrics::regularities(moments)).all);
  addSummary(outcome, row, std::move(optimized.summary));
  // The optimization's own energy is of flat caps.
  double energy = 0;
  for (std::size_t i = 0; i < moments.size(); ++i) {
    energy += moments[i].secondMoment + moments[i].volume * (moments[i].centroid - complex.cellSites[i]).squaredNorm();
  }
  outcome.values["E"] = energy;
  return outcome;
}

class CvtRunner {
 public:
  CvtRunner(Reproduction& result, const RunContext& context) : result_(result), context_(context) {}

  // One outcome a seed.
  const std::vector<Outcome>& outcomes(const Row& row) {
    const auto [place, added] = outcomes_.try_emplace(row);
    if (!added) return place->second;
    const ReproduceOptions& options = result_.options;
    // Times are of one run; a lattice has no seed that matters.
    const int seeds = options.table == "4.7" || row.method == "lattice" || row.relativeError > 0 ? 1 : options.seeds;
    for (int k = 0; k < seeds; ++k) {
      const cvt::SiteOptions sites = siteOptionsOf(row, options, options.seed + static_cast<std::uint64_t>(k));
      place->second.push_back(isPlanar(row.dataSet) ? runPlanar(row, sites, context_)
                                                    : runSolid(formOf(row.dataSet), row, sites, context_));
    }
    const Outcome& first = place->second.front();
    context_.info(row.dataSet + ", " + std::to_string(row.sites) + " sites, " + row.method + ": mean G " +
                  shortNumber(first.values.at("Gmean"), 5) + "e-2 after " +
                  std::to_string(first.summary.iterationsDone) + " iterations (" + toString(first.summary.stop) + ")");
    if (options.table.starts_with("figure")) addCurve(row, first.summary);
    return place->second;
  }

 private:
  static bool isPlanar(const std::string& dataSet) { return dataSet == "square" || dataSet == "star"; }

  const implicit::ImplicitFunction& formOf(const std::string& dataSet) {
    Form& form = forms_[dataSet];
    if (form.function) return *form.function;
    if (dataSet == "ball") {
      form.function = implicit::sphere(std::cbrt(kBallVolume * 3 / (4 * std::numbers::pi)));
    } else {
      form = formFromInput((result_.options.data / "meshes" / (dataSet + ".off")).string(), {}, context_);
    }
    return *form.function;
  }

  void addCurve(const Row& row, const cvt::SiteSummary& summary) {
    const std::string name = row.method + (row.relativeError > 0 ? ", to " + shortNumber(row.relativeError) : "");
    const double regularity = isPlanar(row.dataSet) ? cvt::optimalRegularity<2>() : cvt::optimalRegularity<3>();
    result_.curves.push_back({name, regularity, summary.optimalEnergy, summary.iterations});
  }

  Reproduction& result_;
  const RunContext& context_;
  std::map<Row, std::vector<Outcome>> outcomes_;
  std::map<std::string, Form> forms_;
};

void fill(ReproducedFigure& figure, const std::vector<Outcome>& outcomes) {
  std::string criterion = figure.published.criterion;
  if (criterion.starts_with("relative error")) criterion = "relative error";
  std::vector<double> values;
  for (const Outcome& outcome : outcomes) {
    const auto place = outcome.values.find(criterion);
    if (place == outcome.values.end()) {
      figure.failure = "there is no such level";
      return;
    }
    values.push_back(place->second);
  }
  figure.ours = quantile(values, 0.5);
  if (values.size() > 1) {
    figure.lowest = *std::min_element(values.begin(), values.end());
    figure.highest = *std::max_element(values.begin(), values.end());
  }
}

// How many runs stand behind the figures.
std::string seedsRemark(const Reproduction& result) {
  std::size_t once = 0;
  std::size_t ofSeeds = 0;
  for (const ReproducedFigure& figure : result.figures) {
    if (figure.failure.empty()) ++(std::isnan(figure.lowest) ? once : ofSeeds);
  }
  if (ofSeeds == 0) return "each figure is of one run";
  return "of " + std::to_string(result.options.seeds) + " seeds the median, the lowest and the highest value" +
         (once > 0 ? "; a figure without these two is of one run" : "");
}

std::string nameOf(const ReproducedFigure& figure) {
  return figure.published.method + " (" + shortNumber(figure.ours, 5) + ")";
}

// Which mean G keep the published value, and whether the methods keep their order on each data set.
void addVerdict(Reproduction& result) {
  std::vector<const ReproducedFigure*> means;
  for (const ReproducedFigure& figure : result.figures) {
    if (figure.published.criterion == "Gmean" && figure.failure.empty()) means.push_back(&figure);
  }
  if (means.empty()) return;
  std::size_t kept = 0;
  std::size_t apart = 0;  // pairs that the thesis tells apart
  std::string swapped;
  std::string near;
  for (const ReproducedFigure* a : means) {
    if (a->ours <= a->published.value + kTolerance) ++kept;
    for (const ReproducedFigure* b : means) {
      const double lead = b->published.value - a->published.value;
      if (a->published.dataSet != b->published.dataSet || a->published.sites != b->published.sites || !(lead > 0)) {
        continue;
      }
      const bool toldApart = lead > kTolerance;
      if (toldApart) ++apart;
      if (a->ours <= b->ours) continue;
      std::string& list = toldApart ? swapped : near;
      list += (list.empty() ? "" : "; ") + a->published.dataSet + ", " + std::to_string(*a->published.sites) +
              " sites: " + nameOf(*a) + " after " + nameOf(*b);
    }
  }
  result.remarks.push_back("Mean G at most 0.01·10⁻² above the published value: " + std::to_string(kept) + " of " +
                           std::to_string(means.size()) + ".");
  result.remarks.push_back(swapped.empty() ? "Of the " + std::to_string(apart) +
                                                 " pairs of methods that the thesis tells apart by more than that, all "
                                                 "keep their order."
                                           : "By mean G these come in another order: " + swapped + ".");
  if (!near.empty()) result.remarks.push_back("Nearer pairs, in another order here: " + near + ".");
}

}  // namespace

bool isCvtTable(const std::string& table) {
  return std::find(std::begin(kTables), std::end(kTables), table) != std::end(kTables);
}

void reproduceCvts(const std::vector<PublishedFigure>& published, Reproduction& result, const RunContext& context) {
  const auto& wanted = result.options.dataSets;
  CvtRunner runner(result, context);
  for (const PublishedFigure& figure : published) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), figure.dataSet) == wanted.end()) continue;
    ReproducedFigure reproduced;
    reproduced.published = figure;
    fill(reproduced, runner.outcomes(rowOf(figure)));
    result.figures.push_back(std::move(reproduced));
  }
  result.remarks.push_back("G in units of 10⁻², its root mean square error in 10⁻³; " + seedsRemark(result) +
                           ". L-BFGS until ‖g‖/‖X‖ < 1e-10, at most " +
                           std::to_string(result.options.iterations.value_or(kCvtIterations)) +
                           " iterations. In space with the caps of cvt4.");
  addVerdict(result);
}

}  // namespace voroform::pipeline
