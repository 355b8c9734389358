// Hierarchical sites against random ones: regularity by iteration on forms, time to the same regularity, and the
// thesis's figures in the plane and in a ball. Usage: voroform_hierarchy KITTEN.xyz
#include <algorithm>
#include <array>
#include <iostream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "report.hpp"
#include "scan_form.hpp"
#include "voroform/cvt/hierarchy.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/planar_domain.hpp"

namespace {

using namespace voroform;

// The thesis's rule is run as there: its levels until they converge or nearly so.
constexpr int kThesisCoarseIterations = 200;

struct Method {
  std::string name;
  bool hierarchical = false;
  cvt::HierarchyOptions options = {};
};

const Method kRandom = {"random", false, {}};

Method hierarchical(cvt::SubdivisionRule rule, bool fromLattice, int subdivisions) {
  const bool matched = rule == cvt::SubdivisionRule::matched;
  cvt::HierarchyOptions options = {.subdivisions = subdivisions, .fromLattice = fromLattice, .rule = rule};
  if (!matched) options.coarseIterations = kThesisCoarseIterations;
  std::string name = std::string("hierarchical, ") + cvt::toString(rule) + (fromLattice ? ", lattice" : "");
  if (subdivisions >= 0) name += ", s = " + std::to_string(subdivisions);
  return {std::move(name), true, options};
}

template <int M>
std::vector<Vec<M>> initialSites(const cvt::Domain<M>& domain, Index count, const Method& method, std::uint64_t seed,
                                 const RunContext& context) {
  if (!method.hierarchical) return cvt::randomSites(domain, count, seed, context);
  cvt::OptimizeOptions coarse;
  coarse.seed = seed;
  return cvt::hierarchicalSites(domain, count, method.options, coarse, context).sites;
}

struct Run {
  std::vector<double> regularity;     // mean G after 0, 1, … iterations
  std::vector<double> secondsToHere;  // from the start, coarser levels included
};

Run measure(const cvt::Domain<3>& domain, Index count, const Method& method, int iterations,
            const RunContext& context) {
  Run run;
  const Stopwatch watch;
  std::vector<Vec3> sites = initialSites(domain, count, method, 1, context);
  cvt::OptimizeOptions options;
  options.iterations = iterations;
  options.convergence = 0;
  RunContext timed = context;
  timed.progress = [&](std::string_view, double) { run.secondsToHere.push_back(watch.seconds()); };
  for (const auto& record : cvt::optimize(domain, sites, options, timed).iterations) {
    run.regularity.push_back(record.meanRegularity);
  }
  return run;
}

std::optional<double> secondsTo(const Run& run, double regularity) {
  for (std::size_t i = 0; i < run.regularity.size(); ++i) {
    if (run.regularity[i] <= regularity) return run.secondsToHere[i];
  }
  return std::nullopt;
}

void measureForm(const std::string& name, const implicit::ImplicitFunction& f, const RunContext& context) {
  const cvt::ImplicitDomain domain(f);
  const Method thesis = hierarchical(cvt::SubdivisionRule::insertion, false, -1);
  const Method matched = hierarchical(cvt::SubdivisionRule::matched, false, -1);
  for (const Index count : {14474, 100000}) {
    for (const Method& method : {kRandom, thesis, matched}) {
      const std::string subject = name + " " + std::to_string(count) + " sites, " + method.name;
      const Run run = measure(domain, count, method, 30, context);
      for (const auto& [iterations, bound] : {std::pair{0U, 0.0}, std::pair{10U, 0.0809}, std::pair{25U, 0.0800}}) {
        if (iterations >= run.regularity.size()) continue;  // stalled
        const std::string figure = subject + ", " + std::to_string(iterations) + " iterations, mean G";
        if (bound > 0 && method.name == matched.name) {
          benchmarks::report("hierarchy", figure, run.regularity[iterations], bound);
        } else {
          benchmarks::report("hierarchy", figure, run.regularity[iterations]);
        }
      }
      for (const double regularity : {0.0812, 0.0803, 0.0800}) {
        const auto seconds = secondsTo(run, regularity);
        if (seconds) {
          benchmarks::report("hierarchy", subject + ", seconds to mean G " + std::to_string(regularity), *seconds);
        }
      }
    }
  }
}

template <int M>
void measureConverged(const std::string& subject, const cvt::Domain<M>& domain, Index count, const Method& method,
                      int seeds, std::optional<double> published, const RunContext& context) {
  std::vector<double> means;
  for (int seed = 1; seed <= seeds; ++seed) {
    std::vector<Vec<M>> sites = initialSites(domain, count, method, static_cast<std::uint64_t>(seed), context);
    cvt::OptimizeOptions options;
    options.iterations = 400;
    options.convergence = 1e-4;
    means.push_back(100 * cvt::optimize(domain, sites, options, context).iterations.back().meanRegularity);
  }
  std::sort(means.begin(), means.end());
  const std::size_t middle = means.size() / 2;
  const double median = means.size() % 2 == 1 ? means[middle] : (means[middle - 1] + means[middle]) / 2;
  const std::string figure = subject + " " + std::to_string(count) + " sites, " + method.name + ", median 100·mean G";
  if (published) {
    benchmarks::report("hierarchy", figure, median, *published + 0.01);
  } else {
    benchmarks::report("hierarchy", figure, median);
  }
}

// The published means of tables 4.3 to 4.6, from random sites and from the lattice; the star only for the order.
template <int M>
void measurePublished(const std::string& subject, const cvt::Domain<M>& domain, Index count, int most, int seeds,
                      std::array<double, 3> published, const RunContext& context) {
  measureConverged(subject, domain, count, kRandom, seeds, published[0], context);
  for (const auto rule : {cvt::SubdivisionRule::insertion, cvt::SubdivisionRule::matched}) {
    measureConverged(subject, domain, count, hierarchical(rule, false, most), seeds, published[1], context);
    measureConverged(subject, domain, count, hierarchical(rule, true, 1), seeds, published[2], context);
  }
}

void measurePlane(const RunContext& context) {
  const mesh::PlanarRegion square = mesh::squareRegion();
  const mesh::PlanarRegion star = mesh::starRegion();
  const cvt::PlanarDomain squareDomain(square);
  measurePublished("square", squareDomain, 1033, 4, 10, {8.101, 8.086, 8.077}, context);
  measurePublished("star", cvt::PlanarDomain(star), 10025, 5, 1, {8.089, 8.068, 8.054}, context);
  const std::array<double, 4> published = {8.063, 8.060, 8.056, 8.054};
  for (int s = 1; s <= 4; ++s) {
    for (const auto rule : {cvt::SubdivisionRule::insertion, cvt::SubdivisionRule::matched}) {
      measureConverged("square", squareDomain, 10000, hierarchical(rule, false, s), 1,
                       published[static_cast<std::size_t>(s) - 1], context);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::string part = argc == 3 ? argv[2] : "all";
  if (argc < 2 || argc > 3 || std::string("all plane ball torus kitten").find(part) == std::string::npos) {
    std::cerr << "usage: voroform_hierarchy KITTEN.xyz [plane|ball|torus|kitten]\n";
    return 2;
  }
  const auto wanted = [&](const char* name) { return part == "all" || part == name; };
  const RunContext context;
  if (wanted("plane")) measurePlane(context);
  if (wanted("ball")) {
    const implicit::ImplicitPtr ball = implicit::sphere(0.7);
    measurePublished("ball", cvt::ImplicitDomain(*ball), 5000, 3, 3, {7.980, 7.975, 7.965}, context);
  }
  if (wanted("torus")) measureForm("torus", *implicit::torus(1, 0.4), context);
  if (wanted("kitten")) measureForm("kitten", *benchmarks::scanForm(argv[1], context), context);
  return 0;
}
