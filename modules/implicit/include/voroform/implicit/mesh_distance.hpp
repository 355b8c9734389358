// The signed distance to a closed triangle mesh as an implicit form.
#pragma once

#include <memory>

#include "voroform/core/run_context.hpp"
#include "voroform/implicit/implicit_function.hpp"
#include "voroform/mesh/polyhedral_complex.hpp"

namespace voroform::implicit {

// Negative inside. Exact distance by a tree of boxes; sign by the angle-weighted pseudonormal of the nearest feature
// (Bærentzen & Aanæs 2005), so the mesh must be closed, 2-manifold and outward (mesh::readSolidMesh). Next to triangles
// without area, which have no normal, the sign is that of the parity of a ray. The gradient is the unit vector away
// from the nearest point (the pseudonormal where the distance vanishes). values() is the fast way to evaluate;
// clearance() answers from a grid of 192 voxels along the longest side.
//
// A mesh that intersects itself is warned of; its solid is that of the even-odd rule, and every sign costs a ray.
// Throws InputError for a mesh without triangles.
ImplicitPtr meshDistance(std::shared_ptr<const mesh::TriangleMesh> mesh, const RunContext& context);

}  // namespace voroform::implicit
