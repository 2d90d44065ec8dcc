// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/contact_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "assembly/loaded_faces.h"
#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// The number of parts into which an edge is divided for points of integration that are `spacing`
/// apart.
int divisions_for_spacing(double spacing, double longest) {
  if (!(spacing > 0)) {
    throw InputError("The points at which contact is integrated are " + quantity(spacing, "m") +
                     " apart; this must be a positive length.");
  }
  // Points of neighbouring triangles are about half an edge apart.
  const double wanted = std::ceil(longest / (2 * spacing));
  if (!(wanted <= ContactSurface::kMostDivisions)) {
    throw InputError("An edge of " + quantity(longest, "m") + " would be divided into more than " +
                     std::to_string(ContactSurface::kMostDivisions) +
                     " parts to integrate contact at points that are " + quantity(spacing, "m") +
                     " apart. Mesh the body more finely, or take a thicker contact.");
  }
  return std::max(1, static_cast<int>(wanted));
}

}  // namespace

ContactSurface::ContactSurface(const Body& body, double spacing)
    : ContactSurface(body,
                     [&](double longest) { return divisions_for_spacing(spacing, longest); }) {}

ContactSurface ContactSurface::divided(const Body& body, int divisions) {
  if (divisions < 1 || divisions > kMostDivisions) {
    throw InputError("The edges of the surface are to be divided into " +
                     std::to_string(divisions) + " parts to integrate contact; this must be 1 to " +
                     std::to_string(kMostDivisions) + ".");
  }
  return {body, [&](double /*longest*/) { return divisions; }};
}

ContactSurface::ContactSurface(const Body& body,
                               const std::function<int(double longest)>& divisions_for)
    : nodes_per_face_(palpate::nodes_per_face(body.mesh.order)), points_(body.mesh.points) {
  const std::vector<Index> faces = boundary_faces(body.mesh);
  const auto per_face = static_cast<std::size_t>(nodes_per_face_);
  std::map<int, std::vector<FacePoint>> rules;
  const auto rule_of = [&](int divisions) -> const std::vector<FacePoint>& {
    std::vector<FacePoint>& rule = rules[divisions];
    if (rule.empty()) rule = divided_quadrature(body.mesh.order, divisions);
    return rule;
  };
  for (std::size_t first = 0; first < faces.size(); first += per_face) {
    const Index* face = faces.data() + first;
    if (std::all_of(face, face + per_face, [&](Index p) { return body.fixed[p] != 0; })) continue;
    double longest = 0;
    Eigen::Matrix3Xd places(3, nodes_per_face_);
    for (int a = 0; a < nodes_per_face_; ++a) places.col(a) = points_[face[a]];
    for (int a = 0; a < 3; ++a) {
      longest = std::max(longest, (places.col(a) - places.col((a + 1) % 3)).norm());
    }
    const int divisions = divisions_for(longest);
    const std::vector<FacePoint>& rule = rule_of(divisions);
    Eigen::MatrixXd& shape = shapes_[divisions];
    if (shape.size() == 0) {
      shape.resize(static_cast<Eigen::Index>(rule.size()), nodes_per_face_);
      for (std::size_t i = 0; i < rule.size(); ++i) {
        shape.row(static_cast<Eigen::Index>(i)) = rule[i].values.transpose();
      }
    }
    first_point_.push_back(weights_.size());
    Vec3 normal = Vec3::Zero();
    for (const FacePoint& point : rule) {
      const Eigen::Matrix<double, 3, 2> ways = places * point.slopes;
      const Vec3 across = ways.col(0).cross(ways.col(1));
      weights_.push_back(point.weight * across.norm());
      normal += point.weight * across;
    }
    normals_.push_back(normal.normalized());
    longest_edges_.push_back(longest);
    divisions_.push_back(divisions);
    nodes_.insert(nodes_.end(), face, face + per_face);
  }
}

std::vector<Vec3> ContactSurface::places(const std::vector<Vec3>& points) const {
  std::vector<Vec3> places;
  places.reserve(weights_.size());
  Eigen::Matrix3Xd nodes(3, nodes_per_face_);
  for (Index f = 0; f < num_faces(); ++f) {
    const Face of = face(f);
    for (int a = 0; a < nodes_per_face_; ++a) nodes.col(a) = points[of.nodes[a]];
    for (Eigen::Index i = 0; i < of.shape->rows(); ++i) {
      places.emplace_back(nodes * of.shape->row(i).transpose());
    }
  }
  return places;
}

}  // namespace palpate
