#include <cstdio>
#include <cstdlib>
#include <cmath>
#include <string>
#include "marching_cubes.hpp"
#include "scan_form.hpp"
#include "voroform/implicit/closest_point.hpp"
#include "surface_distance.hpp"
#include "voroform/cvt/sites.hpp"
#include "voroform/cvt/energy.hpp"
#include "voroform/cvt/tessellate.hpp"
#include "voroform/implicit/shapes.hpp"
#include "voroform/mesh/moments.hpp"
#include "voroform/mesh/validate.hpp"
using namespace voroform;
struct D { double mean=0, rms=0, max=0; };
static D distances(const implicit::ImplicitFunction& f, const mesh::TriangleMesh& m, const RunContext& c) {
  double area = 0; std::vector<Vec3> pts; D d; double L = 0;
  for (auto& t : m.triangles) { Vec3 a = m.vertices[t[0]], b = m.vertices[t[1]], cc = m.vertices[t[2]]; area += 0.5*(b-a).cross(cc-a).norm(); L = std::max(L,(b-a).norm()); }
  double per = 3.0*m.triangles.size()/area, acc = 0.5; std::uint64_t k = 0;
  for (auto& t : m.triangles) { Vec3 a = m.vertices[t[0]], b = m.vertices[t[1]], cc = m.vertices[t[2]]; acc += per*0.5*(b-a).cross(cc-a).norm();
    while (acc >= 1) { acc -= 1; double u = randomUnit(1, RandomStream::test, k++), v = randomUnit(1, RandomStream::test, k++); if (u+v>1) {u=1-u;v=1-v;} Vec3 p = a+u*(b-a)+v*(cc-a); if (!f.onEnvelope(p)) pts.push_back(p); } }
  auto r = implicit::closestPoints(f, pts, L, c); std::size_t n = 0;
  for (auto& x : r) { if (!x.found) continue; ++n; d.mean += x.distance; d.rms += x.distance*x.distance; d.max = std::max(d.max, x.distance); }
  d.mean /= n; d.rms = std::sqrt(d.rms/n); return d; }
int main(int argc, char** argv) {
  const RunContext context;
  const std::string name = argv[1];
  const Index n = std::atoi(argv[2]);
  implicit::FitOptions fo;
  if (argc > 3) fo.damping = std::atof(argv[3]);
  if (argc > 4) fo.rounds = std::atoi(argv[4]); if (argc > 5) fo.normalWeight = std::atof(argv[5]);
  implicit::ImplicitPtr f = name.find('.') == std::string::npos
    ? implicit::transformed(implicit::namedShape(name), randomRotation(7), Vec3::Zero()) : benchmarks::scanForm(name, context);
  double mc = 0, trueVolume = 0;
  for (int k = 0; k < 6; ++k) {
    cvt::TessellateOptions options; options.sites = n; options.iterations = 10; options.convergence = 0;
    const voronoi::CapKind caps[] = {voronoi::CapKind::cvt1, voronoi::CapKind::cvt2, voronoi::CapKind::cvt3};
    static std::vector<Vec3> sites;
    voronoi::ClipOptions co; co.cap = caps[k % 3]; co.fit = k >= 3; co.fitOptions = fo;
    if (sites.empty()) { auto r = cvt::tessellate(*f, {}, options, context); sites = r.complex.cellSites; }
    Stopwatch w0; auto d = voronoi::buildDiagram(sites, cvt::siteDomain(*f), context); double sd = w0.seconds();
    Stopwatch w; auto c = voronoi::clip(d, *f, co, context); auto complex = voronoi::toComplex(d, c, *f, {}, co, context); double sc = w.seconds();
    auto surface = mesh::boundarySurface(complex);
    auto dist = distances(*f, surface.mesh, context);
    double volume = mesh::enclosedVolume(surface.mesh);
    if (k == 0) {
      double h = std::cbrt(volume / n);
      auto cubes = testing::marchingCubes(*f, h, options.rootFinder, 1e-12);
      auto m = distances(*f, cubes, context); mc = m.mean;
      std::printf("mc mean/h %.4g rms/mean %.3f tri %zu h %.4g\n", mc / h, m.rms/mc, cubes.triangles.size(), h);
      // quasi-random volume is too rough: use a fine clip
      trueVolume = 0;
    }
    // normals
    double na = 0, area = 0;
    for (auto& t : surface.mesh.triangles) { Vec3 a = surface.mesh.vertices[t[0]], b = surface.mesh.vertices[t[1]], cc = surface.mesh.vertices[t[2]]; Vec3 nn = (b-a).cross(cc-a); double A = nn.norm(); if (!(A>0)) continue; Vec3 g = f->gradient((a+b+cc)/3).normalized(); na += A*std::acos(std::min(1.0,std::max(-1.0,g.dot(nn)/A))); area += A; }
    mesh::ValidateOptions vo; auto cert = mesh::validate(complex, vo, context);
    std::printf("%s%s mean/mc %.4f rms/mc %.4f max/mc %.3f nmean %.5f vol %.8f tri %zu valid %d clip %.3fs (delaunay %.3f) fit: %.3fs it %d unfound %ld bounded %d fitted %d unfitted %d\n", k%3==0?"cvt1":k%3==1?"cvt2":"cvt3", co.fit?"+fit":"    ", dist.mean/mc, dist.rms/mc, dist.max/mc, na/area, volume, surface.mesh.triangles.size(), cert.valid, sc, sd, c.summary.fit.seconds, c.summary.fit.iterations, (long)c.summary.fit.unfound, c.summary.fit.bounded, c.summary.fittedPoints, c.summary.unfittedPoints);
    std::fflush(stdout);
  }
}
