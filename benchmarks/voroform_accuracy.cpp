// Accuracy of the boundary: mean Euclidean distance of boundary samples to S, relative to Marching Cubes with the same
// cell size and root finder; and the order of convergence.
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "marching_cubes.hpp"
#include "report.hpp"
#include "surface_distance.hpp"
#include "voroform/cvt/energy.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/moments.hpp"

namespace {

using namespace voroform;

constexpr std::size_t kSamplesPerTriangle = 10;
constexpr std::array<Index, 3> kSites = {2000, 14474, 50000};
constexpr std::array<const char*, 3> kCapNames = {"cvt1", "cvt2", "cvt3"};
constexpr std::array<voronoi::CapKind, 3> kCaps = {voronoi::CapKind::cvt1, voronoi::CapKind::cvt2,
                                                   voronoi::CapKind::cvt3};

// Slope of log(error) over log(spacing), by least squares.
double fittedOrder(const std::vector<double>& spacings, const std::vector<double>& errors) {
  double sx = 0;
  double sy = 0;
  double sxx = 0;
  double sxy = 0;
  const auto n = static_cast<double>(spacings.size());
  for (std::size_t k = 0; k < spacings.size(); ++k) {
    const double x = std::log(spacings[k]);
    const double y = std::log(errors[k]);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

struct Bounds {
  const char* shape;
  std::array<double, 3> ratios;
};

void measure(const Bounds& bounds, const RunContext& context) {
  const implicit::ImplicitPtr f =
      implicit::transformed(implicit::namedShape(bounds.shape), randomRotation(7), Vec3::Zero());
  std::array<std::vector<double>, 3> errors;
  std::vector<double> spacings;
  for (const Index sites : kSites) {
    double marchingCubes = 0;
    for (std::size_t cap = 0; cap < kCaps.size(); ++cap) {
      cvt::TessellateOptions options;
      options.sites = sites;
      options.iterations = 10;
      options.convergence = 0;
      options.cap = kCaps[cap];
      const cvt::TessellateResult result = cvt::tessellate(*f, {}, options, context);
      const auto surface = mesh::boundarySurface(result.complex);
      const auto distances = testing::surfaceDistances(*f, surface.mesh, kSamplesPerTriangle, context);
      errors[cap].push_back(distances.mean);
      if (cap == 0) {
        double volume = 0;
        for (const auto& cell : mesh::cellMoments(result.complex, context)) volume += cell.volume;
        spacings.push_back(std::cbrt(volume / sites));
        const auto cubes = testing::marchingCubes(*f, spacings.back(), options.rootFinder, 1e-12);
        marchingCubes = testing::surfaceDistances(*f, cubes, kSamplesPerTriangle, context).mean;
        benchmarks::report("3", std::string(bounds.shape) + " " + std::to_string(sites) + " mc Dmean/h",
                           marchingCubes / spacings.back());
      }
      const std::string name =
          std::string(bounds.shape) + " " + std::to_string(sites) + " " + kCapNames[cap] + " Dmean/mc";
      const double ratio = distances.mean / marchingCubes;
      sites == 14474 ? benchmarks::report("3", name, ratio, bounds.ratios[cap]) : benchmarks::report("3", name, ratio);
    }
  }
  for (std::size_t cap = 0; cap < kCaps.size(); ++cap) {
    benchmarks::report("3", std::string(bounds.shape) + " " + kCapNames[cap] + " order",
                       fittedOrder(spacings, errors[cap]), 1.8, 2.4);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const RunContext context;
  const std::array<Bounds, 3> shapes = {
      {{"torus", {0.65, 0.48, 0.30}}, {"ellipsoid", {0.88, 0.48, 0.30}}, {"bumpy-sphere", {0.88, 0.48, 0.30}}}};
  for (const Bounds& bounds : shapes) {
    if (argc < 2 || std::string(argv[1]) == bounds.shape) measure(bounds, context);
  }
  return 0;
}
