#include "mesh_solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <CGAL/Bbox_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/Unique_hash_map.h>
#include <CGAL/assertions_behaviour.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/optimize_mesh_3.h>

#include "surface_points.hpp"
#include "voroform/core/error.hpp"
#include "voroform/core/random.hpp"

namespace voroform::baselines {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using LabeledDomain = CGAL::Labeled_mesh_domain_3<Kernel>;

constexpr int kOutside = 0;
constexpr int kInside = 1;

Vec3 fromCgal(const Point& p) { return {p.x(), p.y(), p.z()}; }
Point toCgal(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

// CGAL's implicit domain with two parts replaced: intersections with S are found by the same root finder and to the
// same precision as the other methods' vertices (CGAL bisects, for which such precision costs many more evaluations),
// and the first points are on every piece of S (CGAL shoots a few rays from one point, which can miss some).
class SolidDomain : public LabeledDomain {
 public:
  SolidDomain(const implicit::ImplicitFunction& f, const SurfaceSearch& search)
      : LabeledDomain(LabeledDomain::Fct([&f](const Point& p) { return inside(f, fromCgal(p)) ? kInside : kOutside; }),
                      CGAL::Bbox_3(search.box.min().x(), search.box.min().y(), search.box.min().z(),
                                   search.box.max().x(), search.box.max().y(), search.box.max().z())),
        f_(f),
        search_(search) {}

  class Construct_intersection {
   public:
    explicit Construct_intersection(const SolidDomain& domain) : domain_(domain) {}
    Intersection operator()(const Segment_3& segment) const {
      return domain_.intersect(segment.source(), segment.target());
    }
    Intersection operator()(const Ray_3& ray) const { return clipped(ray); }
    Intersection operator()(const Line_3& line) const { return clipped(line); }

   private:
    template <class Query>
    Intersection clipped(const Query& query) const {
      const auto part = CGAL::intersection(query, domain_.bbox_);
      if (!part) return {};
      const auto* segment = boost::get<Segment_3>(&*part);
      return segment != nullptr ? (*this)(*segment) : Intersection();
    }
    const SolidDomain& domain_;
  };
  Construct_intersection construct_intersection_object() const { return Construct_intersection(*this); }

  class Construct_initial_points {
   public:
    explicit Construct_initial_points(const SolidDomain& domain) : domain_(domain) {}
    template <class Output>
    Output operator()(Output output, int = 0) const {
      const std::vector<Vec3> points = initialSurfacePoints(domain_.f_, domain_.search_);
      if (points.empty())
        throw MethodError("there is no surface to mesh: f has the same sign wherever it was looked for");
      for (const Vec3& point : points) {
        *output++ = std::make_pair(toCgal(point), domain_.surfaceIndex());
      }
      return output;
    }

   private:
    const SolidDomain& domain_;
  };
  Construct_initial_points construct_initial_points_object() const { return Construct_initial_points(*this); }

 private:
  LabeledDomain::Index surfaceIndex() const {
    return index_from_surface_patch_index(make_surface_index(kOutside, kInside));
  }

  // A point, the index of the surface, and the dimension 2; dimension 0 if the ends are on the same side.
  Intersection intersect(const Point& from, const Point& to) const {
    Vec3 a = fromCgal(from);
    Vec3 b = fromCgal(to);
    if (inside(f_, a) == inside(f_, b)) return {};
    // Duals of flat tetrahedra reach as far as 10¹⁷ solids away, where a share of the way has no digits left for a
    // place near S. The end beyond the box is outside, and so is where the way to it leaves the box.
    if (!search_.box.contains(b)) b = whereItLeaves(a, b);
    if (!search_.box.contains(a)) a = whereItLeaves(b, a);
    return {toCgal(surfacePoint(f_, a, b, search_.tolerance)), surfaceIndex(), 2};
  }

  // On the box's border, from a point within it.
  Vec3 whereItLeaves(const Vec3& within, const Vec3& beyond) const {
    const Vec3 direction = (beyond - within).stableNormalized();
    double reach = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      if (direction[axis] == 0) continue;
      const double border = direction[axis] > 0 ? search_.box.max()[axis] : search_.box.min()[axis];
      reach = std::min(reach, (border - within[axis]) / direction[axis]);
    }
    return within + std::max(reach, 0.0) * direction;
  }

  const implicit::ImplicitFunction& f_;
  SurfaceSearch search_;
};

using Triangulation = CGAL::Mesh_triangulation_3<SolidDomain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

SurfaceSearch searchOf(const implicit::ImplicitFunction& f, const DelaunayOptions& options) {
  // Of the cube's edge, like that of Marching Cubes.
  constexpr double kTolerance = 1e-12;
  // Room around the bounds, for CGAL cuts rays off at the box: their ends must be outside the solid for certain.
  constexpr double kRoom = 0.02;
  constexpr double kFewestCubes = 32;
  constexpr double kMostCubes = 128;
  const Box3 bounds = f.bounds();
  const Vec3 room = Vec3::Constant(kRoom * bounds.diagonal().norm());
  SurfaceSearch search;
  search.box = Box3(bounds.min() - room, bounds.max() + room);
  const double longest = search.box.sizes().maxCoeff();
  search.spacing = std::clamp(options.cubeEdge, longest / kMostCubes, longest / kFewestCubes);
  search.tolerance = kTolerance * options.cubeEdge;
  search.seed = options.seed;
  return search;
}

void optimize(Complex& complex, const SolidDomain& domain, const DelaunayOptions& options) {
  namespace given = CGAL::parameters;
  // CGAL would stop early once the largest moves are a fiftieth of the local size; 0: it takes the steps it is asked
  // for. It still leaves out vertices that move by less than a hundredth, which is its default.
  constexpr double kConvergence = 0;
  if (options.lloydIterations > 0) {
    CGAL::lloyd_optimize_mesh_3(complex, domain, given::max_iteration_number = options.lloydIterations,
                                given::convergence = kConvergence);
  }
  if (options.odtIterations > 0) {
    CGAL::odt_optimize_mesh_3(complex, domain, given::max_iteration_number = options.odtIterations,
                              given::convergence = kConvergence);
  }
  // Without time limits, which would make the result depend on the machine's speed.
  if (options.perturb) CGAL::perturb_mesh_3(complex, domain, given::time_limit = 0);
  if (options.exude) CGAL::exude_mesh_3(complex, given::time_limit = 0);
}

Tetrahedra flatten(const Complex& complex) {
  const Triangulation& triangulation = complex.triangulation();
  Tetrahedra result;
  const auto count = complex.number_of_cells_in_complex();
  result.corners.reserve(count);
  result.neighbors.reserve(count);
  CGAL::Unique_hash_map<Triangulation::Cell_handle, Index> numbers(kNone);
  Index next = 0;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
    numbers[cell] = next++;
  }
  CGAL::Unique_hash_map<Triangulation::Vertex_handle, Index> vertices(kNone);
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
    auto& corners = result.corners.emplace_back();
    auto& neighbors = result.neighbors.emplace_back();
    for (int k = 0; k < 4; ++k) {
      Index& vertex = vertices[cell->vertex(k)];
      if (vertex == kNone) {
        vertex = static_cast<Index>(result.vertices.size());
        result.vertices.push_back(fromCgal(triangulation.point(cell->vertex(k)).point()));
      }
      corners[static_cast<std::size_t>(k)] = vertex;
      neighbors[static_cast<std::size_t>(k)] = numbers[cell->neighbor(k)];
    }
  }
  return result;
}

