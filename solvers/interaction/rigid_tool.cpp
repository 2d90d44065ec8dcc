// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/rigid_tool.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "interaction/rigid_capsule.h"
#include "interaction/rigid_surface.h"
#include "mesh/resolved_length.h"

namespace palpate {
namespace {

double youngs_modulus(const Material& material) {
  const double mu = shear_modulus(material);
  const double kappa = bulk_modulus(material);
  return std::isfinite(kappa) ? 9 * kappa * mu / (3 * kappa + mu) : 3 * mu;
}

double contact_modulus(const Material& material) {
  const double modulus = youngs_modulus(material);
  const double poissons_ratio = modulus / (2 * shear_modulus(material)) - 1;
  return modulus / (1 - poissons_ratio * poissons_ratio);
}

/// A modulus of the cells under the touchable surface, the mean by area, see mean_youngs_modulus().
template <class Modulus>
double mean_of_surface(const Scene& scene, const Modulus& modulus) {
  const TetMesh& mesh = scene.mesh;
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
          scene.material_of_cell.empty()
              ? 0
              : static_cast<std::size_t>(
                    scene.material_of_cell[static_cast<std::size_t>(cells[f])]);
      area += of_face;
      sum += of_face * modulus(scene.materials[material]);
    }
  };
  add_faces([&](Index p) { return scene.touchable[p] != 0; });
  if (area == 0) add_faces([&](Index p) { return scene.fixed[p] == 0; });
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

RigidShapePtr make_shape(const RigidTool& tool) {
  switch (tool.shape) {
    case ToolShape::sphere: return make_sphere(tool.radius);
    case ToolShape::capsule: return make_capsule({tool.radius, tool.length, tool.axis});
    case ToolShape::surface: break;
  }
  ToolSurface surface;
  surface.points = tool.points;
  surface.triangles = tool.triangles;
  surface.thickness = tool.law.thickness;
  return make_surface_tool(std::move(surface));
}

/// A body resolves the tool, and its layer of contact is a layer.
void check_size(const TetMesh& mesh, const RigidTool& tool, const RigidShape& shape) {
  if (tool.shape != ToolShape::surface) {
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

double half_width(const RigidTool& tool) {
  if (tool.shape != ToolShape::surface) return tool.radius;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : tool.points) box.extend(p);
  return box.isEmpty() ? 0 : 0.5 * box.sizes().minCoeff();
}

double reach(const RigidTool& tool, const Vec3& direction) {
  switch (tool.shape) {
    case ToolShape::sphere: break;
    case ToolShape::capsule:
      return tool.radius + 0.5 * tool.length * std::abs(tool.axis.normalized().dot(direction));
    case ToolShape::surface: {
      double most = 0;
      for (const Vec3& p : tool.points) most = std::max(most, p.dot(direction));
      return most;
    }
  }
  return tool.radius;
}

double usual_thickness(const RigidTool& tool) {
  const double of_width = kThicknessOfRadius * half_width(tool);
  if (tool.shape != ToolShape::surface) return of_width;
  double area = 0;
  for (const auto& [a, b, c] : tool.triangles) {
    const Vec3& corner = tool.points[a];
    area += 0.5 * (tool.points[b] - corner).cross(tool.points[c] - corner).norm();
  }
  return std::max(of_width, std::sqrt(area / kLargestAreaOfThickness));
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
  return tool;
}

RigidContact make_contact(const Scene& scene, const RigidTool& tool) {
  RigidShapePtr shape = make_shape(tool);
  validate(tool.law);
  check_size(scene.mesh, tool, *shape);
  auto surface =
      std::make_shared<const ContactSurface>(scene, kSpacingOfThickness * tool.law.thickness);
  return {std::move(surface), std::move(shape), tool.law};
}

std::string name_of(const RigidTool& tool) {
  std::ostringstream text;
  switch (tool.shape) {
    case ToolShape::sphere: text << "the sphere of radius " << tool.radius << " m"; break;
    case ToolShape::capsule:
      text << "the capsule of radius " << tool.radius << " m and length " << tool.length << " m";
      break;
    case ToolShape::surface:
      text << "the tool with a surface of " << tool.triangles.size() << " triangles";
      break;
    // A damaged file may have any number.
    default: text << "a rigid tool of the unknown shape " << static_cast<int>(tool.shape);
  }
  return text.str();
}

double mean_youngs_modulus(const Scene& scene) { return mean_of_surface(scene, youngs_modulus); }

double mean_contact_modulus(const Scene& scene) { return mean_of_surface(scene, contact_modulus); }

}  // namespace palpate
