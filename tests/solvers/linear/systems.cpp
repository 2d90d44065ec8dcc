// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/linear/systems.h"

#include <map>
#include <utility>

namespace palpate::test {
namespace {

/// The barycentric coordinates of the 4-point rule.
constexpr double kNear = 0.5854101966249685;
constexpr double kFar = 0.1381966011250105;

using Gradients = Eigen::Matrix<double, 10, 3>;

/// Gradients of the ten shape functions at a quadrature point.
Gradients gradients_at(const Eigen::Vector4d& l, const Eigen::Matrix<double, 4, 3>& of_l) {
  Gradients gradients;
  for (int i = 0; i < 4; ++i) gradients.row(i) = (4 * l[i] - 1) * of_l.row(i);
  for (int e = 0; e < 6; ++e) {
    const auto [a, b] = kTetEdges[e];
    gradients.row(4 + e) = 4 * (l[a] * of_l.row(b) + l[b] * of_l.row(a));
  }
  return gradients;
}

}  // namespace

System incompressible(const Scene& scene, double softness, double unit) {
  const System stiffness = body(scene);
  const Assembly assembly(scene);
  std::map<Index, Index> pressure;  // its number, by corner
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    for (int i = 0; i < 4; ++i) pressure.try_emplace(scene.body.mesh.cell(c)[i], 0);
  }
  Index size = stiffness.pattern.size;
  for (auto& [corner, number] : pressure) number = size++;

  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
  matrix.topLeftCorner(stiffness.pattern.size, stiffness.pattern.size) = stiffness.matrix();
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    const Index* cell = scene.body.mesh.cell(c);
    Mat3 edges;
    for (int i = 0; i < 3; ++i) {
      edges.col(i) = scene.body.mesh.points[cell[i + 1]] - scene.body.mesh.points[cell[0]];
    }
    Eigen::Matrix<double, 4, 3> of_l;
    of_l.bottomRows<3>() = edges.inverse();
    of_l.row(0) = -of_l.bottomRows<3>().colwise().sum();
    const double weight = edges.determinant() / 24;
    for (int q = 0; q < 4; ++q) {
      Eigen::Vector4d l = Eigen::Vector4d::Constant(kFar);
      l[q] = kNear;
      const Gradients gradients = gradients_at(l, of_l);
      for (int i = 0; i < 4; ++i) {
        const Index p = pressure.at(cell[i]);
        for (int n = 0; n < 10; ++n) {
          const Index u = assembly.unknown_of_point()[cell[n]];
          if (u < 0) continue;
          matrix.block<1, 3>(p, u) += unit * weight * l[i] * gradients.row(n);
          matrix.block<3, 1>(u, p) += unit * weight * l[i] * gradients.row(n).transpose();
        }
        for (int j = 0; j < 4; ++j) {
          matrix(p, pressure.at(cell[j])) -= unit * unit * softness * weight * l[i] * l[j];
        }
      }
    }
  }
  return sparse(matrix);
}

}  // namespace palpate::test
