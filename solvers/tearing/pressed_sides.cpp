// SPDX-License-Identifier: BSD-3-Clause
#include "tearing/pressed_sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "assembly/stress.h"
#include "mesh/cell_faces.h"
#include "tearing/side_points.h"

namespace palpate {
namespace {

/// The outward normals of what is open of the cut, at its points, of any length; else 0.
std::vector<Vec3> normals_of_sides(const Body& body) {
  const TetMesh& mesh = body.mesh;
  std::vector<Vec3> normals(mesh.points.size(), Vec3::Zero());
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    for (int k = 0; k < 4; ++k) {
      if (!is_open(body.cut.faces[c][k], body.cut.stage)) continue;
      const auto& [a, b, d] = face_opposite(cell, k);
      const std::vector<Vec3>& x = mesh.points;
      Vec3 normal = (x[b] - x[a]).cross(x[d] - x[a]);
      if (normal.dot(x[cell[k]] - x[a]) > 0) normal = -normal;
      for (const Index p : points_of_side(mesh, c, k)) normals[p] += normal;
    }
  }
  return normals;
}

}  // namespace

NodalVector press_sides(const Scene& scene, const Assembly& assembly, const SoftContact& contact,
                        NodalVector u) {
  const BodyStress stress = find_stress(assembly, scene.body.mesh, u, NodalVector());
  const std::vector<double> pressure = contact.on_surface(u).pressure;
  const std::vector<Vec3> normals = normals_of_sides(scene.body);
  const auto depth = [&](double of) {
    return scene.organ.contact.thickness *
           std::cbrt(std::max(of, 0.0) / scene.organ.contact.stiffness);
  };
  for (std::size_t p = 0; p < normals.size(); ++p) {
    if (normals[p].isZero(0)) continue;
    const Vec3 n = normals[p].normalized();
    const auto s = stress.at_points.cauchy.col(static_cast<Eigen::Index>(p));
    Mat3 cauchy;
    cauchy << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
    const double missing = depth(-n.dot(cauchy * n)) - depth(pressure[p]);
    if (!(missing > 0)) continue;
    // Each side gives way by half of it.
    u.segment<3>(3 * static_cast<Eigen::Index>(p)) += 0.5 * missing * n;
  }
  return u;
}

}  // namespace palpate
