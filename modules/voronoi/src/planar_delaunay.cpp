#include "planar_delaunay.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"

namespace voroform::voronoi {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Index, Kernel>;
using FaceBase = CGAL::Triangulation_face_base_with_info_2<Index, Kernel>;
using Triangulation =
    CGAL::Delaunay_triangulation_2<Kernel, CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>>;

Triangulation triangulate(std::span<const Vec2> input) {
  std::vector<Kernel::Point_2> points;
  points.reserve(input.size());
  for (const Vec2& p : input) points.emplace_back(p.x(), p.y());
  using Traits = CGAL::Spatial_sort_traits_adapter_2<Kernel, CGAL::Pointer_property_map<Kernel::Point_2>::const_type>;
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Its random rounds come from a generator of its own with a fixed seed.
  CGAL::spatial_sort(order.begin(), order.end(), Traits(CGAL::make_property_map(std::as_const(points))));

  Triangulation triangulation;
  Triangulation::Face_handle hint;
  for (const std::size_t i : order) {
    const std::size_t before = triangulation.number_of_vertices();
    const auto vertex = triangulation.insert(points[i], hint);
    if (triangulation.number_of_vertices() == before) {
      const auto [first, second] = std::minmax({static_cast<std::size_t>(vertex->info()), i});
      throw MethodError("two sites coincide (" + std::to_string(first) + " and " + std::to_string(second) + ")");
    }
    vertex->info() = static_cast<Index>(i);
    hint = vertex->face();
  }
  return triangulation;
}

}  // namespace

Triangles delaunayTriangles(std::span<const Vec2> points, Index realCount) {
  const Triangulation triangulation = triangulate(points);

  // A counting sort by the lowest site gives each triangle its number; see delaunayTetrahedra().
  std::vector<std::uint32_t> offsets(static_cast<std::size_t>(realCount), 0);
  const auto lowestSite = [&](Triangulation::Face_handle face) {
    Index lowest = realCount;
    for (int k = 0; k < 3; ++k) {
      const auto vertex = face->vertex(k);
      if (vertex == triangulation.infinite_vertex()) return realCount;
      lowest = std::min(lowest, vertex->info());
    }
    return lowest;
  };
  for (const auto face : triangulation.all_face_handles()) {
    const Index lowest = lowestSite(face);
    face->info() = lowest;
    if (lowest < realCount) ++offsets[static_cast<std::size_t>(lowest)];
  }
  exclusiveScan(offsets);
  const std::size_t count = offsets.back();
  for (const auto face : triangulation.all_face_handles()) {
    const Index lowest = face->info();
    face->info() = lowest < realCount ? static_cast<Index>(offsets[static_cast<std::size_t>(lowest)]++) : kNone;
  }

  Triangles result;
  result.vertices.resize(count);
  result.neighbors.resize(count);
  for (const auto face : triangulation.all_face_handles()) {
    if (face->info() == kNone) continue;
    const auto t = static_cast<std::size_t>(face->info());
    for (int k = 0; k < 3; ++k) {
      result.vertices[t][static_cast<std::size_t>(k)] = face->vertex(k)->info();
      result.neighbors[t][static_cast<std::size_t>(k)] = face->neighbor(k)->info();
    }
  }
  return result;
}

Vec2 exactCircumcenter(const Vec2& a, const Vec2& b, const Vec2& c) {
  using Exact = CGAL::Simple_cartesian<CGAL::Exact_rational>;
  const auto exact = [](const Vec2& p) { return Exact::Point_2(p.x(), p.y()); };
  const Exact::Point_2 center = CGAL::circumcenter(exact(a), exact(b), exact(c));
  return {CGAL::to_double(center.x()), CGAL::to_double(center.y())};
}

}  // namespace voroform::voronoi
