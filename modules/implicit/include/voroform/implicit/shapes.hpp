// Analytic shapes and their combinations.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "voroform/implicit/implicit_function.hpp"

namespace voroform::implicit {

// Shapes centered at the origin. Each gives a clearance from a Lipschitz bound of its f.
ImplicitPtr sphere(double radius);
ImplicitPtr torus(double majorRadius, double minorRadius);  // axis z
ImplicitPtr box(const Vec3& edges);
ImplicitPtr ellipsoid(const Vec3& semiAxes);
ImplicitPtr bumpySphere();  // r − 1 − 0.12·sin 6nₓ·sin 6n_y·sin 6n_z, n = p/r
ImplicitPtr gyroidBall();   // max(|p| − 1, sin 7x cos 7y + sin 7y cos 7z + sin 7z cos 7x)
ImplicitPtr twoTori();      // two linked tori, R 0.7, r 0.2, centers (∓0.35, 0, 0), axes z and y

// The named shapes of the command line: sphere, torus, box, ellipsoid, bumpy-sphere, gyroid-ball, two-tori.
std::vector<std::string> shapeNames();
// Throws UsageError, listing the names, for an unknown one.
ImplicitPtr namedShape(std::string_view name);

// Constructive solid geometry.
ImplicitPtr unionOf(ImplicitPtr a, ImplicitPtr b);
ImplicitPtr intersectionOf(ImplicitPtr a, ImplicitPtr b);
ImplicitPtr differenceOf(ImplicitPtr a, ImplicitPtr b);
// x ↦ rotation·(scale·x) + translation applied to the solid; scale > 0, rotation orthonormal.
ImplicitPtr transformed(ImplicitPtr shape, const Mat3& rotation, const Vec3& translation, double scale = 1);

// f := max(f, signed distance to the box); faces on the box are envelope (onEnvelope).
ImplicitPtr enveloped(ImplicitPtr form, const Box3& box);

}  // namespace voroform::implicit
