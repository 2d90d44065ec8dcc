// SPDX-License-Identifier: BSD-3-Clause
// The shape of a rigid tool for contact without friction: its signed distance and the derivatives
// of it. For a tool that has its centre at p and does not turn, the gap at a place x of the body is
//
//   g(x) = d(x − p),   d > 0 outside the tool, 0 on its surface, < 0 inside,
//
// and contact adds ∫ ψ(g) dA to the energy. The residual needs d and ∇d, the stiffness ∇²d, and the
// third derivative of the energy ∇³d. ψ is C³, so d is C³ too, wherever the surface of the body may
// come: in the band −depth() ≤ d ≤ the thickness of the layer in which contact acts. The distance
// to most shapes is not: where a cylinder becomes a cap its curvature jumps, and at an edge it is
// infinite. Such a shape gives a smooth function instead, which is the distance up to error().
//
// The gradient of a smooth function that stands for a distance is of unit length only up to that
// error. The force of contact is the gradient of the energy nevertheless, so no work is lost.
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "base/types.h"

namespace palpate {

/// The shape of a tool about its centre. It does not change once it is made, and may be evaluated
/// by several threads at once.
class RigidShape {
 public:
  /// The distance at a place and its derivatives.
  struct Jet {
    /// m; positive outside.
    double value = 0;
    /// [3], towards the outside.
    Vec3 gradient = Vec3::Zero();
    /// [3 × 3], 1/m.
    Mat3 hessian = Mat3::Zero();
    /// The third derivatives in the order xxx, xxy, xxz, xyy, xyz, xzz, yyy, yyz, yzz, zzz [10],
    /// 1/m².
    Eigen::Matrix<double, 10, 1> third = Eigen::Matrix<double, 10, 1>::Zero();
  };

  virtual ~RigidShape() = default;

  /// Evaluates the distance at a place about the tool's centre, m.
  ///
  /// In the band it is C³. Farther out it is a lower bound of the distance up to error(), and at
  /// least the thickness of the band less error(): there is no contact. Its derivatives there may
  /// be zero. Deeper inside than depth() it is negative and need not be smooth; the gradient leads
  /// out of the tool, except where several ways out are about equally short.
  /// @param order The order of the highest derivative that is wanted, 0 … 3. Higher derivatives are
  ///   zero.
  /// @returns Finite up to 1e50 m away; where the place is not finite, the value is not either.
  [[nodiscard]] virtual Jet evaluate(const Vec3& place, int order = 3) const noexcept = 0;
  [[nodiscard]] virtual double value(const Vec3& place) const noexcept {
    return evaluate(place, 0).value;
  }
  /// A lower bound of value() in a box, up to twice error().
  /// @param axes Its sides point along the columns. @param half Half of their lengths, m.
  [[nodiscard]] virtual double least_in_box(const Vec3& centre, const Mat3& /*axes*/,
                                            const Vec3& half) const noexcept {
    return value(centre) - half.norm();
  }

  /// The box around the tool's surface about its centre, m.
  [[nodiscard]] virtual Eigen::AlignedBox3d bounds() const noexcept = 0;
  /// The radius of the smallest sphere about the tool's centre that holds the tool, m.
  [[nodiscard]] virtual double bounding_radius() const noexcept = 0;
  /// The largest difference between value() and the distance in the band, m; 0 where it is exact.
  [[nodiscard]] virtual double error() const noexcept = 0;
  /// How deep inside the tool the band ends, m.
  [[nodiscard]] virtual double depth() const noexcept = 0;
  /// A ball about a place from the tool's centre, m. Its radius may be 0.
  struct Ball {
    Vec3 centre = Vec3::Zero();
    double radius = 0;
  };
  /// Balls in the tool that come near to all of its surface: within a hundredth of the radius for a
  /// capsule, and within a fifth of the bounding radius for another shape. They tell how deep it is
  /// in a body.
  [[nodiscard]] virtual std::vector<Ball> balls() const = 0;
  /// Places in the tool, about its centre, that are as far from its surface as any around them, m:
  /// along the segment of a capsule, or along the middle of another shape where that is deeper than
  /// the band. A surface that the tool's surface presses does not come to them.
  [[nodiscard]] virtual std::vector<Vec3> inner_places() const = 0;
  /// For messages: "a sphere of radius 0.01 m".
  [[nodiscard]] virtual std::string description() const = 0;

 protected:
  RigidShape() = default;
  RigidShape(const RigidShape&) = default;
  RigidShape& operator=(const RigidShape&) = default;
};

/// Several tools, and the threads that solve for them, may share one shape.
using RigidShapePtr = std::shared_ptr<const RigidShape>;

}  // namespace palpate
