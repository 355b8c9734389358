// Speed and memory of one CVT evaluation, against CGAL's sequential Delaunay triangulation of the same sites.
// Usage: voroform_speed ratio KITTEN.xyz | voroform_speed large | voroform_speed memory | voroform_speed fit
#include <algorithm>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "report.hpp"
#include "scan_form.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/energy.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/voronoi/clip.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace {

using namespace voroform;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double delaunaySeconds(const std::vector<Vec3>& sites) {
  std::vector<Kernel::Point_3> points;
  for (const Vec3& p : sites) points.emplace_back(p.x(), p.y(), p.z());
  const Stopwatch watch;
  const CGAL::Delaunay_triangulation_3<Kernel> triangulation(points.begin(), points.end());
  const double seconds = watch.seconds();
  return triangulation.number_of_vertices() == sites.size() ? seconds : -1;
}

// Sites as they stand within an optimization.
std::vector<Vec3> relaxedSites(const implicit::ImplicitFunction& f, Index count, const RunContext& context) {
  std::vector<Vec3> sites = cvt::randomSites(cvt::ImplicitDomain(f), count, 1, context);
  const cvt::Evaluation state = cvt::evaluateEnergy(sites, f, {}, context);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (state.moments[i].mass > 0) sites[i] += state.moments[i].first / state.moments[i].mass;
  }
  return sites;
}

struct Timing {
  double ratio = 0;       // evaluation on two threads over the yardstick, median of the pairs
  double evaluation = 0;  // seconds
  double delaunay = 0;    // seconds, of the yardstick
  double twoOverOne = 0;  // everything after Delaunay
};

// Repetitions alternate the yardstick, two threads and one; the sites move by 0.1 h between them.
Timing timeEvaluation(const implicit::ImplicitFunction& f, Index count, int repetitions) {
  RunContext two;
  two.threads = 2;
  RunContext one;
  one.threads = 1;
  std::vector<Vec3> sites = relaxedSites(f, count, two);
  voronoi::ClipOptions options;
  options.rootTolerance = cvt::kOptimizationRootTolerance;
  const double spacing = std::cbrt(cvt::evaluateEnergy(sites, f, options, two).volume / count);
  std::vector<double> ratios;
  std::vector<double> evaluations;
  std::vector<double> delaunays;
  std::vector<double> twoOverOne;
  for (int repetition = 0; repetition < repetitions; ++repetition) {
    const Box3 cube(Vec3::Constant(-1), Vec3::Constant(1));
    for (std::size_t i = 0; i < sites.size(); ++i) {
      const std::uint64_t key = static_cast<std::uint64_t>(repetition) * sites.size() + i;
      sites[i] += 0.1 * spacing * randomInBox(2, RandomStream::sampling, key, cube).stableNormalized();
    }
    delaunays.push_back(delaunaySeconds(sites));
    const Stopwatch watch;
    const cvt::Evaluation onTwo = cvt::evaluateEnergy(sites, f, options, two);
    evaluations.push_back(watch.seconds());
    const cvt::Evaluation onOne = cvt::evaluateEnergy(sites, f, options, one);
    twoOverOne.push_back(onTwo.secondsAfterDelaunay / onOne.secondsAfterDelaunay);
    ratios.push_back(evaluations.back() / delaunays.back());
  }
  return {median(ratios), median(evaluations), median(delaunays), median(twoOverOne)};
}

void reportTiming(const std::string& name, const Timing& timing) {
  benchmarks::report("5", name + ": Delaunay, seconds", timing.delaunay);
  benchmarks::report("5", name + ": evaluation, seconds", timing.evaluation);
  benchmarks::report("5", name + ": evaluation / Delaunay", timing.ratio, 2.0);
  benchmarks::report("5", name + ": after Delaunay, two threads / one", timing.twoOverOne, 0.65);
}

