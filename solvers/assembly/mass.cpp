// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/mass.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/LU>
#include <algorithm>

#include "assembly/supports.h"
#include "elements/tetrahedron.h"

namespace palpate {

namespace {

/// Relative residual of the accelerations.
constexpr double kTolerance = 1e-14;

/// The consistent mass of each pair of points, kg.
std::vector<Eigen::Triplet<double>> masses(const Body& body, const std::vector<double>& density) {
  const TetMesh& mesh = body.mesh;
  const int npc = nodes_per_cell(mesh.order);
  const std::vector<QuadraturePoint>& rule = fine_quadrature();
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, 3>> gradients;
  std::vector<Eigen::VectorXd> values;
  for (const QuadraturePoint& point : rule) {
    gradients.push_back(shape_gradients(mesh.order, point.xi));
    values.push_back(shape_values(mesh.order, point.xi));
  }
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(static_cast<std::size_t>(mesh.num_cells()) * npc * npc);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const double rho = density[body.material_of(c)];
    if (rho == 0) continue;
    const Index* cell = mesh.cell(c);
    Eigen::Matrix<double, 3, Eigen::Dynamic> x(3, npc);
    for (int a = 0; a < npc; ++a) x.col(a) = mesh.points[cell[a]];
    Eigen::MatrixXd of_cell = Eigen::MatrixXd::Zero(npc, npc);
    for (std::size_t q = 0; q < rule.size(); ++q) {
      const Mat3 jacobian = x * gradients[q];
      const double weight = rho * rule[q].weight * jacobian.determinant();
      of_cell += weight * values[q] * values[q].transpose();
    }
    for (int a = 0; a < npc; ++a) {
      for (int b = 0; b < npc; ++b) {
        triplets.emplace_back(cell[a], cell[b], of_cell(a, b));
      }
    }
  }
  return triplets;
}

/// Solves with a consistent mass matrix, whose scaled condition number is below a hundred (Wathen
/// 1987).
Eigen::MatrixXd solve(const Eigen::SparseMatrix<double, Eigen::RowMajor>& mass,
                      const Eigen::MatrixXd& right) {
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double, Eigen::RowMajor>,
                           Eigen::Lower | Eigen::Upper>
      solver(mass);
  solver.setTolerance(kTolerance);
  return solver.solve(right);
}

}  // namespace

MassMatrix::MassMatrix(const Body& body, const std::vector<double>& density,
                       const Assembly& assembly)
    : matrix_(masses(body, density), assembly),
      lumped_(matrix_.of_points() * Eigen::VectorXd::Ones(assembly.num_points())),
      state_size_(assembly.state_size()) {}

NodalVector MassMatrix::acceleration(const NodalVector& force, const std::vector<char>& free,
                                     const std::vector<HeldDirections>& held) const {
  if (!held.empty()) return held_acceleration(force, free, held);
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& of_points = matrix_.of_points();
  const Eigen::Index n = of_points.rows();
  const double unit = mean_mass();
  // Points that do not move, and points without mass, have a row of the unit matrix.
  const auto moves = [&](Eigen::Index p) {
    return free[static_cast<std::size_t>(p)] != 0 && of_points.coeff(p, p) > 0;
  };
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix = of_points;
  matrix.prune([&](Eigen::Index a, Eigen::Index b, double) { return moves(a) && moves(b); });
  Eigen::SparseMatrix<double, Eigen::RowMajor> others(n, n);
  Eigen::MatrixXd right = force.head(3 * n).reshaped<Eigen::RowMajor>(n, 3);
  for (Eigen::Index p = 0; p < n; ++p) {
    if (moves(p)) continue;
    others.insert(p, p) = unit;
    right.row(p).setZero();
  }
  matrix += others;
  return solve(matrix, right).reshaped<Eigen::RowMajor>();
}

NodalVector MassMatrix::held_acceleration(const NodalVector& force, const std::vector<char>& free,
                                          const std::vector<HeldDirections>& held) const {
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& of_points = matrix_.of_points();
  const Eigen::Index n = of_points.rows();
  const double unit = mean_mass();
  std::vector<Mat3> projectors(static_cast<std::size_t>(n), Mat3::Zero());
  for (Eigen::Index p = 0; p < n; ++p) {
    if (free[p] != 0 && of_points.coeff(p, p) > 0) projectors[p] = projector(held[p]);
  }
  // P M P + unit (I − P), see equilibrium/direction_constraints.h.
  std::vector<Eigen::Triplet<double>> triplets;
  const auto add = [&](Eigen::Index row, Eigen::Index column, const Mat3& block) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) triplets.emplace_back(3 * row + i, 3 * column + j, block(i, j));
    }
  };
  Eigen::VectorXd right(3 * n);
  for (Eigen::Index p = 0; p < n; ++p) {
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator of(of_points, p); of; ++of) {
      add(p, of.col(), of.value() * projectors[p] * projectors[of.col()]);
    }
    add(p, p, unit * (Mat3::Identity() - projectors[p]));
    right.segment<3>(3 * p) = projectors[p] * force.segment<3>(3 * p);
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(3 * n, 3 * n);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return solve(matrix, right);
}

NodalVector MassMatrix::weight(const Vec3& gravity) const {
  NodalVector load = NodalVector::Zero(state_size_);
  for (Eigen::Index a = 0; a < lumped_.size(); ++a) {
    load.segment<3>(3 * a) = lumped_[a] * gravity;
  }
  return load;
}

NodalVector weight_of(const Scene& scene, const Assembly& assembly) {
  return MassMatrix(scene.body, scene.organ.densities, assembly).weight(scene.organ.body_force);
}

}  // namespace palpate
