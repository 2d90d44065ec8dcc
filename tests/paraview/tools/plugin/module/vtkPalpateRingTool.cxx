// SPDX-License-Identifier: BSD-3-Clause
#include "vtkPalpateRingTool.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "interaction/rigid_shape.h"
#include "interaction/rigid_tool.h"
#include "interaction/shape_kind.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkPalpateRingTool);

namespace {
using palpate::Mat3;
using palpate::Vec3;

constexpr auto Ring = static_cast<palpate::ToolShape>(100);
constexpr int NumberOfBalls = 48;

/// With s along the axis a and ρ across it, w = ρ − R and h = (w² + s²)/2, d = √(2h) − r. Of ρ,
/// with e its direction and P = I − a aᵀ − e eᵀ, ∇ρ = e, ∇²ρ = P/ρ.
class RingShape final : public palpate::RigidShape {
 public:
  RingShape(double radius, double ringRadius, const Vec3& axis)
      : Radius(radius), RingRadius(ringRadius), Axis(axis.normalized()) {}

  Jet evaluate(const Vec3& place, int order) const noexcept override {
    constexpr double tiny = 1e-12;  // m
    const double s = this->Axis.dot(place);
    const Vec3 across = place - s * this->Axis;
    const double rho = std::max(across.norm(), tiny);
    const double w = rho - this->RingRadius;
    const double root = std::max(std::hypot(w, s), tiny);
    Jet jet;
    jet.value = root - this->Radius;
    if (order < 1) {
      return jet;
    }
    const Vec3 e = across / rho;
    const Vec3 b = w * e + s * this->Axis;
    jet.gradient = b / root;
    if (order < 2) {
      return jet;
    }
    const Mat3 of_e = e * e.transpose();
    const Mat3 of_a = this->Axis * this->Axis.transpose();
    const Mat3 p = Mat3::Identity() - of_a - of_e;
    const Mat3 db = of_e + of_a + w / rho * p;
    jet.hessian = db / root - b * b.transpose() / std::pow(root, 3);
    if (order < 3) {
      return jet;
    }
    int number = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = i; j < 3; ++j) {
        for (int k = j; k < 3; ++k) {
          const double ddb =
              this->RingRadius / (rho * rho) * (e[i] * p(j, k) + e[j] * p(i, k) + e[k] * p(i, j));
          jet.third[number++] =
              ddb / root -
              (b[i] * db(j, k) + b[j] * db(i, k) + b[k] * db(i, j)) / std::pow(root, 3) +
              3 * b[i] * b[j] * b[k] / std::pow(root, 5);
        }
      }
    }
    return jet;
  }

  Eigen::AlignedBox3d bounds() const noexcept override {
    const Vec3 across = (1 - this->Axis.array().square()).max(0).sqrt();
    const Vec3 corner = this->RingRadius * across + Vec3::Constant(this->Radius);
    return {-corner, corner};
  }
  double bounding_radius() const noexcept override { return this->RingRadius + this->Radius; }
  double error() const noexcept override { return 0; }
  double depth() const noexcept override { return 0.5 * this->Radius; }
  std::vector<Ball> balls() const override {
    const Vec3 one = this->Axis.unitOrthogonal();
    const Vec3 other = this->Axis.cross(one);
    std::vector<Ball> balls;
    for (int i = 0; i < NumberOfBalls; ++i) {
      const double angle = 2 * M_PI * i / NumberOfBalls;
      const Vec3 centre = this->RingRadius * (std::cos(angle) * one + std::sin(angle) * other);
      balls.push_back({centre, this->Radius});
    }
    return balls;
  }
  std::vector<Vec3> inner_places() const override {
    std::vector<Vec3> places;
    for (const Ball& ball : this->balls()) {
      places.push_back(ball.centre);
    }
    return places;
  }
  std::string description() const override { return "a ring"; }

 private:
  double Radius;
  double RingRadius;
  Vec3 Axis;
};

class RingKind final : public palpate::ShapeKind {
 public:
  RingKind() = default;
  palpate::ToolShape number() const override { return Ring; }
  double half_width(const palpate::RigidTool& tool) const override { return tool.radius; }
  double reach(const palpate::RigidTool& tool, const Vec3& direction) const override {
    return tool.radius + tool.length * tool.axis.normalized().cross(direction).norm();
  }
  std::string name(const palpate::RigidTool&) const override { return "the ring"; }
  palpate::RigidShapePtr make(const palpate::RigidTool& tool) const override {
    if (tool.radius > 0) {
      return std::make_shared<const RingShape>(tool.radius, tool.length, tool.axis);
    }
    throw palpate::InputError("The radius of the ring is not larger than 0.");
  }
};

[[maybe_unused]] const bool RingIsKnown =
    (vtkPalpateTool::AddKind(std::make_unique<const RingKind>()), true);
}  // namespace

void vtkPalpateRingTool::DescribeShape(vtkPolyData*, palpate::RigidTool& tool) const {
  tool.shape = Ring;
  tool.radius = this->Radius;
  tool.axis = Vec3(this->Axis);
  tool.length = this->RingRadius;
}
