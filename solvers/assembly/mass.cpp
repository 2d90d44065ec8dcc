// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/mass.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/LU>
#include <algorithm>
#include <array>

#include "elements/tetrahedron.h"

namespace palpate {

MassMatrix::MassMatrix(const Scene& scene, const std::vector<double>& density,
                       const Assembly& assembly)
    : state_size_(assembly.state_size()), lumped_(Eigen::VectorXd::Zero(assembly.num_points())) {
  const TetMesh& mesh = scene.mesh;
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
    const double rho = density[scene.material_of_cell.empty() ? 0 : scene.material_of_cell[c]];
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
        lumped_[cell[a]] += of_cell(a, b);
      }
    }
  }
  of_points_.resize(mesh.num_points(), mesh.num_points());
  of_points_.setFromTriplets(triplets.begin(), triplets.end());

  const std::vector<Index>& unknown = assembly.unknown_of_point();
  const SymmetricPattern& pattern = assembly.pattern();
  for (Index a = 0; a < mesh.num_points(); ++a) {
    if (unknown[a] < 0) continue;
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator of(of_points_, a); of; ++of) {
      const Index column = unknown[of.col()];
      if (column < 0 || column > unknown[a]) continue;
      Target target{{}, of.value()};
      for (Index i = 0; i < 3; ++i) {
        const auto first = pattern.row.begin() + pattern.column_start[column + i];
        const auto last = pattern.row.begin() + pattern.column_start[column + i + 1];
        target.positions[i] =
            static_cast<Index>(std::lower_bound(first, last, unknown[a] + i) - pattern.row.begin());
      }
      targets_.push_back(target);
    }
  }
}

NodalVector MassMatrix::times(const NodalVector& x) const {
  const Eigen::Index n = of_points_.rows();
  NodalVector y = NodalVector::Zero(state_size_);
  const auto from = x.head(3 * n).reshaped<Eigen::RowMajor>(n, 3);
  y.head(3 * n).reshaped<Eigen::RowMajor>(n, 3) = of_points_ * from;
  return y;
}

NodalVector MassMatrix::acceleration(const NodalVector& force,
                                     const std::vector<char>& free) const {
  const Eigen::Index n = of_points_.rows();
  // Points that do not move have a row of the unit matrix, and so does what has no mass.
  const auto moves = [&](Eigen::Index p) {
    return free[static_cast<std::size_t>(p)] != 0 && of_points_.coeff(p, p) > 0;
  };
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix = of_points_;
  matrix.prune([&](Eigen::Index a, Eigen::Index b, double) { return moves(a) && moves(b); });
  Eigen::SparseMatrix<double, Eigen::RowMajor> others(n, n);
  Eigen::MatrixXd right = force.head(3 * n).reshaped<Eigen::RowMajor>(n, 3);
  const double unit = lumped_.sum() / static_cast<double>(n);
  for (Eigen::Index p = 0; p < n; ++p) {
    if (moves(p)) continue;
    others.insert(p, p) = unit;
    right.row(p).setZero();
  }
  matrix += others;
  // The condition number of a consistent mass matrix, scaled, is below a hundred (Wathen 1987).
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double, Eigen::RowMajor>,
                           Eigen::Lower | Eigen::Upper>
      solver(matrix);
  solver.setTolerance(1e-14);
  const Eigen::MatrixXd solution = solver.solve(right);
  return solution.reshaped<Eigen::RowMajor>();
}

void MassMatrix::add_to(double factor, std::vector<double>& values) const {
  for (const Target& target : targets_) {
    for (const Index position : target.positions) values[position] += factor * target.mass;
  }
}

NodalVector MassMatrix::weight(const Vec3& gravity) const {
  NodalVector load = NodalVector::Zero(state_size_);
  for (Eigen::Index a = 0; a < lumped_.size(); ++a) {
    load.segment<3>(3 * a) = lumped_[a] * gravity;
  }
  return load;
}

NodalVector weight_of(const Scene& scene, const Assembly& assembly) {
  return MassMatrix(scene, scene.densities, assembly).weight(scene.body_force);
}

}  // namespace palpate
