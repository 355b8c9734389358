// Regularity of the cells: mean and largest G after 10, 50 and all iterations.
// Usage: voroform_regularity KITTEN.xyz
#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "report.hpp"
#include "scan_form.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/metrics/regularity.hpp"

namespace {

using namespace voroform;

metrics::RegularityStatistics regularityAfter(const implicit::ImplicitFunction& f, cvt::TessellateOptions options,
                                              const RunContext& context) {
  const cvt::TessellateResult result = cvt::tessellate(f, {}, options, context);
  const auto values = metrics::regularities(mesh::cellMoments(result.complex, context));
  return metrics::regularity(result.complex, values).all;
}

void measureBall(const RunContext& context) {
  const implicit::ImplicitPtr ball = implicit::sphere(1);
  std::vector<double> means;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    cvt::TessellateOptions options;
    options.sites = 5000;
    options.iterations = 1000;
    options.seed = seed;
    means.push_back(regularityAfter(*ball, options, context).mean);
  }
  std::sort(means.begin(), means.end());
  benchmarks::report("4", "ball 5000 sites converged, median mean G of 5 seeds", means[2], 0.0798);
}

void measureAfterIterations(const std::string& name, const implicit::ImplicitFunction& f, const RunContext& context) {
  cvt::TessellateOptions options;
  options.sites = 14474;
  options.convergence = 0;
  options.iterations = 10;
  const auto ten = regularityAfter(f, options, context);
  benchmarks::report("4", name + " 14474 sites, 10 iterations, mean G", ten.mean, 0.0814);
  benchmarks::report("4", name + " 14474 sites, 10 iterations, max G", ten.max, 0.10);
  options.iterations = 50;
  benchmarks::report("4", name + " 14474 sites, 50 iterations, mean G", regularityAfter(f, options, context).mean,
                     0.0801);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: voroform_regularity KITTEN.xyz\n";
    return 2;
  }
  const RunContext context;
  measureBall(context);
  measureAfterIterations("kitten", *benchmarks::scanForm(argv[1], context), context);
  measureAfterIterations("torus", *implicit::torus(1, 0.4), context);
  return 0;
}
