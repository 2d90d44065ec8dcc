// SPDX-License-Identifier: BSD-3-Clause
#include "soft_contact/contact_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "assembly/cross_matrix.h"
#include "assembly/loaded_faces.h"

namespace palpate {
namespace {

/// An edge is divided at most this often, however coarse a face is.
constexpr int kMostDivisions = 8;
constexpr double kPointsOfRule = 6;

}  // namespace

ContactPoints::ContactPoints(const Body& body, double spacing)
    : nodes_per_face_(palpate::nodes_per_face(body.mesh.order)), rest_(body.mesh.points) {
  std::vector<Index> cells;
  nodes_ = boundary_faces(body.mesh, &cells);
  std::map<int, Index> first_shape;
  std::map<int, std::vector<FacePoint>> rules;
  for (std::size_t f = 0; f < cells.size(); ++f) {
    const Index* face = &nodes_[f * static_cast<std::size_t>(nodes_per_face_)];
    const Eigen::Matrix3Xd places = places_of_face(body.mesh, face);
    const double area =
        0.5 * (places.col(1) - places.col(0)).cross(places.col(2) - places.col(0)).norm();
    const double wanted = std::round(std::sqrt(area / kPointsOfRule) / spacing);
    const int divisions = static_cast<int>(std::clamp(wanted, 1.0, double{kMostDivisions}));
    std::vector<FacePoint>& rule = rules[divisions];
    if (rule.empty()) {
      rule = divided_quadrature(body.mesh.order, divisions);
      first_shape[divisions] = static_cast<Index>(shapes_.size());
      for (const FacePoint& point : rule) {
        Shape shape{};
        for (int a = 0; a < nodes_per_face_; ++a) {
          shape.values[a] = point.values[a];
          shape.slopes_1[a] = point.slopes(a, 0);
          shape.slopes_2[a] = point.slopes(a, 1);
        }
        shapes_.push_back(shape);
      }
    }
    first_point_.push_back(num_points());
    shape_of_face_.push_back(first_shape[divisions]);
    part_.push_back(body.part_of(cells[f]));
    is_fixed_.push_back(
        std::all_of(face, face + nodes_per_face_, [&](Index p) { return body.fixed[p] != 0; }) ? 1
                                                                                               : 0);
    for (const FacePoint& point : rule) {
      areas_.push_back(area_at(point, places));
      face_of_.push_back(static_cast<Index>(f));
    }
  }
  first_point_.push_back(num_points());
}

PointFeatures ContactPoints::features(Index point, const NodalVector& state) const {
  const Shape& shape = this->shape(point);
  const Index* face = nodes(face_of_[point]);
  PointFeatures at;
  at.place.setZero();
  at.tangent_1.setZero();
  at.tangent_2.setZero();
  for (int a = 0; a < nodes_per_face_; ++a) {
    const Vec3 place = node_place(face[a], state);
    at.place += shape.values[a] * place;
    at.tangent_1 += shape.slopes_1[a] * place;
    at.tangent_2 += shape.slopes_2[a] * place;
  }
  const Vec3 across = at.tangent_1.cross(at.tangent_2);
  at.inverse_area = 1 / across.norm();
  at.normal = at.inverse_area * across;
  return at;
}

Vec3 ContactPoints::place(Index point, const NodalVector& state) const {
  const Shape& shape = this->shape(point);
  const Index* face = nodes(face_of_[point]);
  Vec3 place = Vec3::Zero();
  for (int a = 0; a < nodes_per_face_; ++a) place += shape.values[a] * node_place(face[a], state);
  return place;
}

void ContactPoints::add_to_nodes(Index point, const PointFeatures& at, const Vec6& gradient,
                                 NodalVector& of_nodes) const {
  const Shape& shape = this->shape(point);
  const Index* face = nodes(face_of_[point]);
  const Vec3 by_place = gradient.head<3>();
  const Vec3 by_normal = gradient.tail<3>();
  const Vec3 across = at.inverse_area * (by_normal - at.normal.dot(by_normal) * at.normal);
  const Vec3 by_1 = at.tangent_2.cross(across);
  const Vec3 by_2 = across.cross(at.tangent_1);
  for (int a = 0; a < nodes_per_face_; ++a) {
    of_nodes.segment<3>(3 * Eigen::Index{face[a]}) +=
        shape.values[a] * by_place + shape.slopes_1[a] * by_1 + shape.slopes_2[a] * by_2;
  }
}

ContactPoints::Slopes ContactPoints::slopes(Index point, const PointFeatures& at) const {
  const Shape& shape = this->shape(point);
  const Mat3 across = at.inverse_area * (Mat3::Identity() - at.normal * at.normal.transpose());
  const Mat3 by_1 = -across * cross_matrix(at.tangent_2);
  const Mat3 by_2 = across * cross_matrix(at.tangent_1);
  Slopes slopes = Slopes::Zero();
  for (int a = 0; a < nodes_per_face_; ++a) {
    slopes.block<3, 3>(0, 3 * a).diagonal().setConstant(shape.values[a]);
    slopes.block<3, 3>(3, 3 * a) = shape.slopes_1[a] * by_1 + shape.slopes_2[a] * by_2;
  }
  return slopes;
}

Vec3 ContactPoints::corner_normal(Index face, int corner, const NodalVector& state) const {
  // The edges leave the corner towards the next two; a midside node follows the corners, in the
  // order of the edges 01, 12, 20.
  const Index* all = nodes(face);
  const int next = (corner + 1) % 3;
  const int last = (corner + 2) % 3;
  const Vec3 here = node_place(all[corner], state);
  Vec3 tangent_1 = node_place(all[next], state) - here;
  Vec3 tangent_2 = node_place(all[last], state) - here;
  if (nodes_per_face_ == kMostNodes) {
    tangent_1 = 4 * (node_place(all[3 + corner], state) - here) - tangent_1;
    tangent_2 = 4 * (node_place(all[3 + last], state) - here) - tangent_2;
  }
  return tangent_1.cross(tangent_2).normalized();
}

void ContactPoints::add_curvature(Index point, const PointFeatures& at, const Vec3& by_normal,
                                  FaceBlock& block) const {
  const Shape& shape = this->shape(point);
  // The second derivative of γ · a/|a| by a, and −[γ Dn]×, whose multiples are those of a = t₁ ×
  // t₂.
  const double along = by_normal.dot(at.normal);
  const Mat3 outer = by_normal * at.normal.transpose();
  const Mat3 by_a = at.inverse_area * at.inverse_area *
                    (3 * along * at.normal * at.normal.transpose() - along * Mat3::Identity() -
                     outer - outer.transpose());
  const Mat3 turn = -at.inverse_area * cross_matrix(by_normal - along * at.normal);
  const Mat3 cross_1 = -cross_matrix(at.tangent_2);
  const Mat3 cross_2 = cross_matrix(at.tangent_1);
  std::array<Mat3, kMostNodes> of_a;
  for (int a = 0; a < nodes_per_face_; ++a) {
    of_a[a] = shape.slopes_1[a] * cross_1 + shape.slopes_2[a] * cross_2;
  }
  for (int a = 0; a < nodes_per_face_; ++a) {
    const Mat3 left = of_a[a].transpose() * by_a;
    for (int b = 0; b < nodes_per_face_; ++b) {
      const double turned =
          shape.slopes_1[a] * shape.slopes_2[b] - shape.slopes_1[b] * shape.slopes_2[a];
      block.block<3, 3>(3 * a, 3 * b) += left * of_a[b] + turned * turn;
    }
  }
}

}  // namespace palpate