// CGAL would print what it is about to throw; the message reaches the caller as it is.
void silent(const char*, const char*, const char*, int, const char*) {}

}  // namespace

Tetrahedra meshSolid(const implicit::ImplicitFunction& f, const DelaunayOptions& options) {
  CGAL::set_error_handler(silent);
  CGAL::get_default_random() =
      CGAL::Random(static_cast<unsigned int>(randomBits(options.seed, RandomStream::sampling, 3)));
  const double size = std::numbers::sqrt3 / 2 * options.cubeEdge;
  namespace given = CGAL::parameters;
  const Criteria criteria(given::facet_angle = options.facetAngle, given::facet_size = size,
                          given::facet_distance = options.facetDistance,
                          given::cell_radius_edge_ratio = options.radiusEdgeRatio, given::cell_size = size);

  Stopwatch watch;
  // Refinement grows from the facets between the first points that are dual to a crossing of S. Between few points on
  // thin parts there may be none: more points then.
  constexpr std::size_t kMostPoints = 2000;
  constexpr std::size_t kMorePoints = 8;
  SurfaceSearch search = searchOf(f, options);
  Complex complex;
  for (; search.pointsPerPiece <= kMostPoints; search.pointsPerPiece *= kMorePoints) {
    complex = CGAL::make_mesh_3<Complex>(SolidDomain(f, search), criteria, given::no_lloyd(), given::no_odt(),
                                         given::no_perturb(), given::no_exude());
    if (complex.number_of_cells_in_complex() > 0) break;
  }
  const SolidDomain domain(f, search);
  const double secondsRefinement = watch.seconds();
  watch.restart();
  optimize(complex, domain, options);
  const double secondsOptimization = watch.seconds();
  Tetrahedra result = flatten(complex);
  if (result.corners.empty()) throw MethodError("Delaunay refinement made no tetrahedron");
  result.secondsRefinement = secondsRefinement;
  result.secondsOptimization = secondsOptimization;
  return result;
}

}  // namespace voroform::baselines
