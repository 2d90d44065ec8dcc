// SPDX-License-Identifier: BSD-3-Clause
// A rigid tool that presses the surface of a body without friction. It has three parts, none of
// which depends on the others: its shape (rigid_shape.h) gives d, the signed distance to the tool;
// its pose (pose_map.h) gives y, where a point x of the surface is in the tool's own axes, for the
// coordinates q of the tool; the law of contact (contact_law.h) gives ψ, the energy of an area at a
// distance.
//
//   Φ(u; q) = ∫_Γ₀ ψ(d(y)) s dA₀
//
// over the surface at rest.
//
// The part of the law's layer that is not pressed in, e = δ − o − 5/6 ∫ h p dA / ∫ p dA with h = δ
// − g, makes the tool feel as if it were deeper by e than it is. The factor 5/6 turns the mean,
// which is weighted by pressure, into the one that determines the force: with Hertz's pressure, by
// the principle of complementary energy, e is δ − o − ¾ δ (p₀/κ)^{1/3}.
//
// The far side of a thin lobe may lie in the layer too, or in the tool. It is recognised by the
// direction in which it looks: with c = −m·∇d, where m is the normal of the face at rest in the
// tool's axes, s is 1 where c ≥ 0, as on every face that looks towards the tool, and falls smoothly
// to 0 where it looks away by 30° or more.
#pragma once

#include <memory>

#include "assembly/contact_law.h"
#include "interaction/contact_surface.h"
#include "interaction/interaction.h"
#include "interaction/pose_map.h"
#include "interaction/rigid_shape.h"

namespace palpate {

class RigidContact final : public Interaction {
 public:
  /// @throws InputError a thickness or stiffness that is not positive.
  RigidContact(std::shared_ptr<const ContactSurface> surface, RigidShapePtr shape, ContactLaw law,
               PoseMapPtr pose = translated_pose());

  [[nodiscard]] const RigidShape& shape() const { return *shape_; }
  [[nodiscard]] const PoseMap& pose() const { return *pose_; }
  [[nodiscard]] const PoseMapPtr& pose_ptr() const { return pose_; }
  [[nodiscard]] const RigidShapePtr& shape_ptr() const { return shape_; }
  [[nodiscard]] const ContactSurface& surface() const { return *surface_; }
  [[nodiscard]] const std::shared_ptr<const ContactSurface>& surface_ptr() const {
    return surface_;
  }
  [[nodiscard]] const ContactLaw& law() const { return law_; }

  [[nodiscard]] std::unique_ptr<Interaction> clone() const override;
  [[nodiscard]] Index num_coordinates() const override { return pose_->num_coordinates(); }
  [[nodiscard]] Eigen::VectorXd coordinates(const Vec3& place) const override {
    return pose_->coordinates(place);
  }
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& q) const override;
  [[nodiscard]] std::string describe(const Eigen::VectorXd& q) const override;
  [[nodiscard]] double longest_step() const override { return longest_step_; }
  [[nodiscard]] std::vector<Vec3> inner_places(const Eigen::VectorXd& q) const override;
  [[nodiscard]] bool has_potential() const override { return true; }
  [[nodiscard]] double potential(const Eigen::VectorXd& q, const NodalVector& state,
                                 NodalVector& force, Eigen::VectorXd& of_q) const override;
  void add_hessian(const Eigen::VectorXd& q, const NodalVector& state,
                   PotentialHessian& hessian) const override;
  [[nodiscard]] PressedSurface pressed_surface(const Eigen::VectorXd& q,
                                               const NodalVector& state) const override;

  /// The part of the body that a tool at q touches.
  struct Patch {
    /// The pressure at each point of the mesh, Pa: the mean over the surface around it.
    std::vector<double> pressure;
    /// The area at rest on which there is pressure, m².
    double area = 0;
    /// The longest edge of a face on which there is pressure, m; 0: nothing is touched.
    double longest_edge = 0;
    /// e: how much deeper the tool seems to be than it is, m; 0 where nothing is touched.
    double layer_depth = 0;
  };
  [[nodiscard]] Patch patch(const Eigen::VectorXd& q, const NodalVector& state) const;

 private:
  /// φ = ψ s of a point of integration and its derivatives by y and m, in the tool's axes.
  struct Point {
    double value = 0;
    Vec3 by_y = Vec3::Zero();
    Vec3 by_m = Vec3::Zero();
    Mat3 by_yy = Mat3::Zero();
    Mat3 by_ym = Mat3::Zero();
    Mat3 by_mm = Mat3::Zero();
  };
  /// @returns False where φ is zero.
  bool evaluate(const Vec3& y, const Vec3& m, bool with_hessian, Point& point) const;
  /// Calls visit(face, number of the point, y, φ) for each point of integration where φ is not
  /// zero.
  template <class Visit>
  void for_each_touched_point(const PoseJet& pose, const NodalVector& state, bool with_hessian,
                              Visit&& visit) const;

  std::shared_ptr<const ContactSurface> surface_;
  RigidShapePtr shape_;
  ContactLaw law_;
  PoseMapPtr pose_;
  double longest_step_;
};

/// The part of a force that is the error of the layer, N; positive: the force is larger than with a
/// hard tool. With the stiffness k along the force F, a sphere that obeys Hertz's law F ~ d^{3/2}
/// is at the depth d = 3/2 F/k, which is too large by e.
/// @param layer_depth e, see RigidContact::Patch.
/// @param stiffness Derivative of the force by the place of the tool, N/m.
/// @returns NaN where the tool has no stiffness along the force, as where it slides off.
[[nodiscard]] double contact_layer_force(double layer_depth, const Vec3& force,
                                         const Mat3& stiffness);

}  // namespace palpate
