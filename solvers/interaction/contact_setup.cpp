// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/contact_setup.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

double youngs_modulus(const Material& material) {
  const double mu = shear_modulus(material);
  const double kappa = bulk_modulus(material);
  return std::isfinite(kappa) ? 9 * kappa * mu / (3 * kappa + mu) : 3 * mu;
}

SurfaceTree tree_of(const TetMesh& mesh) { return {mesh.points, boundary_triangles(mesh)}; }

std::string describe(const Vec3& p) {
  std::ostringstream text;
  text << '(' << p.x() << ", " << p.y() << ", " << p.z() << ") m";
  return text.str();
}

}  // namespace

double mean_youngs_modulus(const Scene& scene) {
  const TetMesh& mesh = scene.mesh;
  std::vector<Index> cells;
  const std::vector<Index> faces = boundary_faces(mesh, &cells);
  const auto per_face = static_cast<std::size_t>(nodes_per_face(mesh.order));
  double area = 0;
  double sum = 0;
  const auto add_faces = [&](const auto& counts) {
    for (std::size_t f = 0; f < cells.size(); ++f) {
      const Index* face = faces.data() + f * per_face;
      if (!std::all_of(face, face + per_face, counts)) continue;
      const Vec3& a = mesh.points[face[0]];
      const double of_face = (mesh.points[face[1]] - a).cross(mesh.points[face[2]] - a).norm();
      const std::size_t material =
          scene.material_of_cell.empty()
              ? 0
              : static_cast<std::size_t>(
                    scene.material_of_cell[static_cast<std::size_t>(cells[f])]);
      area += of_face;
      sum += of_face * youngs_modulus(scene.materials[material]);
    }
  };
  add_faces([&](Index p) { return scene.touchable[p] != 0; });
  if (area == 0) add_faces([&](Index p) { return scene.fixed[p] == 0; });
  if (area == 0) add_faces([](Index /*p*/) { return true; });
  return sum / area;
}

ContactApproach::ContactApproach(const Scene& scene, RigidContact contact)
    : contact_(std::move(contact)),
      tree_(tree_of(scene.mesh)),
      at_rest_(NodalVector::Zero(3 * Eigen::Index{scene.mesh.num_points()})),
      thickness_(contact_.law().thickness) {
  const double tool = 2 * contact_.shape().bounding_radius();
  const double body = tree_.bounds().diagonal().norm();
  if (tool > body) {
    throw InputError("The tool, " + contact_.shape().description() + ", is " +
                     std::to_string(tool) + " m across and larger than the body, which is " +
                     std::to_string(body) + " m. Lengths are in m: make the tool smaller.");
  }
}

bool ContactApproach::is_free(const Vec3& place) const {
  NodalVector force = at_rest_;
  Eigen::VectorXd of_q = Vec3::Zero();
  return contact_.potential(place, at_rest_, force, of_q) == 0 && tree_.nearest(place).distance > 0;
}

Vec3 ContactApproach::start_for(const Vec3& place) const {
  if (!place.allFinite()) throw InputError("The place of the tool is not finite.");
  if (is_free(place)) return place;
  const SurfaceTree::Nearest nearest = tree_.nearest(place);
  Vec3 out = nearest.normal;
  if (std::abs(nearest.distance) > 1e-3 * thickness_) {
    out = (place - nearest.point) / nearest.distance;
  }
  const double longest = tree_.bounds().diagonal().norm() + 2 * contact_.shape().bounding_radius();
  for (double way = thickness_; way < longest; way += thickness_) {
    const Vec3 start = place + way * out;
    if (is_free(start)) return start;
  }
  throw InputError("No way leads from outside of the body along its normal to " + describe(place) +
                   ". Choose another place for the tool.");
}

}  // namespace palpate
