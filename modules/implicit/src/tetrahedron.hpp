// The geometry of one tetrahedron of a form.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "voroform/implicit/tetrahedral_form.hpp"

namespace voroform::implicit {

// Edges from the last vertex, and six times the volume. Everything is computed from differences of coordinates, so the
// errors scale with the tetrahedron and not with its distance from the origin.
struct TetrahedronFrame {
  TetrahedronFrame(const TetrahedralMesh& mesh, Index t) {
    const FormTetrahedron& tetrahedron = mesh.tetrahedra[static_cast<std::size_t>(t)];
    for (std::size_t i = 0; i < 4; ++i) vertex[i] = &mesh.vertices[static_cast<std::size_t>(tetrahedron.vertices[i])];
    const Vec3& apex = vertex[3]->position;
    edge0 = vertex[0]->position - apex;
    edge1 = vertex[1]->position - apex;
    edge2 = vertex[2]->position - apex;
    cross12 = edge1.cross(edge2);
    // Positive for (b−a)·((c−a)×(d−a)) > 0, seen from the last vertex the other way round.
    determinant = -edge0.dot(cross12);
  }

  // Six times the signed volumes that p spans with each face, in the order of the opposite vertices.
  std::array<double, 4> subvolumes(const Vec3& p) const {
    const Vec3 toPoint = p - vertex[3]->position;
    const Vec3 crossPoint0 = toPoint.cross(edge0);
    const double s0 = -toPoint.dot(cross12);
    const double s1 = crossPoint0.dot(edge2);
    const double s2 = -crossPoint0.dot(edge1);
    return {s0, s1, s2, determinant - s0 - s1 - s2};
  }

  double lengthCubed() const {
    const double squared = std::max({edge0.squaredNorm(), edge1.squaredNorm(), edge2.squaredNorm()});
    return squared * std::sqrt(squared);
  }

  // So flat that directions computed from it mean little.
  bool isFlat() const { return !(determinant > 1e-6 * lengthCubed()); }

  Vec3 gradient() const {
    const double last = vertex[3]->value;
    const Vec3 sum = (vertex[0]->value - last) * cross12 + (vertex[1]->value - last) * edge2.cross(edge0) +
                     (vertex[2]->value - last) * edge0.cross(edge1);
    return -sum / determinant;
  }

  std::array<const FormVertex*, 4> vertex;
  Vec3 edge0;
  Vec3 edge1;
  Vec3 edge2;
  Vec3 cross12;
  double determinant;
};

}  // namespace voroform::implicit
