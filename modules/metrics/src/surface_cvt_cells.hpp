// The Voronoi cells of sites on a triangle mesh, restricted to the mesh, by clipping its triangles (Yan et al. 2009).
#pragma once

#include <cstddef>
#include <vector>

#include "voroform/core/run_context.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::metrics {

// What the mesh's triangles are, computed once.
struct Facets {
  std::vector<double> areas;
  std::vector<Vec3> normals;     // unit; zero where the area is
  std::vector<double> areaUpTo;  // of the triangles before the t-th; the last entry is the mesh's area
  double area() const { return areaUpTo.back(); }
};
Facets facetsOf(const mesh::TriangleMesh& mesh, const RunContext& context);

struct SurfaceSites {
  std::vector<Vec3> points;
  std::vector<Index> triangles;  // that the points lie in
};

// The part of a triangle that belongs to a site. Moments are about the site.
struct SurfacePiece {
  Index site = kNone;
  Index triangle = kNone;
  double area = 0;
  Vec3 moment = Vec3::Zero();  // ∫ (x − site) dA
  double energy = 0;           // ∫ ‖x − site‖² dA
};

// The pieces of site i's cell are pieces[offsets[i] … offsets[i + 1]), in the triangles' order.
struct SurfaceCells {
  std::vector<std::size_t> offsets;
  std::vector<SurfacePiece> pieces;
};

// Each triangle is divided among the sites by nearness, in parallel, the same bits for any number of threads. Where
// two sheets lie nearer to each other than the sites, a sheet belongs to its own sites: a triangle goes to sites in
// triangles whose normals are within 120° of its own, if there are any within two spacings of its centroid. `spacing`
// is the sites' about. Of sites at one place the first gets all.
SurfaceCells surfaceCells(const mesh::TriangleMesh& mesh, const Facets& facets, const SurfaceSites& sites,
                          double spacing, const RunContext& context);

}  // namespace voroform::metrics
