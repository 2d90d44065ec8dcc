// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/contact_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// Barycentric coordinates of the six points, and their shares of the area.
struct RulePoint {
  double a, b, share;
};
constexpr double kNear = 0.445948490915965;
constexpr double kNearShare = 0.223381589678011;
constexpr double kFar = 0.091576213509771;
constexpr double kFarShare = 0.109951743655322;
constexpr RulePoint kRule[6] = {
    {kNear, kNear, kNearShare},         {1 - 2 * kNear, kNear, kNearShare},
    {kNear, 1 - 2 * kNear, kNearShare}, {kFar, kFar, kFarShare},
    {1 - 2 * kFar, kFar, kFarShare},    {kFar, 1 - 2 * kFar, kFarShare}};

/// Calls visit(s, t, share) for each point of a face that is divided, with its barycentric
/// coordinates 1 − s − t, s, t and its share of the face's area.
template <class Visit>
void for_each_point(int divisions, Visit&& visit) {
  const double side = 1.0 / divisions;
  for (int i = 0; i < divisions; ++i) {
    for (int j = 0; i + j < divisions; ++j) {
      for (const RulePoint& p : kRule) {
        visit(side * (i + p.a), side * (j + p.b), side * side * p.share);
        if (i + j + 1 < divisions) {
          visit(side * (i + 1 - p.a), side * (j + 1 - p.b), side * side * p.share);
        }
      }
    }
  }
}

/// The shape functions at a point of a face, or with their derivatives by s and t.
Eigen::RowVectorXd shape_at(int nodes, double s, double t) {
  const double r = 1 - s - t;
  Eigen::RowVectorXd n(nodes);
  if (nodes == 3) {
    n << r, s, t;
  } else {
    n << r * (2 * r - 1), s * (2 * s - 1), t * (2 * t - 1), 4 * r * s, 4 * s * t, 4 * t * r;
  }
  return n;
}

Eigen::MatrixXd slopes_at(int nodes, double s, double t) {
  const double r = 1 - s - t;
  Eigen::MatrixXd d(2, nodes);
  if (nodes == 3) {
    d << -1, 1, 0, -1, 0, 1;
  } else {
    d << 1 - 4 * r, 4 * s - 1, 0, 4 * (r - s), 4 * t, -4 * t,  //
        1 - 4 * r, 0, 4 * t - 1, -4 * s, 4 * s, 4 * (r - t);
  }
  return d;
}

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
    Eigen::MatrixXd& shape = shapes_[divisions];
    if (shape.size() == 0) {
      shape.resize(6 * divisions * divisions, nodes_per_face_);
      Eigen::Index row = 0;
      for_each_point(divisions, [&](double s, double t, double /*share*/) {
        shape.row(row++) = shape_at(nodes_per_face_, s, t);
      });
    }
    first_point_.push_back(weights_.size());
    Vec3 normal = Vec3::Zero();
    for_each_point(divisions, [&](double s, double t, double share) {
      const Eigen::Matrix<double, 3, 2> ways =
          places * slopes_at(nodes_per_face_, s, t).transpose();
      const Vec3 across = ways.col(0).cross(ways.col(1));
      weights_.push_back(0.5 * share * across.norm());
      normal += share * across;
    });
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
