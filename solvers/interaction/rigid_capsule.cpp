// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/rigid_capsule.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/quantity.h"
#include "interaction/shape_kind.h"

namespace palpate {
namespace {

/// The share of the radius below which the root is continued by a polynomial. The core is deep
/// enough not to affect contact, and wide enough to bound the curvature in it.
constexpr double kCore = 0.1;
/// The share of the radius down to which the error is stated. At that depth the error is 4/3 of
/// that on the surface.
constexpr double kDepth = 0.25;
/// The number of places along half a seam at which the error is evaluated.
constexpr int kNumErrorPlaces = 1000;

/// A function of one variable with its first three derivatives.
struct Derivatives {
  double f, df, ddf, dddf;
};

/// √q, and below core² its Taylor polynomial there.
Derivatives soft_root(double q, double core) {
  if (q > core * core) {
    const double r = std::sqrt(q);
    return {r, 1 / (2 * r), -1 / (4 * r * q), 3 / (8 * r * q * q)};
  }
  const double x = q / (core * core) - 1;
  const double c3 = core * core * core;
  return {core * (1 + x * (1.0 / 2 + x * (-1.0 / 8 + x / 16))),
          (1.0 / 2 + x * (-1.0 / 4 + x * 3 / 16)) / core, (-1.0 / 4 + x * 3 / 8) / c3,
          3.0 / 8 / (c3 * core * core)};
}

/// The ramp that is 0 below −width/2 and x above width/2.
Derivatives soft_ramp(double x, double width) {
  if (x <= -width / 2) return {0, 0, 0, 0};
  if (x >= width / 2) return {x, 1, 0, 0};
  const double t = x / width + 0.5;
  const double t2 = t * t;
  const double v = 1 - t;
  return {width * t2 * t2 * (2.5 - 3 * t + t2), t2 * t * (10 - 15 * t + 6 * t2),
          30 * t2 * v * v / width, 60 * t * v * (1 - 2 * t) / (width * width)};
}

class RoundedSegment final : public RigidShape {
 public:
  explicit RoundedSegment(const Capsule& capsule)
      : radius_(capsule.radius),
        half_length_(capsule.length / 2),
        width_(capsule.seam * capsule.radius),
        axis_(capsule.axis.normalized()),
        error_(find_error()) {}

  Jet evaluate(const Vec3& place, int order) const noexcept override;
  // The search for the nearest place of a body asks for nothing else, and often.
  double value(const Vec3& place) const noexcept override {
    const double s = axis_.dot(place);
    const double u = beyond(s).f;
    const double q = (place - s * axis_).squaredNorm() + u * u;
    const double core = kCore * radius_;
    return (q > core * core ? std::sqrt(q) : soft_root(q, core).f) - radius_;
  }

  // The distance is a convex function: it lies above its tangents. The core only adds to it.
  double least_in_box(const Vec3& centre, const Mat3& axes,
                      const Vec3& half) const noexcept override {
    const double s = axis_.dot(centre);
    const Vec3 across = centre - s * axis_;
    const Derivatives u = beyond(s);
    const double q = across.squaredNorm() + u.f * u.f;
    const double core = kCore * radius_;
    if (q <= core * core) return -radius_;
    const double distance = std::sqrt(q);
    const Vec3 gradient = (across + u.f * u.df * axis_) / distance;
    return distance - radius_ - (axes.transpose() * gradient).cwiseAbs().dot(half);
  }

  Eigen::AlignedBox3d bounds() const noexcept override {
    const Vec3 corner = half_length_ * axis_.cwiseAbs() + Vec3::Constant(radius_);
    return {-corner, corner};
  }
  double bounding_radius() const noexcept override { return half_length_ + radius_; }
  double error() const noexcept override { return error_; }
  double depth() const noexcept override { return kDepth * radius_; }
  std::vector<Ball> balls() const override;
  std::vector<Vec3> inner_places() const override;
  std::string description() const override {
    if (half_length_ == 0) return "a sphere of radius " + quantity(radius_, "m");
    return "a capsule of radius " + quantity(radius_, "m") + " and length " +
           quantity(2 * half_length_, "m");
  }

 private:
  /// How far a place at s along the axis is beyond the end of the segment, with sign.
  Derivatives beyond(double s) const noexcept;
  double find_error() const;

