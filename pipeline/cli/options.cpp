#include "options.hpp"

#include <algorithm>
#include <limits>
#include <thread>
#include <vector>

#include "site_options.hpp"
#include "validators.hpp"
#include "voroform/core/error.hpp"

namespace voroform::cli {

namespace {

constexpr pipeline::ExtraFormat kFormats[] = {pipeline::ExtraFormat::obj, pipeline::ExtraFormat::off,
                                              pipeline::ExtraFormat::stl, pipeline::ExtraFormat::adjacency};

std::vector<std::string> formatNames() {
  std::vector<std::string> names;
  for (const auto format : kFormats) names.emplace_back(pipeline::toString(format));
  return names;
}

}  // namespace

void addCommonOptions(CLI::App& command, Settings& settings) {
  command.add_option("--threads", settings.threads, "Most threads to use; 0: as many as the machine has")
      ->check(inRange(0, 1024))
      ->capture_default_str()
      ->group("Common options");
  command.add_option("--seed", settings.seed, "Seed of all random numbers")
      ->check(inRange(std::uint64_t{0}, std::numeric_limits<std::uint64_t>::max()))
      ->capture_default_str()
      ->group("Common options");
  command.add_flag("--quiet", settings.quiet, "Print warnings and errors only")->group("Common options");
  command.add_flag("--verbose", settings.verbose, "Print details")->group("Common options");
  command.add_option("--log", settings.logFile, "Write all messages to this file as well")
      ->type_name("FILE")
      ->group("Common options");
  command
      .add_option("--config", settings.configFile,
                  "Read options from this TOML file, by their long names; the command line comes first")
      ->type_name("FILE")
      ->group("Common options");
}

void addOutputOption(CLI::App& command, Settings& settings, const std::string& description) {
  // Not required() for CLI11: it may stand in the configuration file, which is read after the command line.
  command.add_option("-o,--output", settings.output, description)->type_name("PATH");
}

void addInputKindOption(CLI::App& command, Settings& settings) {
  command
      .add_option(
          "--as", settings.as,
          "How to read the input: auto takes a file with faces for a mesh, one without for a cloud; points takes "
          "a mesh's vertices as a cloud")
      ->check(oneOf({"auto", "points", "mesh"}))
      ->capture_default_str();
}

void addFormOptions(CLI::App& command, Settings& settings) {
  addInputKindOption(command, settings);
  command
      .add_option("--envelope", settings.envelope,
                  "What closes an open scan: box is the cloud's bounding box grown by the margin")
      ->check(oneOf({"box", "none"}))
      ->capture_default_str();
  command.add_option("--margin", settings.margin, "Growth of the envelope, as a share of the bounding box's diagonal")
      ->check(inRange(0.0, 1.0))
      ->capture_default_str();
  command
      .add_option(
          "--implicit", settings.implicit,
          "The function that stands for the input: distance, the signed distance to a mesh; poisson, of a cloud "
          "or of samples on a mesh; auto: distance for meshes, poisson for clouds")
      ->check(oneOf({"auto", "poisson", "distance"}))
      ->capture_default_str();
  command
      .add_option("--samples", settings.samples,
                  "Points on a mesh, uniform by area, that its Poisson form is fitted to")
      ->check(inRange(Index{100}, Index{100'000'000}))
      ->capture_default_str();
  command
      .add_option("--rotation-seed", settings.rotationSeed,
                  "Turn the input by a random rotation of this seed before anything else; without it the input is not "
                  "turned")
      ->check(inRange(std::uint64_t{0}, std::numeric_limits<std::uint64_t>::max()));
}

void addTessellationOptions(CLI::App& command, Settings& settings) {
  command
      .add_option("--method", settings.method,
                  "Caps of the boundary cells: cvt1 convex hulls, cvt2 a point on the surface for each cap, cvt3 also "
                  "one for each chord, cvt4 those of cvt3 fitted to the surface in the mean square")
      ->check(oneOf({"cvt1", "cvt2", "cvt3", "cvt4"}))
      ->capture_default_str();
  command.add_flag("--fit", settings.fit, "Fit the caps of cvt1 or cvt2, too (cvt3 fitted is cvt4)");
  addSiteOptions(command, settings);
  command.add_option("--root-finder", settings.rootFinder, "How the surface is found on an edge")
      ->check(oneOf({"itp", "bisection"}))
      ->capture_default_str();
  command.add_option("--formats", settings.formats, "Further files to write, separated by commas")
      ->type_name("LIST")
      ->check(someOf("format", formatNames(), true))
      ->capture_default_str();
  command.add_flag("--no-accuracy", settings.noAccuracy,
                   "Do not measure the accuracy, which takes about half of the run");
  command.add_option("--memory-limit", settings.memoryLimit,
                     "Most memory to take, e.g. 4GB; 0: what the machine has")
      ->type_name("SIZE")
      ->transform(CLI::AsSizeValue(false))
      ->transform(notNegative())  // the last one added comes first
      ->capture_default_str();
}

void addCompareOptions(CLI::App& command, Settings& settings) {
  command
      .add_option(
          "--resolution", settings.resolution,
          "Cubes of Marching Cubes along the longest edge of the solid's bounding box; the numbers of sites and "
          "tetrahedra follow from it")
      ->check(inRange(Index{4}, Index{1000}))
      ->capture_default_str();
  command
      .add_option("--methods", settings.methods,
                  "The methods to run, separated by commas; all but cvt1+fit and cvt2+fit if not given")
      ->type_name("LIST")
      ->check(someOf("method", pipeline::methodNames()));
  command.add_option("--iterations", settings.iterations, "Iterations of the CVTs' optimizer")
      ->check(inRange(0, 1'000'000))
      ->capture_default_str();
  command.add_option("--lloyd-iterations", settings.lloydIterations, "Lloyd steps after Delaunay refinement")
      ->check(inRange(0, 1'000'000))
      ->capture_default_str();
  command.add_option("--odt-iterations", settings.odtIterations, "ODT steps after them")
      ->check(inRange(0, 1'000'000))
      ->capture_default_str();
  command.add_flag("--perturb", settings.perturb, "Then perturb vertices at slivers");
  command.add_flag("--exude", settings.exude, "At last remove slivers by weights");
  command
      .add_option("--delaunay-time-limit", settings.delaunayTimeLimit,
                  "Seconds after which a run of Delaunay refinement is given up; 0: never")
      ->check(inRange(0.0, 1e9))
      ->capture_default_str();
  command.add_flag("--no-equal-triangles", settings.noEqualTriangles,
                   "Leave out the comparison at equal numbers of boundary triangles");
  command.add_flag("--no-dual", settings.noDual,
                   "Leave out the dual tetrahedra of cvt1, which are measured beside those of delaunay");
  command.add_flag(
      "--no-rotation", settings.noRotation,
      "Leave shapes and meshes as they lie; else they are turned by a rotation that follows from the seed, "
      "for Marching Cubes is exact on planes along its grid");
}

void addSingleComparisonOptions(CLI::App& command, Settings& settings) {
  command.add_flag("--accuracy-samples", settings.accuracySamples,
                   "Write each method's samples with their nearest points, distances and angles");
  command.add_flag("--fit-baselines", settings.fitBaselines,
                   "Also fit the boundaries of Marching Cubes and Delaunay refinement to the surface, as cvt4's is");
}

void addRankOptions(CLI::App& command, Settings& settings) {
  command.add_option("INPUT", settings.inputs, "Inputs as for compare; none with --experiment");
  addOutputOption(command, settings, "Folder for the comparisons and rankings; what is there already is taken");
  command
      .add_option("--experiment", settings.experiment,
                  "A TOML file with inputs, methods, resolutions and seeds; options on the command line come first")
      ->type_name("FILE");
  command.add_option("--data", settings.data, "Folder of the experiment's files")
      ->type_name("FOLDER")
      ->capture_default_str();
  command.add_flag("--keep-tessellations", settings.keepTessellations,
                   "Keep all cells, surfaces and forms as well, which takes much room");
  addFormOptions(command, settings);
  addCompareOptions(command, settings);
}

void addReproduceOptions(CLI::App& command, Settings& settings) {
  command
      .add_option("TABLE", settings.table,
                  "3.1, 3.2, 4.1 to 4.7, 5.1 to 5.4, figure-3.8, figure-3.9, figure-4.10 or figure-5.7 (5.7)")
      ->required();
  addOutputOption(command, settings, "Folder for the results");
  command.add_option("--data", settings.data, "Folder where datasets-scripts/ put the scans and meshes")
      ->type_name("FOLDER")
      ->capture_default_str();
  command
      .add_option("--data-sets", settings.dataSets,
                  "Rows of the table to reproduce, by the thesis's names, separated by commas; all if not given")
      ->type_name("LIST");
  command
      .add_option("--iterations", settings.mostIterations,
                  "Iterations of the CVTs' optimizer; if not given 10, and in chapters 3 and 4 at most 1000")
      ->check(inRange(0, 1'000'000));
  command
      .add_option("--seeds", settings.seeds, "Of chapters 3 and 4: seeds from --seed on, of which the median is taken")
      ->check(inRange(1, 1000))
      ->capture_default_str();
  command
      .add_option("--delaunay-time-limit", settings.delaunayTimeLimit,
                  "Seconds after which a run of Delaunay refinement is given up; 0: never")
      ->check(inRange(0.0, 1e9))
      ->default_val(600);
  command
      .add_option("--ranking", settings.ranking,
                  "For figure 5.7: a folder that rank wrote; without it the thirty meshes are compared")
      ->type_name("FOLDER");
}

int effectiveThreads(const Settings& settings) {
  if (settings.threads > 0) return settings.threads;
  return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

pipeline::FormOptions formOptions(const Settings& settings) {
  pipeline::FormOptions options;
  if (settings.as == "points") options.inputKind = pipeline::InputKind::points;
  if (settings.as == "mesh") options.inputKind = pipeline::InputKind::mesh;
  options.envelope = settings.envelope == "none" ? pipeline::Envelope::none : pipeline::Envelope::box;
  options.margin = settings.margin;
  if (settings.implicit == "poisson") options.implicitKind = pipeline::ImplicitKind::poisson;
  if (settings.implicit == "distance") options.implicitKind = pipeline::ImplicitKind::distance;
  options.samples = settings.samples;
  options.seed = settings.seed;
  options.rotationSeed = settings.rotationSeed;
  return options;
}

bool isForm(const std::string& input) {
  return std::filesystem::path(input).extension() == ".vtu" || pipeline::isStoredMeshForm(input);
}

bool isShape(const std::string& input) { return input.starts_with("shape:"); }

void requireFormOptions(const Settings& settings, const CLI::App& command) {
  if (isForm(settings.input) || isShape(settings.input)) {
    for (const char* name : {"--envelope", "--margin", "--as", "--implicit", "--samples", "--rotation-seed"}) {
      if (isShape(settings.input) && std::string(name) == "--rotation-seed") continue;
      if (command.get_option(name)->count() > 0) {
        throw UsageError(std::string(name) + ": has no meaning for " + settings.input +
                         (isShape(settings.input) ? ", which is closed and exact" : "; it stands in its record"));
      }
    }
  }
}

void requireMeaning(const pipeline::Form& form, const CLI::App& command) {
  const auto refuse = [&](const char* name, const std::string& why) {
    if (command.get_option(name)->count() > 0) {
      throw UsageError(std::string(name) + ": has no meaning for " + form.record.input.name + ", " + why);
    }
  };
  if (!form.source.empty()) return;
  if (form.mesh) {
    for (const char* name : {"--envelope", "--margin"}) refuse(name, "whose signed distance is closed");
  }
  if (!form.record.mesh || form.record.mesh->kind != pipeline::ImplicitKind::poisson) {
    refuse("--samples", "which is not sampled; it belongs to a mesh with --implicit poisson");
  }
}

pipeline::WriteOptions writeOptions(const Settings& settings) {
  pipeline::WriteOptions options;
  for (const std::string& name : split(settings.formats)) {
    for (const auto format : kFormats) {
      if (name == pipeline::toString(format)) options.formats.insert(format);
    }
  }
  options.threads = effectiveThreads(settings);
  cvt::TessellateOptions& cvt = options.tessellate;
  static_cast<cvt::SiteOptions&>(cvt) = siteOptions(settings);
  cvt.density = densityOptions(settings);
  const pipeline::CvtMethod method = pipeline::cvtMethod(settings.method);
  cvt.cap = method.cap;
  cvt.fit = method.fit || settings.fit;
  cvt.rootFinder = settings.rootFinder == "bisection" ? implicit::RootFinder::bisection : implicit::RootFinder::itp;
  cvt.memoryLimit = settings.memoryLimit;
  return options;
}

pipeline::CompareOptions compareOptions(const Settings& settings) {
  pipeline::CompareOptions options;
  if (!settings.methods.empty()) options.methods = split(settings.methods);
  options.resolution = settings.resolution;
  options.iterations = settings.iterations;
  options.delaunay.lloydIterations = settings.lloydIterations;
  options.delaunay.odtIterations = settings.odtIterations;
  options.delaunay.perturb = settings.perturb;
  options.delaunay.exude = settings.exude;
  options.delaunayTimeLimit = settings.delaunayTimeLimit;
  options.equalTriangles = !settings.noEqualTriangles;
  options.fitBaselines = settings.fitBaselines;
  options.accuracySamples = settings.accuracySamples;
  options.dualTetrahedra = !settings.noDual;
  options.seed = settings.seed;
  options.threads = effectiveThreads(settings);
  return options;
}

}  // namespace voroform::cli
