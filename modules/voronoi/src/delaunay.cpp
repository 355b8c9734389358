#include "delaunay.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <string>
#include <utility>

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <CGAL/hilbert_sort.h>
#include <CGAL/property_map.h>

#include "voroform/core/error.hpp"
#include "voroform/core/parallel.hpp"
#include "voroform/core/random.hpp"
#include "voroform/voronoi/diagram.hpp"

namespace voroform::voronoi {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<Index, Kernel>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<Index, Kernel, CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using Triangulation =
    CGAL::Delaunay_triangulation_3<Kernel, CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;

// A biased randomized insertion order (Amenta, Choi, Rote 2003) for points that are in spatial order: random rounds,
// each about eight times the one before, each in the points' own order. No sorting is needed.
std::vector<std::size_t> insertionOrder(std::size_t count, std::size_t realCount) {
  constexpr unsigned kRounds = 16;
  const auto roundOf = [&](std::size_t i) -> std::size_t {
    if (i >= realCount) return 0;  // the ghosts first
    const std::uint64_t bits = randomBits(0, RandomStream::insertion, i);
    return kRounds - 1 - std::min<unsigned>(kRounds - 1, static_cast<unsigned>(std::countr_zero(bits)) / 3);
  };
  std::vector<std::size_t> begin(kRounds, 0);
  for (std::size_t i = 0; i < count; ++i) ++begin[roundOf(i)];
  exclusiveScan(begin);
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i) order[begin[roundOf(i)]++] = i;
  return order;
}

Triangulation triangulate(std::span<const Vec3> points, Index realCount) {
  Triangulation triangulation;
  Triangulation::Cell_handle hint;
  for (const std::size_t i : insertionOrder(points.size(), static_cast<std::size_t>(realCount))) {
    const std::size_t before = triangulation.number_of_vertices();
    const auto vertex = triangulation.insert(Kernel::Point_3(points[i].x(), points[i].y(), points[i].z()), hint);
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
  const Triangulation triangulation = triangulate(points, realCount);

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
  if (input.empty()) return {};  // CGAL would take a reference to the first point
  std::vector<Kernel::Point_3> points;
  points.reserve(input.size());
  for (const Vec3& p : input) points.emplace_back(p.x(), p.y(), p.z());
  using Traits = CGAL::Spatial_sort_traits_adapter_3<Kernel, CGAL::Pointer_property_map<Kernel::Point_3>::const_type>;
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  CGAL::hilbert_sort(order.begin(), order.end(), Traits(CGAL::make_property_map(std::as_const(points))));
  return {order.begin(), order.end()};
}

}  // namespace voroform::voronoi
