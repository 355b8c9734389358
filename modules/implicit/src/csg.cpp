// Constructive solid geometry. Clearances combine like the values: where f = max(a, b), a positive clearance of either
// keeps f positive in its ball, and two negative ones keep f negative in the smaller ball; in each case, and where one
// of them is 0 ("ask f"), the larger of the two signed numbers is a valid clearance. For min(a, b) it is the smaller.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "box_distance.hpp"
#include "rounding.hpp"
#include "voroform/core/error.hpp"
#include "voroform/implicit/shapes.hpp"

namespace voroform::implicit {

namespace {

void requireShape(const ImplicitPtr& shape) {
  if (!shape) throw UsageError("a shape is missing");
}

// min(a, b), max(a, b) and max(a, −b).
class Combination final : public ImplicitFunction {
 public:
  enum class Kind { unite, intersect, subtract };

  Combination(Kind kind, ImplicitPtr a, ImplicitPtr b) : kind_(kind), a_(std::move(a)), b_(std::move(b)) {
    requireShape(a_);
    requireShape(b_);
  }

  double value(const Vec3& p) const override { return combine(a_->value(p), b_->value(p)); }
  double clearance(const Vec3& p) const override { return combine(a_->clearance(p), b_->clearance(p)); }

  Vec3 gradient(const Vec3& p) const override {
    if (firstDecides(p)) return a_->gradient(p);
    return kind_ == Kind::subtract ? Vec3(-b_->gradient(p)) : b_->gradient(p);
  }

  Box3 bounds() const override {
    switch (kind_) {
      case Kind::unite:
        return a_->bounds().merged(b_->bounds());
      case Kind::intersect:
        return a_->bounds().intersection(b_->bounds());
      case Kind::subtract:
        break;
    }
    return a_->bounds();
  }

  void values(std::span<const Vec3> points, std::span<double> out) const override {
    std::vector<double> other(points.size());
    a_->values(points, out);
    b_->values(points, other);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = combine(out[i], other[i]);
  }

  bool onEnvelope(const Vec3& p) const override { return firstDecides(p) ? a_->onEnvelope(p) : b_->onEnvelope(p); }

 private:
  double combine(double a, double b) const {
    switch (kind_) {
      case Kind::unite:
        return std::min(a, b);
      case Kind::intersect:
        return std::max(a, b);
      case Kind::subtract:
        break;
    }
    return std::max(a, -b);
  }

  bool firstDecides(const Vec3& p) const {
    const double a = a_->value(p);
    return combine(a, b_->value(p)) == a;
  }

  Kind kind_;
  ImplicitPtr a_;
  ImplicitPtr b_;
};

// f(p) = scale·shape(rotationᵀ(p − translation)/scale): distances scale with the shape, so gradients keep their length.
class Transformed final : public ImplicitFunction {
 public:
  Transformed(ImplicitPtr shape, const Mat3& rotation, const Vec3& translation, double scale)
      : shape_(std::move(shape)), rotation_(rotation), translation_(translation), scale_(scale) {
    requireShape(shape_);
    if (!(scale > 0) || !std::isfinite(scale)) throw UsageError("transformed: the scale must be positive and finite");
    constexpr double kOrthonormal = 1e-9;
    if (!((rotation.transpose() * rotation - Mat3::Identity()).cwiseAbs().maxCoeff() < kOrthonormal)) {
      throw UsageError("transformed: the rotation must be orthonormal");
    }
    if (!translation.allFinite()) throw UsageError("transformed: the translation must be finite");
    // A rotation that is orthonormal only to within rounding stretches lengths by as much.
    stretch_ = (rotation.transpose() * rotation - Mat3::Identity()).norm();
  }

  double value(const Vec3& p) const override { return scale_ * shape_->value(toShape(p)); }
  Vec3 gradient(const Vec3& p) const override { return rotation_ * shape_->gradient(toShape(p)); }
  bool onEnvelope(const Vec3& p) const override { return shape_->onEnvelope(toShape(p)); }

  double clearance(const Vec3& p) const override {
    const double distance = scale_ * shape_->clearance(toShape(p)) * (1 - stretch_);
    return shrunk(distance, roundingMargin(p.norm() + translation_.norm()));
  }

  Box3 bounds() const override {
    const Box3 box = shape_->bounds();
    if (box.isEmpty()) return box;
    Box3 result;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 local = box.corner(static_cast<Box3::CornerType>(corner));
      result.extend(rotation_ * (scale_ * local) + translation_);
    }
    return inflated(result);
  }

  void values(std::span<const Vec3> points, std::span<double> out) const override {
    std::vector<Vec3> local(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) local[i] = toShape(points[i]);
    shape_->values(local, out);
    for (double& value : out) value *= scale_;
  }

 private:
  Vec3 toShape(const Vec3& p) const { return rotation_.transpose() * (p - translation_) / scale_; }

  ImplicitPtr shape_;
  Mat3 rotation_;
  Vec3 translation_;
  double scale_;
  double stretch_ = 0;
};

class Enveloped final : public ImplicitFunction {
 public:
  Enveloped(ImplicitPtr form, const Box3& box) : form_(std::move(form)), box_(box) {
    requireShape(form_);
    if (box.isEmpty() || !box.sizes().allFinite()) throw UsageError("enveloped: the box must be finite and not empty");
  }

  double value(const Vec3& p) const override { return std::max(form_->value(p), boxDistance(box_, p)); }
  double clearance(const Vec3& p) const override { return std::max(form_->clearance(p), boxClearance(box_, p)); }
  Vec3 gradient(const Vec3& p) const override { return onBox(p) ? boxGradient(box_, p) : form_->gradient(p); }
  Box3 bounds() const override { return form_->bounds().intersection(inflated(box_)); }
  // Compares distances, to first order: the scale of the form's values is arbitrary, and points of interest lie near S
  // only, not on it.
  bool onEnvelope(const Vec3& p) const override {
    const double slope = form_->gradient(p).norm();
    const double boxValue = boxDistance(box_, p) * (slope > 0 ? slope : 1);
    return boxValue >= form_->value(p) || form_->onEnvelope(p);
  }

  void values(std::span<const Vec3> points, std::span<double> out) const override {
    form_->values(points, out);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::max(out[i], boxDistance(box_, points[i]));
  }

  void clearances(std::span<const Vec3> points, std::span<double> out) const override {
    form_->clearances(points, out);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = std::max(out[i], boxClearance(box_, points[i]));
  }

 private:
  bool onBox(const Vec3& p) const { return boxDistance(box_, p) >= form_->value(p); }

  ImplicitPtr form_;
  Box3 box_;
};

}  // namespace

ImplicitPtr unionOf(ImplicitPtr a, ImplicitPtr b) {
  return std::make_shared<Combination>(Combination::Kind::unite, std::move(a), std::move(b));
}

ImplicitPtr intersectionOf(ImplicitPtr a, ImplicitPtr b) {
  return std::make_shared<Combination>(Combination::Kind::intersect, std::move(a), std::move(b));
}

ImplicitPtr differenceOf(ImplicitPtr a, ImplicitPtr b) {
  return std::make_shared<Combination>(Combination::Kind::subtract, std::move(a), std::move(b));
}

ImplicitPtr transformed(ImplicitPtr shape, const Mat3& rotation, const Vec3& translation, double scale) {
  return std::make_shared<Transformed>(std::move(shape), rotation, translation, scale);
}

ImplicitPtr enveloped(ImplicitPtr form, const Box3& box) { return std::make_shared<Enveloped>(std::move(form), box); }

}  // namespace voroform::implicit
