// SPDX-License-Identifier: BSD-3-Clause
// A rigid tool in numbers that can be stored: its shape, how it is moved, and how it presses.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "interaction/rigid_contact.h"

namespace palpate {

/// The numbers are stored in files: do not change them.
enum class ToolShape : std::int32_t { sphere = 0, capsule = 1, surface = 2 };
enum class ToolMotion : std::int32_t { translated = 0, trocar = 1, turned = 2 };

struct RigidTool {
  ToolShape shape = ToolShape::sphere;
  /// The radius of a sphere or capsule, m.
  double radius = 0;
  /// For a capsule: the direction of its segment, and the length of the segment, m.
  Vec3 axis = Vec3::UnitZ();
  double length = 0;
  /// For a closed surface: its points from the tool's centre, m, and its triangles, see
  /// ToolSurface.
  std::vector<Vec3> points;
  std::vector<std::array<Index, 3>> triangles;
  /// How its coordinates move it, and the numbers of that kind of motion (motion_kind.h).
  ToolMotion motion = ToolMotion::translated;
  std::vector<double> motion_numbers;
  ContactLaw law;

  [[nodiscard]] friend bool operator==(const RigidTool& a, const RigidTool& b) {
    return a.shape == b.shape && a.radius == b.radius && a.axis == b.axis && a.length == b.length &&
           a.points == b.points && a.triangles == b.triangles && a.motion == b.motion &&
           a.motion_numbers == b.motion_numbers && a.law == b.law;
  }
};

/// Defaults of the thickness and the stiffness of contact, in half-widths of the tool and in
/// Young's moduli of the body's surface. If neither is given, the layer is much stiffer and is
/// calibrated: it is drawn back so far that at a depth of kCalibratedDepth half-widths the mean gap
/// of Hertz's contact is 0. Besides the offset, only κ/δ³ matters. It is that of a layer of 0.05
/// half-widths with the usual stiffness, while the points of integration are those of a thicker
/// layer, which are dense enough (tests/benchmark/README.md). A thickness that the user gives is
/// not changed, so that earlier results with it stay valid. A surface that is much larger than it
/// is thick, such as a plate, has a thicker layer, since the grid of its distance would be too
/// large otherwise: its area is kLargestAreaOfThickness squares of the thickness.
inline constexpr double kThicknessOfRadius = 0.2;
inline constexpr double kLargestAreaOfThickness = 5000;
inline constexpr double kStiffnessOfModulus = 2;
inline constexpr double kCalibratedStiffnessOfModulus = 128;
inline constexpr double kCalibratedDepth = 0.07;

/// The radius, or half of the shortest side of the box around a surface, m.
[[nodiscard]] double half_width(const RigidTool& tool);

/// How far the tool reaches from its centre in a direction of unit length, m.
[[nodiscard]] double reach(const RigidTool& tool, const Vec3& direction);

/// The poses of the tool.
/// @throws InputError the numbers of its motion are not those of such a motion.
[[nodiscard]] PoseMapPtr pose_of(const RigidTool& tool);

/// How far the tool reaches from its coordinates q in a direction of unit length, m.
/// @param pose Its pose at q.
[[nodiscard]] double reach_at(const RigidTool& tool, const Pose& pose, const Vec3& q,
                              const Vec3& direction);

/// The rotation of numbers w, x, y and z, of any length above 0.
/// @throws InputError they are none.
[[nodiscard]] Eigen::Quaterniond orientation_of(const std::array<double, 4>& numbers);

/// Turns a tool, see MotionKind::turn() and orientation_of().
void turn(RigidTool& tool, const std::array<double, 4>& orientation);

/// MotionKind::torque() of the tool's motion.
[[nodiscard]] std::optional<Vec3> torque_of(const RigidTool& tool, const Eigen::VectorXd& q,
                                            const Eigen::VectorXd& h);

/// The thickness of contact where it is not given, m.
[[nodiscard]] double usual_thickness(const RigidTool& tool);

/// Returns the tool with a thickness or stiffness of 0 replaced by one that suits the tool and the
/// body. If both are 0, it also sets the offset. Numbers of its motion that follow from the body
/// are filled in.
[[nodiscard]] RigidTool with_defaults(RigidTool tool, const Scene& scene);

/// The mean by area of Young's modulus at small strain of the cells under the touchable surface,
/// Pa. If no face is touchable, it is the mean over the whole free surface.
[[nodiscard]] double mean_youngs_modulus(const Scene& scene);
/// The same mean of E* = E/(1 − ν²), the modulus that matters where a hard tool presses without
/// friction.
[[nodiscard]] double mean_contact_modulus(const Scene& scene);

/// The contact of a tool with a body.
/// @throws InputError the shape or the motion is not valid, see make_capsule() and RigidSurface;
///   the thickness or the stiffness is not positive; or the layer is too thin for the mesh, see
///   ContactSurface.
[[nodiscard]] RigidContact make_contact(const Body& body, const RigidTool& tool);

/// The name of the tool, for a message: "the sphere of radius 0.01 m".
[[nodiscard]] std::string name_of(const RigidTool& tool);

}  // namespace palpate
