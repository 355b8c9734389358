// The interface of implicit forms.
#pragma once

#include <memory>
#include <span>

#include "voroform/core/types.hpp"

namespace voroform::implicit {

// f : ℝ³ → ℝ, negative inside the solid, zero on its surface S, positive outside; f = 0 counts as outside. All members
// are const and safe to call from many threads at once, and depend on their arguments alone.
class ImplicitFunction {
 public:
  ImplicitFunction() = default;
  ImplicitFunction(const ImplicitFunction&) = delete;
  ImplicitFunction& operator=(const ImplicitFunction&) = delete;
  virtual ~ImplicitFunction() = default;

  virtual double value(const Vec3& p) const = 0;
  // Gradient of f; where f is not smooth, that of one of its smooth pieces. Points outward near S.
  virtual Vec3 gradient(const Vec3& p) const = 0;
  // A box that surely contains the solid {f < 0}.
  virtual Box3 bounds() const = 0;
  // Values at many points; the same as value() at each. Fastest if neighbors in the list are neighbors in space.
  virtual void values(std::span<const Vec3> points, std::span<double> out) const;

  // The inside oracle: a number c with |c| ≤ distance from p to S and the sign of f(p) wherever c ≠ 0: negative surely
  // inside, positive surely outside, 0 ask f. It may never contradict f.
  virtual double clearance(const Vec3& p) const { return static_cast<void>(p), 0.0; }
  virtual void clearances(std::span<const Vec3> points, std::span<double> out) const;

  // True where S at (or near) p is the envelope that closes an open scan, not a measured surface.
  virtual bool onEnvelope(const Vec3& p) const { return static_cast<void>(p), false; }
};

using ImplicitPtr = std::shared_ptr<const ImplicitFunction>;

}  // namespace voroform::implicit
