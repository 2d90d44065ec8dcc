// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/body_points.h"

#include <Eigen/LU>
#include <map>
#include <utility>

#include "base/simd.h"
#include "elements/tetrahedron.h"

namespace palpate {
namespace {

/// ∂N_a/∂X at a quadrature point of a cell, and det ∂X/∂ξ.
struct Gradients {
  Eigen::Matrix<double, Eigen::Dynamic, 3> of_nodes;
  double jacobian;
};

Gradients gradients_at(const TetMesh& mesh, Index cell, const Vec3& xi) {
  const Eigen::Matrix<double, Eigen::Dynamic, 3> reference = shape_gradients(mesh.order, xi);
  Mat3 jacobian = Mat3::Zero();
  for (Eigen::Index a = 0; a < reference.rows(); ++a) {
    jacobian += mesh.points[mesh.cell(cell)[a]] * reference.row(a);
  }
  return {reference * jacobian.inverse(), jacobian.determinant()};
}

}  // namespace

BodyPoints::BodyPoints(const Scene& scene, NodalVector rest)
    : scene_(scene), rest_(std::move(rest)) {
  const std::vector<QuadraturePoint>& rule = quadrature(scene.body.mesh.order);
  points_of_cell_ = static_cast<Index>(rule.size());
  weights_.resize(Eigen::Index{points_of_cell_} * scene.body.mesh.num_cells());
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    for (Index q = 0; q < points_of_cell_; ++q) {
      weights_[Eigen::Index{c} * points_of_cell_ + q] =
          rule[q].weight * gradients_at(scene.body.mesh, c, rule[q].xi).jacobian;
    }
  }
}

Index BodyPoints::material_of(Index point) const {
  return scene_.body.material_of(point / points_of_cell_);
}

BodyPoints::Reduced BodyPoints::reduce(const Eigen::MatrixXd& basis,
                                       const std::vector<Index>& chosen,
                                       const Eigen::VectorXd& weights) const {
  // The indices in `chosen` of the points of each law.
  std::map<Law, std::vector<Index>> of_law;
  for (Index i = 0; i < static_cast<Index>(chosen.size()); ++i) {
    const Material& material = scene_.organ.materials[material_of(chosen[i])];
    of_law[law_of_energy(material.law)].push_back(i);
  }
  Reduced reduced;
  ReducedPoints& points = reduced.points;
  reduced.place.resize(chosen.size());
  for (const auto& [law, members] : of_law) {
    const auto packets = static_cast<Index>((members.size() + kPacketSize - 1) / kPacketSize);
    const Index first = points.num_packets();
    points.groups.push_back({law, first, first + packets});
    for (Index at = 0; at < packets * kPacketSize; ++at) {
      const bool is_filling = at >= static_cast<Index>(members.size());
      const Index member = is_filling ? members.back() : members[at];
      if (!is_filling) reduced.place[member] = static_cast<Index>(points.material.size());
      points.material.push_back(material_of(chosen[member]));
    }
  }
  constexpr Eigen::Index rows = 9 * kPacketSize;
  points.weights.setZero(static_cast<Eigen::Index>(points.material.size()));
  points.gradients.setZero(rows * points.num_packets(), basis.cols());
  if (rest_.size() > 0) points.rest_gradients.setZero(points.gradients.rows());
  const std::vector<QuadraturePoint>& rule = quadrature(scene_.body.mesh.order);
  const auto put = [&](Index point, Eigen::Index place) {
    const Index cell = point / points_of_cell_;
    const Gradients gradients =
        gradients_at(scene_.body.mesh, cell, rule[point % points_of_cell_].xi);
    const Eigen::Index first = place / kPacketSize * rows + place % kPacketSize;
    for (Eigen::Index a = 0; a < gradients.of_nodes.rows(); ++a) {
      const Eigen::Index row = 3 * Eigen::Index{scene_.body.mesh.cell(cell)[a]};
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          const Eigen::Index at = first + (3 * i + j) * kPacketSize;
          points.gradients.row(at) += gradients.of_nodes(a, j) * basis.row(row + i);
          if (rest_.size() > 0) {
            points.rest_gradients[at] += gradients.of_nodes(a, j) * rest_[row + i];
          }
        }
      }
    }
  };
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    put(chosen[i], reduced.place[i]);
    points.weights[reduced.place[i]] = weights[static_cast<Eigen::Index>(i)];
  }
  for (const ReducedPoints::Group& group : points.groups) {
    const auto& members = of_law[group.law];
    for (Index at = static_cast<Index>(members.size());
         at < (group.last_packet - group.first_packet) * kPacketSize; ++at) {
      put(chosen[members.back()], group.first_packet * kPacketSize + at);
    }
  }
  return reduced;
}

}  // namespace palpate
