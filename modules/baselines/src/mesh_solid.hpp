// Delaunay refinement proper: the only place that knows CGAL's Mesh_3.
#pragma once

#include "tetrahedra.hpp"
#include "voroform/baselines/delaunay_refinement.hpp"
#include "voroform/implicit/implicit_function.hpp"

namespace voroform::baselines {

// Runs on one thread, cannot be interrupted, sets CGAL's error handling and random numbers for the whole process: to be
// called in a process of its own. Throws MethodError if it finds no surface or makes no tetrahedron, and what CGAL and
// f throw.
Tetrahedra meshSolid(const implicit::ImplicitFunction& f, const DelaunayOptions& options);

}  // namespace voroform::baselines
