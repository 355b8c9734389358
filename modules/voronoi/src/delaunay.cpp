#include "delaunay.hpp"

#include <algorithm>
#include <numeric>
#include <string>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::voronoi {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<Index, Kernel>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<Index, Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using Triangulation =
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;

std::vector<Kernel::Point_3> toKernel(std::span<const Vec3> points) {
  std::vector<Kernel::Point_3> result;
  result.reserve(points.size());
  for (const Vec3& p : points) result.emplace_back(p.x(), p.y(), p.z());
  return result;
}

std::vector<std::size_t> identity(std::size_t count) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  return order;
}

auto sortTraits(const std::vector<Kernel::Point_3>& points) {
  return CGAL::Spatial_sort_traits_adapter_3<Kernel, CGAL::Pointer_property_map<Kernel::Point_3>::const_type>(
      CGAL::make_property_map(points));
}

Triangulation triangulate(std::span<const Vec3> input) {
  const std::vector<Kernel::Point_3> points = toKernel(input);
  std::vector<std::size_t> order = identity(points.size());
  CGAL::spatial_sort(order.begin(), order.end(), sortTraits(points));  // biased randomized insertion order
  Triangulation triangulation;
  Triangulation::Cell_handle hint;
  for (const std::size_t i : order) {
    const std::size_t before = triangulation.number_of_vertices();
    const auto vertex = triangulation.insert(points[i], hint);
    if (triangulation.number_of_vertices() == before) {
      throw MethodError("two sites coincide (" + std::to_string(vertex->info()) + " and " + std::to_string(i) + ")");
    }
    vertex->info() = static_cast<Index>(i);
    hint = vertex->cell();
  }
  return triangulation;
}

}  // namespace

Tetrahedra delaunayTetrahedra(std::span<const Vec3> points, Index realCount) {
  const Triangulation triangulation = triangulate(points);

  // A counting sort by the lowest site gives each tetrahedron its number; neighbors in space become neighbors in
  // memory.
  std::vector<std::uint32_t> offsets(static_cast<std::size_t>(realCount), 0);
  const auto lowestSite = [&](Triangulation::Cell_handle cell) {
    Index lowest = realCount;
    for (int k = 0; k < 4; ++k) {
      const auto vertex = cell->vertex(k);
      if (vertex == triangulation.infinite_vertex()) return realCount;
      lowest = std::min(lowest, vertex->info());
    }
    return lowest;
  };
  for (auto cell = triangulation.all_cells_begin(); cell != triangulation.all_cells_end(); ++cell) {
    const Index lowest = lowestSite(cell);
    cell->info() = lowest;
    if (lowest < realCount) ++offsets[static_cast<std::size_t>(lowest)];
  }
  exclusiveScan(offsets);
  const std::size_t count = offsets.back();
  for (auto cell = triangulation.all_cells_begin(); cell != triangulation.all_cells_end(); ++cell) {
    const Index lowest = cell->info();
    cell->info() = lowest < realCount ? static_cast<Index>(offsets[static_cast<std::size_t>(lowest)]++) : kNone;
  }

  Tetrahedra result;
  result.vertices.resize(count);
  result.neighbors.resize(count);
  for (auto cell = triangulation.all_cells_begin(); cell != triangulation.all_cells_end(); ++cell) {
    if (cell->info() == kNone) continue;
    const auto t = static_cast<std::size_t>(cell->info());
    for (int k = 0; k < 4; ++k) {
      result.vertices[t][static_cast<std::size_t>(k)] = cell->vertex(k)->info();
      result.neighbors[t][static_cast<std::size_t>(k)] = cell->neighbor(k)->info();
    }
  }
  return result;
}

Vec3 exactCircumcenter(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  using Exact = CGAL::Simple_cartesian<CGAL::Exact_rational>;
  const auto exact = [](const Vec3& p) { return Exact::Point_3(p.x(), p.y(), p.z()); };
  const Exact::Point_3 center = CGAL::circumcenter(exact(a), exact(b), exact(c), exact(d));
  return {CGAL::to_double(center.x()), CGAL::to_double(center.y()), CGAL::to_double(center.z())};
}

std::vector<Index> spatialOrder(std::span<const Vec3> input) {
  const std::vector<Kernel::Point_3> points = toKernel(input);
  std::vector<std::size_t> order = identity(points.size());
  CGAL::hilbert_sort(order.begin(), order.end(), sortTraits(points));
  return {order.begin(), order.end()};
}

}  // namespace voroform::voronoi
