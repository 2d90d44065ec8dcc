// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/external_energy.h"

#include <Eigen/Geometry>
#include <cmath>

#include "assembly/cross_matrix.h"
#include "assembly/mass.h"

namespace palpate {
std::optional<PointMatrix> springs_of(const Body& body, const Assembly& assembly) {
  const std::vector<Index> faces = faces_with(body.mesh, body.support_stiffness);
  if (faces.empty()) return std::nullopt;
  const std::vector<FacePoint> rule = face_quadrature(body.mesh.order);
  const int num_nodes = nodes_per_face(body.mesh.order);
  std::vector<Eigen::Triplet<double>> triplets;
  for (std::size_t f = 0; f < faces.size(); f += num_nodes) {
    const Index* nodes = &faces[f];
    const Eigen::Matrix3Xd x = places_of_face(body.mesh, nodes);
    Vec3 of_corners;
    for (int a = 0; a < 3; ++a) of_corners[a] = body.support_stiffness[nodes[a]];
    Eigen::MatrixXd of_face = Eigen::MatrixXd::Zero(num_nodes, num_nodes);
    for (const FacePoint& point : rule) {
      const double stiffness = area_at(point, x) * of_corners.dot(point.of_corners);
      of_face += stiffness * point.values * point.values.transpose();
    }
    for (int a = 0; a < num_nodes; ++a) {
      for (int b = 0; b < num_nodes; ++b) {
        triplets.emplace_back(nodes[a], nodes[b], of_face(a, b));
      }
    }
  }
  return PointMatrix(triplets, assembly);
}

ExternalEnergy::ExternalEnergy(const Scene& scene, const Assembly& assembly)
    : dead_(NodalVector::Zero(assembly.state_size())),
      springs_(springs_of(scene.body, assembly)),
      rule_(face_quadrature(scene.body.mesh.order)),
      nodes_per_face_(nodes_per_face(scene.body.mesh.order)) {
  if (scene.organ.has_body_force()) dead_ = weight_of(scene, assembly);
  add_traction(scene.body);
  add_pressure(scene.body, assembly);
}

void ExternalEnergy::add_traction(const Body& body) {
  const std::vector<Index> faces = faces_with(body.mesh, body.applied_traction);
  for (std::size_t f = 0; f < faces.size(); f += nodes_per_face_) {
    const Index* nodes = &faces[f];
    const Eigen::Matrix3Xd x = places_of_face(body.mesh, nodes);
    Mat3 of_corners;
    for (int a = 0; a < 3; ++a) of_corners.col(a) = body.applied_traction[nodes[a]];
    for (const FacePoint& point : rule_) {
      const Vec3 load = area_at(point, x) * of_corners * point.of_corners;
      for (int a = 0; a < nodes_per_face_; ++a) {
        dead_.segment<3>(3 * Eigen::Index{nodes[a]}) += point.values[a] * load;
      }
    }
  }
}

void ExternalEnergy::add_pressure(const Body& body, const Assembly& assembly) {
  const std::vector<Index> faces = faces_under_pressure(body.mesh, body.applied_pressure);
  if (faces.empty()) return;
  points_ = body.mesh.points;
  const std::vector<Index>& unknown = assembly.unknown_of_point();
  for (std::size_t f = 0; f < faces.size(); f += nodes_per_face_) {
    PressedFace face{{}, body.applied_pressure[faces[f]]};
    std::copy_n(&faces[f], nodes_per_face_, face.nodes.begin());
    first_target_.push_back(targets_.size());
    for (int a = 0; a < nodes_per_face_; ++a) {
      for (int b = 0; b < nodes_per_face_; ++b) {
        const Index row = unknown[face.nodes[a]];
        const Index column = unknown[face.nodes[b]];
        if (column < 0 || row < column) continue;
        targets_.push_back({a, b, row == column, block_positions(assembly.pattern(), row, column)});
      }
    }
    pressed_.push_back(face);
  }
  first_target_.push_back(targets_.size());
}

void ExternalEnergy::count_from(const NodalVector& rest, double of_materials) {
  rest_ = rest;
  surface_at_rest_ = of_surface(rest);
  materials_at_rest_ = of_materials;
}

double ExternalEnergy::add(const NodalVector& state, NodalVector& force,
                           std::vector<double>* values) const {
  force -= share_ * dead_;
  if (springs_) {
    force += springs_->times(state);
    if (values != nullptr) springs_->add_to(1, *values);
  }
  if (!pressed_.empty() && share_ != 0) {
    add_force_of_pressure(state, force);
    if (values != nullptr) add_tangent_of_pressure(state, *values);
  }
  if (rest_.size() == 0) return of_surface(state) - share_ * dead_.dot(state);
  return (of_surface(state) - surface_at_rest_) - share_ * dead_.dot(state - rest_) -
         materials_at_rest_;
}

double ExternalEnergy::of_springs(const NodalVector& state) const {
  return springs_ ? 0.5 * state.dot(springs_->times(state)) : 0;
}

double ExternalEnergy::of_surface(const NodalVector& state) const {
  return of_springs(state) + (pressed_.empty() ? 0 : share_ * of_pressures(state));
}

Eigen::Matrix3Xd ExternalEnergy::nodes_of(const PressedFace& face, double share,
                                          const NodalVector& state) const {
  Eigen::Matrix3Xd x(3, nodes_per_face_);
  for (int a = 0; a < nodes_per_face_; ++a) {
    const Index node = face.nodes[a];
    x.col(a) = points_[node] + share * state.segment<3>(3 * Eigen::Index{node});
  }
  return x;
}

double ExternalEnergy::of_pressures(const NodalVector& state) const {
  // The two Gauss points.
  const double half_way = 0.5 / std::sqrt(3.0);
  double energy = 0;
  for (const PressedFace& face : pressed_) {
    Eigen::Matrix3Xd u(3, nodes_per_face_);
    for (int a = 0; a < nodes_per_face_; ++a) {
      u.col(a) = state.segment<3>(3 * Eigen::Index{face.nodes[a]});
    }
    double swept = 0;
    for (const double share : {0.5 - half_way, 0.5 + half_way}) {
      const Eigen::Matrix3Xd x = nodes_of(face, share, state);
      for (const FacePoint& point : rule_) {
        const Eigen::Matrix<double, 3, 2> t = x * point.slopes;
        swept += 0.5 * point.weight * (u * point.values).dot(t.col(0).cross(t.col(1)));
      }
    }
    energy += face.pressure * swept;
  }
  return energy;
}

void ExternalEnergy::add_force_of_pressure(const NodalVector& state, NodalVector& force) const {
  for (const PressedFace& face : pressed_) {
    const Eigen::Matrix3Xd x = nodes_of(face, 1, state);
    for (const FacePoint& point : rule_) {
      const Eigen::Matrix<double, 3, 2> t = x * point.slopes;
      const Vec3 load = share_ * face.pressure * point.weight * t.col(0).cross(t.col(1));
      for (int a = 0; a < nodes_per_face_; ++a) {
        force.segment<3>(3 * Eigen::Index{face.nodes[a]}) += point.values[a] * load;
      }
    }
  }
}

void ExternalEnergy::add_tangent_of_pressure(const NodalVector& state,
                                             std::vector<double>& values) const {
  for (std::size_t f = 0; f < pressed_.size(); ++f) {
    const PressedFace& face = pressed_[f];
    const Eigen::Matrix3Xd x = nodes_of(face, 1, state);
    // ∫ N_a ∂n/∂x_b for each pair of nodes.
    std::array<std::array<Mat3, 6>, 6> blocks;
    for (auto& row : blocks) row.fill(Mat3::Zero());
    for (const FacePoint& point : rule_) {
      const Eigen::Matrix<double, 3, 2> t = x * point.slopes;
      const Mat3 by_eta = share_ * face.pressure * point.weight * cross_matrix(t.col(0));
      const Mat3 by_xi = -share_ * face.pressure * point.weight * cross_matrix(t.col(1));
      for (int b = 0; b < nodes_per_face_; ++b) {
        const Mat3 of_normal = point.slopes(b, 1) * by_eta + point.slopes(b, 0) * by_xi;
        for (int a = 0; a < nodes_per_face_; ++a) blocks[a][b] += point.values[a] * of_normal;
      }
    }
    for (std::size_t i = first_target_[f]; i < first_target_[f + 1]; ++i) {
      const auto& [a, b, is_diagonal, positions] = targets_[i];
      // The asymmetric part of a face cancels with those of its neighbours.
      const Mat3 block = 0.5 * (blocks[a][b] + blocks[b][a].transpose());
      for_each_in_block(positions, is_diagonal, [&](int row, int column, Index position) {
        values[position] += block(row, column);
      });
    }
  }
}

}  // namespace palpate
