#include "site_options.hpp"

#include <limits>
#include <string>
#include <vector>

#include "validators.hpp"
#include "voroform/core/error.hpp"

namespace voroform::cli {

namespace {

constexpr cvt::DensityKind kDensities[] = {cvt::DensityKind::constant, cvt::DensityKind::boundary,
                                           cvt::DensityKind::curvature};

std::vector<std::string> densityNames() {
  std::vector<std::string> names;
  for (const auto kind : kDensities) names.emplace_back(cvt::toString(kind));
  return names;
}

}  // namespace

void addSiteOptions(CLI::App& command, Settings& settings) {
  command.add_option("--sites", settings.sites, "Number of sites, and so of cells")
      ->check(inRange(Index{1}, std::numeric_limits<Index>::max()))
      ->capture_default_str();
  std::string kinds;
  for (const std::string& name : pipeline::initializationNames()) kinds += name + ", ";
  command
      .add_option("--init", settings.initialization,
                  "Initial sites: " + kinds + "or a file of sites in any format of clouds")
      ->type_name("KIND|FILE")
      ->capture_default_str();
  command
      .add_option("--subdivisions", settings.subdivisions,
                  "Of hierarchical sites; as many as their number and the rule make sense of if not given")
      ->check(inRange(0, 20));
  command
      .add_option(
          "--subdivision-rule", settings.subdivisionRule,
          "Whether coarser levels are made so that the finer lattice fits the boundary (matched), or sites that "
          "subdivision leaves missing are inserted there (insertion, the thesis's)")
      ->check(oneOf({toString(cvt::SubdivisionRule::matched), toString(cvt::SubdivisionRule::insertion)}))
      ->capture_default_str();
  command.add_option("--iterations", settings.iterations, "Iterations of the optimizer; 0 clips the initial sites")
      ->check(inRange(0, 1'000'000))
      ->capture_default_str();
  command.add_option("--optimizer", settings.optimizer, "How the sites are moved")
      ->check(oneOf(pipeline::optimizerNames()))
      ->capture_default_str();
  command
      .add_option("--perturbations", settings.perturbations, "Tries of the Monte-Carlo optimizer to leave a minimum")
      ->check(inRange(0, 1'000'000))
      ->capture_default_str();
  command
      .add_option("--convergence", settings.convergence,
                  "Stop when the sites' distances to their centroids, in cell sizes, have this root mean square; 0: "
                  "never")
      ->check(inRange(0.0, 1e9))
      ->capture_default_str();
  command
      .add_option("--gradient-tolerance", settings.gradientTolerance,
                  "Stop when the gradient's norm is this share of the coordinates' norm (the thesis's rule); 0: never")
      ->check(inRange(0.0, 1e9))
      ->capture_default_str();
  command
      .add_option("--relative-error", settings.relativeError,
                  "Stop when the energy is within this share of its optimum; 0: never")
      ->check(inRange(0.0, 1e9))
      ->capture_default_str();
  command
      .add_option("--density", settings.density,
                  "Where cells are to be small: nowhere, at the boundary, or where the surface is curved most")
      ->check(oneOf(densityNames()))
      ->capture_default_str();
  command.add_option("--density-ratio", settings.densityRatio, "Size of the largest cells relative to the smallest")
      ->check(inRange(1.0, cvt::Density<3>::kMostRatio))
      ->capture_default_str();
  command
      .add_option("--density-width", settings.densityWidth,
                  "Of the boundary density: depth at which cells reach their full size, in the input's units; 0: 4 "
                  "mean cell sizes")
      ->check(inRange(0.0, 1e300))
      ->capture_default_str();
}

cvt::SiteOptions siteOptions(const Settings& settings) {
  cvt::SiteOptions options;
  options.sites = settings.sites;
  options.initialization = pipeline::initializationNamed(settings.initialization).value_or(cvt::Initialization::given);
  options.subdivisions = settings.subdivisions.value_or(-1);
  options.subdivisionRule = settings.subdivisionRule == toString(cvt::SubdivisionRule::insertion)
                                ? cvt::SubdivisionRule::insertion
                                : cvt::SubdivisionRule::matched;
  options.iterations = settings.iterations;
  options.optimizer = pipeline::optimizerNamed(settings.optimizer);
  options.perturbations = settings.perturbations;
  options.convergence = settings.convergence;
  options.gradientTolerance = settings.gradientTolerance;
  options.relativeError = settings.relativeError;
  options.seed = settings.seed;
  return options;
}

cvt::DensityOptions densityOptions(const Settings& settings) {
  cvt::DensityOptions options;
  for (const auto kind : kDensities) {
    if (settings.density == cvt::toString(kind)) options.kind = kind;
  }
  options.ratio = settings.densityRatio;
  options.width = settings.densityWidth;
  return options;
}

void requireSiteOptions(const Settings& settings, const CLI::App& command) {
  const cvt::SiteOptions sites = siteOptions(settings);
  const cvt::DensityKind density = densityOptions(settings).kind;
  const bool hierarchical = sites.initialization == cvt::Initialization::hierarchicalRandom ||
                            sites.initialization == cvt::Initialization::hierarchicalLattice;
  const auto require = [&](bool meant, const std::string& name, const std::string& why) {
    if (!meant && command.get_option(name)->count() > 0) throw UsageError(name + ": has no meaning " + why);
  };
  require(sites.initialization != cvt::Initialization::given, "--sites",
          "beside --init " + settings.initialization + ", a file of sites");
  for (const char* name : {"--subdivisions", "--subdivision-rule"}) {
    require(hierarchical, name, "without --init hierarchical-random or hierarchical-lattice");
  }
  require(sites.optimizer == cvt::Optimizer::monteCarlo, "--perturbations", "without --optimizer monte-carlo");
  require(density != cvt::DensityKind::constant, "--density-ratio", "without --density boundary or curvature");
  require(density == cvt::DensityKind::boundary, "--density-width", "without --density boundary");
}

}  // namespace voroform::cli