  double radius_;
  double half_length_;
  double width_;
  Vec3 axis_;
  double error_;
};

Derivatives RoundedSegment::beyond(double s) const noexcept {
  if (half_length_ == 0) return {s, 1, 0, 0};
  const Derivatives above = soft_ramp(s - half_length_, width_);
  const Derivatives below = soft_ramp(-s - half_length_, width_);
  return {above.f - below.f, above.df + below.df, above.ddf - below.ddf, above.dddf + below.dddf};
}

/// At one place along the axis the error is largest where the distance is least.
double RoundedSegment::find_error() const {
  if (half_length_ == 0) return 0;
  const double least = (1 - kDepth) * radius_;
  double error = 0;
  for (int i = 0; i <= kNumErrorPlaces; ++i) {
    const double s = half_length_ + width_ * (static_cast<double>(i) / kNumErrorPlaces - 0.5);
    const double u = beyond(s).f;
    const double exact = std::max(std::abs(s) - half_length_, 0.0);
    error = std::max(error, std::sqrt(least * least + u * u - exact * exact) - least);
  }
  return error;
}

std::vector<RigidShape::Ball> RoundedSegment::balls() const {
  // Place them a quarter of the radius apart, so that less than a hundredth of the radius is left
  // between them.
  const int gaps = static_cast<int>(std::ceil(8 * half_length_ / radius_));
  std::vector<Ball> balls;
  for (int i = 0; i <= gaps; ++i) {
    const double s = gaps == 0 ? 0 : half_length_ * (2.0 * i / gaps - 1);
    balls.push_back({s * axis_, radius_});
  }
  return balls;
}

std::vector<Vec3> RoundedSegment::inner_places() const {
  std::vector<Vec3> places;
  for (const Ball& ball : balls()) places.push_back(ball.centre);
  return places;
}

// With b = ∇Q/2 and ∇b = I + β a aᵀ the derivatives are
//   ∇d = 2f′ b,   ∇²d = 4f″ b bᵀ + 2f′ ∇b,
//   ∇³d = 8f‴ b⊗b⊗b + 4f″ (b_i ∇b_jk + b_j ∇b_ik + b_k ∇b_ij) + 2f′ β′ a⊗a⊗a,   f = √.
RigidShape::Jet RoundedSegment::evaluate(const Vec3& place, int order) const noexcept {
  Jet jet;
  const double s = axis_.dot(place);
  const Vec3 across = place - s * axis_;
  const Derivatives u = beyond(s);
  const Derivatives root = soft_root(across.squaredNorm() + u.f * u.f, kCore * radius_);
  jet.value = root.f - radius_;
  if (order < 1) return jet;
  const Vec3 b = across + u.f * u.df * axis_;
  jet.gradient = 2 * root.df * b;
  if (order < 2) return jet;
  const Mat3 db = Mat3::Identity() + (u.df * u.df + u.f * u.ddf - 1) * axis_ * axis_.transpose();
  jet.hessian = 4 * root.ddf * b * b.transpose() + 2 * root.df * db;
  if (order < 3) return jet;
  const double along = 2 * root.df * (3 * u.df * u.ddf + u.f * u.dddf);
  int place_in_third = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      for (int k = j; k < 3; ++k) {
        jet.third[place_in_third++] =
            8 * root.dddf * b[i] * b[j] * b[k] +
            4 * root.ddf * (b[i] * db(j, k) + b[j] * db(i, k) + b[k] * db(i, j)) +
            along * axis_[i] * axis_[j] * axis_[k];
      }
    }
  }
  return jet;
}

void check(const char* what, double length, bool zero_is_good) {
  if (std::isfinite(length) && (length > 0 || (zero_is_good && length == 0))) return;
  throw InputError("The " + std::string(what) + " of the tool is " + quantity(length, "m") +
                   ". Give a length in m that is " +
                   (zero_is_good ? "0 or more." : "larger than 0."));
}

}  // namespace

RigidShapePtr make_sphere(double radius) { return make_capsule({radius}); }

RigidShapePtr make_capsule(const Capsule& capsule) {
  check("radius", capsule.radius, false);
  check("length", capsule.length, true);
  if (!(capsule.axis.allFinite() && capsule.axis.stableNorm() > 0)) {
    throw InputError("The axis of the tool is (" + quantity(capsule.axis.x()) + ", " +
                     quantity(capsule.axis.y()) + ", " + quantity(capsule.axis.z()) +
                     "), which is no direction. Give a vector along the tool.");
  }
  if (!(std::isfinite(capsule.seam) && capsule.seam > 0)) {
    throw InputError("The seam of the tool is " + quantity(capsule.seam) +
                     " of its radius wide. Give a share that is larger than 0.");
  }
  return std::make_shared<RoundedSegment>(capsule);
}

namespace {

class SphereKind final : public ShapeKind {
 public:
  SphereKind() = default;
  [[nodiscard]] ToolShape number() const override { return ToolShape::sphere; }
  [[nodiscard]] double half_width(const RigidTool& tool) const override { return tool.radius; }
  [[nodiscard]] double reach(const RigidTool& tool, const Vec3& /*direction*/) const override {
    return tool.radius;
  }
  [[nodiscard]] std::string name(const RigidTool& tool) const override {
    return "the sphere of radius " + quantity(tool.radius, "m");
  }
  [[nodiscard]] RigidShapePtr make(const RigidTool& tool) const override {
    return make_sphere(tool.radius);
  }
};

class CapsuleKind final : public ShapeKind {
 public:
  CapsuleKind() = default;
  [[nodiscard]] ToolShape number() const override { return ToolShape::capsule; }
  [[nodiscard]] double half_width(const RigidTool& tool) const override { return tool.radius; }
  [[nodiscard]] double reach(const RigidTool& tool, const Vec3& direction) const override {
    return tool.radius + 0.5 * tool.length * std::abs(tool.axis.normalized().dot(direction));
  }
  [[nodiscard]] std::string name(const RigidTool& tool) const override {
    return "the capsule of radius " + quantity(tool.radius, "m") + " and length " +
           quantity(tool.length, "m");
  }
  [[nodiscard]] RigidShapePtr make(const RigidTool& tool) const override {
    return make_capsule({tool.radius, tool.length, tool.axis});
  }
};

}  // namespace

std::unique_ptr<const ShapeKind> sphere_kind() { return std::make_unique<SphereKind>(); }
std::unique_ptr<const ShapeKind> capsule_kind() { return std::make_unique<CapsuleKind>(); }

}  // namespace palpate
