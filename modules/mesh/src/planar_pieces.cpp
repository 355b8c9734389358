#include "planar_pieces.hpp"

#include <utility>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

namespace voroform::mesh {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
enum class Side : std::uint8_t { unknown, outside, inside };
// What is known of a face.
struct Place {
  Side side = Side::unknown;
};
// A vertex's index among the pieces' points.
struct Number {
  Index value = kNone;
};
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel>;
using FaceBase =
    CGAL::Constrained_triangulation_face_base_2<Kernel, CGAL::Triangulation_face_base_with_info_2<Place, Kernel>>;
using DataStructure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
// Rounded loops may cross where they all but touch: the tag has such crossings inserted as vertices.
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, DataStructure, CGAL::Exact_predicates_tag>;
using FaceHandle = Triangulation::Face_handle;

// Marks the faces that an odd number of constraints lies around, whatever way one takes to them from outside.
void markInside(Triangulation& triangulation) {
  std::vector<std::pair<FaceHandle, Side>> front = {{triangulation.infinite_face(), Side::outside}};
  while (!front.empty()) {
    const auto [face, side] = front.back();
    front.pop_back();
    if (face->info().side != Side::unknown) continue;
    face->info().side = side;
    for (int i = 0; i < 3; ++i) {
      const Side other = side == Side::inside ? Side::outside : Side::inside;
      front.emplace_back(face->neighbor(i), face->is_constrained(i) ? other : side);
    }
  }
}

class Cutter {
 public:
  Cutter(const PlanarTessellation& tessellation, PlanarPieces& pieces) : tessellation_(tessellation), pieces_(pieces) {}

  void add(Index cell) {
    const std::size_t first = tessellation_.firstLoop(cell);
    const std::size_t end = tessellation_.endLoop(cell);
    bool hasHole = false;
    // A cell of one loop has none, whatever rounding makes of a tiny loop's direction.
    for (std::size_t l = first; l < end && end - first > 1; ++l) hasHole = hasHole || isClockwise(l);
    if (hasHole) {
      addTriangles(cell);
      return;
    }
    for (std::size_t l = first; l < end; ++l) {
      for (const Index v : tessellation_.loop(l)) pieces_.connectivity.push_back(v);
      endPiece(cell);
    }
  }

 private:
  const Vec2& vertex(Index v) const { return tessellation_.vertices[static_cast<std::size_t>(v)]; }

  bool isClockwise(std::size_t l) const {
    const auto loop = tessellation_.loop(l);
    double twiceArea = 0;
    for (std::size_t k = 2; k < loop.size(); ++k) {
      const Vec2 a = vertex(loop[k - 1]) - vertex(loop[0]);
      const Vec2 b = vertex(loop[k]) - vertex(loop[0]);
      twiceArea += a.x() * b.y() - a.y() * b.x();
    }
    return twiceArea < 0;
  }

  void addTriangles(Index cell) {
    Triangulation triangulation;
    for (std::size_t l = tessellation_.firstLoop(cell); l < tessellation_.endLoop(cell); ++l) {
      std::vector<Triangulation::Vertex_handle> handles;
      for (const Index v : tessellation_.loop(l)) {
        handles.push_back(triangulation.insert(Kernel::Point_2(vertex(v).x(), vertex(v).y())));
        handles.back()->info().value = v;
      }
      for (std::size_t k = 0; k < handles.size(); ++k) {
        const auto next = handles[(k + 1) % handles.size()];
        if (handles[k] != next) triangulation.insert_constraint(handles[k], next);
      }
    }
    markInside(triangulation);
    for (const auto& face : triangulation.finite_face_handles()) {
      if (face->info().side != Side::inside) continue;
      for (int i = 0; i < 3; ++i) pieces_.connectivity.push_back(numberOf(*face->vertex(i)));
      endPiece(cell);
    }
  }

  Index numberOf(Triangulation::Vertex& at) {
    if (at.info().value == kNone) {
      at.info().value = static_cast<Index>(pieces_.points.size());
      pieces_.points.emplace_back(at.point().x(), at.point().y());
    }
    return at.info().value;
  }

  void endPiece(Index cell) {
    pieces_.ends.push_back(static_cast<std::int64_t>(pieces_.connectivity.size()));
    pieces_.cells.push_back(cell);
  }

  const PlanarTessellation& tessellation_;
  PlanarPieces& pieces_;
};

}  // namespace

PlanarPieces planarPieces(const PlanarTessellation& tessellation) {
  PlanarPieces pieces;
  pieces.points = tessellation.vertices;
  Cutter cutter(tessellation, pieces);
  for (Index cell = 0; cell < tessellation.cellCount(); ++cell) cutter.add(cell);
  return pieces;
}

}  // namespace voroform::mesh
