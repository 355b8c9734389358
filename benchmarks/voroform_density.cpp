// Boundary density: accuracy of the boundary with half the number of cells, relative to the uniform tessellation, and
// what an evaluation costs.
//
//   voroform_density kitten.xyz            figures, of the torus and of the scan
//   voroform_density kitten.xyz cut.svg    a picture of cuts through both instead
#include <algorithm>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "report.hpp"
#include "scan_form.hpp"
#include "voroform/core/random.hpp"
#include "voroform/cvt/implicit_domain.hpp"
#include "voroform/cvt/initial_sites.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/metrics/accuracy.hpp"
#include "voroform/metrics/regularity.hpp"

namespace {

using namespace voroform;

constexpr Index kUniformSites = 14474;
constexpr Index kGradedSites = 7237;

cvt::TessellateOptions optionsFor(bool graded) {
  cvt::TessellateOptions options;
  options.sites = graded ? kGradedSites : kUniformSites;
  options.convergence = 0;
  if (graded) options.density.kind = cvt::DensityKind::boundary;
  return options;
}

double medianSeconds(const cvt::Domain<3>& domain, const std::vector<Vec3>& sites, const RunContext& context) {
  constexpr int kRepetitions = 7;
  std::vector<double> seconds;
  for (int k = 0; k < kRepetitions; ++k) {
    const Stopwatch watch;
    domain.evaluate(sites, context);
    seconds.push_back(watch.seconds());
  }
  std::nth_element(seconds.begin(), seconds.begin() + kRepetitions / 2, seconds.end());
  return seconds[kRepetitions / 2];
}

void measureCost(const std::string& name, const implicit::ImplicitFunction& f, const RunContext& context) {
  cvt::ImplicitDomain domain(f);
  const cvt::TessellateOptions options = optionsFor(true);
  const Stopwatch watch;
  const auto density = cvt::makeDensity(f, options.density, std::cbrt(domain.volume() / kGradedSites), context);
  benchmarks::report("density", name + " grid seconds", watch.seconds());
  domain.setDensity(density);
  const std::vector<Vec3> sites = cvt::randomSites(domain, kGradedSites, 0, context);
  const double weighted = medianSeconds(domain, sites, context);
  domain.setDensity(nullptr);
  benchmarks::report("density", name + " evaluation seconds", weighted);
  benchmarks::report("density", name + " evaluation relative to uniform",
                     weighted / medianSeconds(domain, sites, context));
}

void measure(const std::string& name, const implicit::ImplicitFunction& f, const RunContext& context) {
  metrics::AccuracyOptions accuracyOptions;
  accuracyOptions.cellSize = std::cbrt(cvt::ImplicitDomain(f).volume() / kUniformSites);
  metrics::ParticleOptions particles;
  particles.spacing = accuracyOptions.cellSize / 3;
  const metrics::SurfaceSamples samples = metrics::particleSamples(f, particles, context);
  double uniform[2];
  for (const bool graded : {false, true}) {
    cvt::TessellateOptions options = optionsFor(graded);
    const auto sites = cvt::optimizeSites(f, options, context);
    const std::string kind = name + (graded ? " graded" : " uniform");
    benchmarks::report("density", kind + " optimization seconds", sites.summary.secondsOptimization);
    for (const bool fit : {false, true}) {
      options.fit = fit;
      const cvt::TessellateResult result = cvt::tessellateSites(sites, f, {}, options, context);
      const double mean = metrics::accuracy(result.complex, f, samples, accuracyOptions, context).dmean;
      const std::string method = kind + (fit ? " cvt4" : " cvt3");
      benchmarks::report("density", method + " Dmean/h", mean / accuracyOptions.cellSize);
      if (graded) {
        benchmarks::report("density", method + " Dmean/uniform", mean / uniform[fit ? 1 : 0], 1.0);
      } else {
        uniform[fit ? 1 : 0] = mean;
      }
      const auto values = metrics::regularities(mesh::cellMoments(result.complex, context));
      const metrics::Regularity regularity = metrics::regularity(result.complex, values);
      benchmarks::report("density", method + " boundary cells", result.summary.clip.boundaryCells);
      benchmarks::report("density", method + " mean G", regularity.all.mean);
      benchmarks::report("density", method + " largest G", regularity.all.max);
    }
  }
  measureCost(name, f, context);
}

// Where the faces of a tessellation meet the plane `axis` = height: pairs of points, of inner faces and of the surface.
struct Section {
  std::vector<Vec2> inner;
  std::vector<Vec2> surface;
  Box2 box;
};

Section sectionOf(const mesh::PolyhedralComplex& complex, int axis, double height) {
  Section section;
  const int u = axis == 0 ? 1 : 0;
  const int v = axis == 2 ? 1 : 2;
  for (std::size_t face = 0; face < complex.faceCells.size(); ++face) {
    std::vector<Vec2> crossings;
    const std::size_t first = complex.faceOffsets[face];
    const std::size_t count = complex.faceOffsets[face + 1] - first;
    for (std::size_t k = 0; k < count; ++k) {
      const Vec3& a = complex.vertices[static_cast<std::size_t>(complex.faceVertices[first + k])];
      const Vec3& b = complex.vertices[static_cast<std::size_t>(complex.faceVertices[first + (k + 1) % count])];
      if ((a[axis] < height) == (b[axis] < height)) continue;
      const Vec3 p = a + (height - a[axis]) / (b[axis] - a[axis]) * (b - a);
      crossings.emplace_back(p[u], -p[v]);
    }
    // A face is plane, so its crossings lie on one line: inside it between the first and the second, and so on.
    std::sort(crossings.begin(), crossings.end(),
              [](const Vec2& p, const Vec2& q) { return p.x() != q.x() ? p.x() < q.x() : p.y() < q.y(); });
    auto& lines = complex.faceCells[face][1] == kNone ? section.surface : section.inner;
    for (const Vec2& p : crossings) {
      lines.push_back(p);
      section.box.extend(p);
    }
  }
  return section;
}

constexpr double kPanel = 430;
constexpr double kMargin = 20;
constexpr double kCaption = 24;

void drawLines(const std::vector<Vec2>& ends, const Box2& box, double scale, const char* style, std::ostream& out) {
  out << "<path " << style << " d=\"";
  for (std::size_t k = 0; k + 1 < ends.size(); k += 2) {
    const Vec2 a = scale * (ends[k] - box.min());
    const Vec2 b = scale * (ends[k + 1] - box.min());
    out << "M" << a.x() << " " << a.y() << "L" << b.x() << " " << b.y();
  }
  out << "\"/>\n";
}

// One row: the same cut through the uniform and through the graded tessellation. Returns its height.
double drawRow(const std::string& name, const implicit::ImplicitFunction& f, const Box3& part, int axis, double top,
               std::ostream& out, const RunContext& context) {
  double height = 0;
  for (const bool graded : {false, true}) {
    const cvt::TessellateOptions options = optionsFor(graded);
    mesh::PolyhedralComplex complex = cvt::tessellate(f, {}, options, context).complex;
    Section section = sectionOf(complex, axis, part.center()[axis]);
    const double scale = kPanel / section.box.sizes().maxCoeff();
    height = scale * section.box.sizes().y();
    out << "<g transform=\"translate(" << kMargin + (graded ? kPanel + kMargin : 0) << "," << top << ")\">\n";
    out << "<text y=\"14\">" << name << ", " << options.sites
        << (graded ? " sites, boundary density" : " sites, uniform") << "</text>\n<g transform=\"translate("
        << (kPanel - scale * section.box.sizes().x()) / 2 << "," << kCaption << ")\">\n";
    drawLines(section.inner, section.box, scale, "class=\"inner\"", out);
    drawLines(section.surface, section.box, scale, "class=\"surface\"", out);
    out << "</g>\n</g>\n";
  }
  return height + kCaption + kMargin;
}

void draw(const std::string& path, const implicit::ImplicitFunction& torus, const implicit::ImplicitFunction& scan,
          const RunContext& context) {
  std::ostringstream body;
  body << std::fixed << std::setprecision(1);
  double top = kMargin;
  top += drawRow("torus", torus, torus.bounds(), 2, top, body, context);
  top += drawRow("kitten", scan, scan.bounds(), 2, top, body, context);
  std::ofstream out(path);
  const double width = 2 * kPanel + 3 * kMargin;
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width << " " << top << "\" width=\"" << width
      << "\" height=\"" << top << "\">\n<style>text{font:14px sans-serif;fill:#222}path{fill:none;stroke-linecap:round}"
      << ".inner{stroke:#4a7;stroke-width:.7}.surface{stroke:#222;stroke-width:1.4}</style>\n"
      << "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
      << body.str() << "</svg>\n";
}

}  // namespace

int main(int argc, char** argv) {
  const RunContext context;
  if (argc < 2) {
    std::cerr << "usage: voroform_density SCAN [CUT.svg]\n";
    return 2;
  }
  const implicit::ImplicitPtr torus = implicit::namedShape("torus");
  const implicit::ImplicitPtr scan = benchmarks::scanForm(argv[1], context);
  if (argc > 2) {
    draw(argv[2], *torus, *scan, context);
    return 0;
  }
  measure("torus", *torus, context);
  measure("scan", *scan, context);
  return 0;
}