void measureRatios(const std::string& scan) {
  const RunContext context;
  const implicit::ImplicitPtr torus = implicit::torus(1, 0.4);
  const implicit::ImplicitPtr kitten = benchmarks::scanForm(scan, context);
  for (const Index count : {14474, 225034}) {
    reportTiming("torus " + std::to_string(count), timeEvaluation(*torus, count, 5));
    reportTiming("kitten " + std::to_string(count), timeEvaluation(*kitten, count, 5));
  }
  for (const auto& [name, form] : {std::pair{"torus", torus}, std::pair{"kitten", kitten}}) {
    cvt::TessellateOptions options;
    options.sites = 14474;
    options.convergence = 0;
    const auto summary = cvt::tessellate(*form, {}, options, context).summary;
    benchmarks::report("5", std::string(name) + " 14474: evaluations of 10 L-BFGS iterations", summary.evaluations, 14);
  }
}

void measureLarge() {
  const implicit::ImplicitPtr torus = implicit::torus(1, 0.4);
  const Timing small = timeEvaluation(*torus, 225034, 3);
  const Timing large = timeEvaluation(*torus, 2250340, 3);
  benchmarks::report("5", "torus 225034: evaluation / Delaunay", small.ratio, 2.0);
  benchmarks::report("5", "torus 2250340: evaluation / Delaunay", large.ratio);
  benchmarks::report("5", "torus: that ratio at 2250340 / at 225034", large.ratio / small.ratio, 1.1);
}

// Of the whole process, from Linux's own account.
double peakBytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) return 1024.0 * std::stod(line.substr(6));
  }
  return -1;
}

void measureMemory() {
  constexpr Index kSites = 1'000'000;
  RunContext context;
  context.threads = 2;
  const implicit::ImplicitPtr torus = implicit::torus(1, 0.4);
  const std::vector<Vec3> sites = cvt::randomSites(cvt::ImplicitDomain(*torus), kSites, 1, context);
  voronoi::ClipOptions options;
  options.rootTolerance = cvt::kOptimizationRootTolerance;
  cvt::evaluateEnergy(sites, *torus, options, context);
  benchmarks::report("5", "torus 1000000: peak bytes a site of an evaluation", peakBytes() / kSites, 2000);
}

// What the fit of cvt4 adds to the final clipping, in evaluations; medians of repetitions that alternate all three.
void measureFit() {
  constexpr Index kSites = 225034;
  constexpr int kRepetitions = 5;
  RunContext context;
  context.threads = 2;
  const implicit::ImplicitPtr torus = implicit::torus(1, 0.4);
  const std::vector<Vec3> sites = relaxedSites(*torus, kSites, context);
  voronoi::ClipOptions rough;
  rough.rootTolerance = cvt::kOptimizationRootTolerance;
  voronoi::ClipOptions plain;
  plain.cap = voronoi::CapKind::cvt3;
  plain.fit = false;
  voronoi::ClipOptions fitted = plain;
  fitted.fit = true;
  const voronoi::Diagram diagram = voronoi::buildDiagram(sites, cvt::siteDomain(*torus), context);
  const auto clipSeconds = [&](const voronoi::ClipOptions& options) {
    const Stopwatch watch;
    voronoi::ClippedDiagram clipped = voronoi::clip(diagram, *torus, options, context);
    const auto complex = voronoi::toComplex(diagram, clipped, *torus, {}, options, context);
    return complex.cellCount == kSites ? watch.seconds() : -1;
  };
  std::vector<double> evaluations;
  std::vector<double> unfitted;
  std::vector<double> added;
  for (int repetition = 0; repetition < kRepetitions; ++repetition) {
    const Stopwatch watch;
    cvt::evaluateEnergy(sites, *torus, rough, context);
    evaluations.push_back(watch.seconds());
    unfitted.push_back(clipSeconds(plain));
    added.push_back(clipSeconds(fitted) - unfitted.back());
  }
  benchmarks::report("fit", "torus 225034: final clipping of cvt3, seconds", median(unfitted));
  benchmarks::report("fit", "torus 225034: added by the fit, seconds", median(added));
  benchmarks::report("fit", "torus 225034: added by the fit / evaluation", median(added) / median(evaluations), 1.5);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "";
  if (mode == "ratio" && argc == 3) {
    measureRatios(argv[2]);
  } else if (mode == "large") {
    measureLarge();
  } else if (mode == "memory") {
    measureMemory();
  } else if (mode == "fit") {
    measureFit();
  } else {
    std::cerr << "usage: voroform_speed ratio KITTEN.xyz | voroform_speed large | voroform_speed memory |\n"
                 "       voroform_speed fit\n";
    return 2;
  }
  return 0;
}
