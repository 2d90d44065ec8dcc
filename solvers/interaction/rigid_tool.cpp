// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/rigid_tool.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "interaction/motion_kind.h"
#include "interaction/shape_kind.h"
#include "mesh/resolved_length.h"

namespace palpate {
namespace {

double contact_modulus(const Material& material) {
  const double modulus = youngs_modulus(material);
  const double poissons_ratio = modulus / (2 * shear_modulus(material)) - 1;
  return modulus / (1 - poissons_ratio * poissons_ratio);
}

/// The mean by area of a modulus of the cells under the touchable surface, see
/// mean_youngs_modulus().
template <class Modulus>
double mean_of_surface(const Scene& scene, const Modulus& modulus) {
  const TetMesh& mesh = scene.body.mesh;
  std::vector<Index> cells;
  const std::vector<Index> faces = boundary_faces(mesh, &cells);
  const auto per_face = static_cast<std::size_t>(nodes_per_face(mesh.order));
  double area = 0;
  double sum = 0;
  const auto add_faces = [&](const auto& counts) {
    for (std::size_t f = 0; f < cells.size(); ++f) {
      const Index* face = faces.data() + f * per_face;
      if (!std::all_of(face, face + 3, counts)) continue;
      const Vec3& a = mesh.points[face[0]];
      const double of_face = (mesh.points[face[1]] - a).cross(mesh.points[face[2]] - a).norm();
      const std::size_t material =
          scene.body.material_of_cell.empty()
              ? 0
              : static_cast<std::size_t>(
                    scene.body.material_of_cell[static_cast<std::size_t>(cells[f])]);
      area += of_face;
      sum += of_face * modulus(scene.organ.materials[material]);
    }
  };
  add_faces([&](Index p) { return scene.body.touchable[p] != 0; });
  if (area == 0) add_faces([&](Index p) { return scene.body.fixed[p] == 0; });
  if (area == 0) add_faces([](Index /*p*/) { return true; });
  return sum / area;
}

/// The offset with which the mean gap of Hertz's contact is 0 at the calibrated depth, m.
double calibrated_offset(const ContactLaw& law, const Scene& scene) {
  const double largest_pressure =
      2 / M_PI * mean_contact_modulus(scene) * std::sqrt(kCalibratedDepth);
  const double share = 0.75 * std::cbrt(largest_pressure / law.stiffness);
  return law.thickness * std::max(1 - share, 0.0);
}

/// Checks that the mesh of a body resolves the tool, and that the layer of contact is thin enough.
void check_size(const TetMesh& mesh, const RigidTool& tool, const RigidShape& shape) {
  if (shape_kind(tool.shape).has_radius()) {
    check_resolved(mesh, "The tool's radius (ToolRadius)", tool.radius);
  }
  check_not_too_large(
      mesh, "What the tool reaches from its centre (ToolRadius, ToolLength or its surface)",
      shape.bounding_radius());
  const std::string thickness = "The contact thickness (ContactThickness)";
  check_resolved(mesh, thickness, tool.law.thickness);
  const double largest = std::max(size_of(mesh), shape.bounding_radius());
  if (tool.law.thickness <= largest) return;
  throw InputError(thickness + " is " + quantity(tool.law.thickness, "m") +
                   ", more than the body and the tool are large. Give " + quantity(largest, "m") +
                   " or less, or 0 for a usual one.");
}

}  // namespace

double half_width(const RigidTool& tool) { return shape_kind(tool.shape).half_width(tool); }

double reach(const RigidTool& tool, const Vec3& direction) {
  return shape_kind(tool.shape).reach(tool, direction);
}

PoseMapPtr pose_of(const RigidTool& tool) {
  PoseMapPtr pose = motion_kind(tool.motion).make(tool.motion_numbers);
  if (pose->coordinates(Vec3::Zero()).size() != pose->num_coordinates()) {
    throw InputError("The motion of the tool has " + std::to_string(pose->num_coordinates()) +
                     " coordinates, and does not say which they are at a place "
                     "(PoseMap::coordinates()). Choose another motion.");
  }
  return pose;
}

double reach_at(const RigidTool& tool, const Pose& pose, const Vec3& q, const Vec3& direction) {
  return (pose.place - q).dot(direction) + reach(tool, pose.rotation.transpose() * direction);
}

Eigen::Quaterniond orientation_of(const std::array<double, 4>& numbers) {
  const auto [w, x, y, z] = numbers;
  const Eigen::Quaterniond orientation(w, x, y, z);
  if (!orientation.coeffs().allFinite() || !(orientation.norm() > 0)) {
    throw InputError(
        "An orientation must be a quaternion: w, x, y and z, finite and not all of them 0.");
  }
  return orientation.normalized();
}

void turn(RigidTool& tool, const std::array<double, 4>& orientation) {
  motion_kind(tool.motion).turn(orientation_of(orientation), tool.motion_numbers);
}

std::optional<Vec3> torque_of(const RigidTool& tool, const Eigen::VectorXd& q,
                              const Eigen::VectorXd& h) {
  return motion_kind(tool.motion).torque(tool.motion_numbers, q, h);
}

double usual_thickness(const RigidTool& tool) {
  return std::max(kThicknessOfRadius * half_width(tool),
                  shape_kind(tool.shape).least_thickness(tool));
}

RigidTool with_defaults(RigidTool tool, const Scene& scene) {
  ContactLaw& law = tool.law;
  const bool is_calibrated = law.thickness == 0 && law.stiffness == 0;
  const double of_width = kThicknessOfRadius * half_width(tool);
  if (law.thickness == 0) law.thickness = usual_thickness(tool);
  if (law.stiffness == 0) {
    const double moduli =
        is_calibrated ? kCalibratedStiffnessOfModulus * std::pow(law.thickness / of_width, 3)
                      : kStiffnessOfModulus;
    law.stiffness = moduli * mean_youngs_modulus(scene);
  }
  if (is_calibrated) law.offset = calibrated_offset(law, scene);
  motion_kind(tool.motion).complete(scene, tool.motion_numbers);
  return tool;
}

RigidContact make_contact(const Body& body, const RigidTool& tool) {
  RigidShapePtr shape = shape_kind(tool.shape).make(tool);
  validate(tool.law);
  check_size(body.mesh, tool, *shape);
  auto surface =
      std::make_shared<const ContactSurface>(body, kSpacingOfThickness * tool.law.thickness);
  return {std::move(surface), std::move(shape), tool.law, pose_of(tool)};
}

std::string name_of(const RigidTool& tool) {
  // A damaged file may have any number.
  if (const ShapeKind* kind = find_shape_kind(tool.shape)) return kind->name(tool);
  return "a rigid tool of the unknown shape " + std::to_string(static_cast<int>(tool.shape));
}

double mean_youngs_modulus(const Scene& scene) {
  return mean_of_surface(scene, palpate::youngs_modulus);
}

double mean_contact_modulus(const Scene& scene) { return mean_of_surface(scene, contact_modulus); }

}  // namespace palpate
