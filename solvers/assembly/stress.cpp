// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/stress.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <limits>

#include "assembly/kernels.h"

namespace palpate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// The indices of xx yy zz xy yz xz in the components xx yy zz yz xz xy of the kernels.
constexpr int kKernelComponent[6] = {0, 1, 2, 5, 3, 4};

StressField make_field(Index count) {
  StressField field;
  field.cauchy.resize(6, count);
  field.von_mises.resize(count);
  field.principal_stretches.resize(3, count);
  return field;
}

double von_mises(const Eigen::Matrix<double, 6, 1>& s) {
  const Vec3 differences(s[0] - s[1], s[1] - s[2], s[2] - s[0]);
  return std::sqrt(0.5 * differences.squaredNorm() + 3 * s.tail<3>().squaredNorm());
}

/// Principal stretches, computed from E, so that small strains keep their digits.
Vec3 principal_stretches(const Mat3& displacement_gradient) {
  const Mat3& h = displacement_gradient;
  const Mat3 strain = 0.5 * (h + h.transpose() + h.transpose() * h);
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(strain, Eigen::EigenvaluesOnly);
  return (1 + 2 * solver.eigenvalues().array()).max(0).sqrt().reverse();
}

StressField of_cells(const Eigen::MatrixXd& sums) {
  const auto num_cells = static_cast<Index>(sums.cols());
  StressField field = make_field(num_cells);
  for (Index c = 0; c < num_cells; ++c) {
    const auto of_cell = sums.col(c);
    const bool defined = of_cell[StressSum::minimum_det_f] > 0;
    for (int m = 0; m < 6; ++m) {
      field.cauchy(m, c) = defined ? of_cell[StressSum::cauchy + kKernelComponent[m]] /
                                         of_cell[StressSum::deformed_volume]
                                   : kNan;
    }
    field.von_mises[c] = von_mises(field.cauchy.col(c));
    Mat3 h;
    for (int i = 0; i < 9; ++i) {
      h(i / 3, i % 3) = of_cell[StressSum::displacement_gradient + i] / of_cell[StressSum::volume];
    }
    field.principal_stretches.col(c) = principal_stretches(h);
  }
  return field;
}

StressField at_points(const StressField& cells, const TetMesh& mesh, const Eigen::MatrixXd& sums) {
  const Index count = mesh.num_points();
  StressField field = make_field(count);
  field.cauchy.setZero();
  field.von_mises.setZero();
  field.principal_stretches.setZero();
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd volume_with_stress = volume;
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const double weight = sums(StressSum::volume, c);
    const bool has_stress = !std::isnan(cells.von_mises[c]);
    for (int a = 0; a < nodes_per_cell(mesh.order); ++a) {
      const Index point = mesh.cell(c)[a];
      volume[point] += weight;
      field.principal_stretches.col(point) += weight * cells.principal_stretches.col(c);
      if (!has_stress) continue;
      volume_with_stress[point] += weight;
      field.cauchy.col(point) += weight * cells.cauchy.col(c);
      field.von_mises[point] += weight * cells.von_mises[c];
    }
  }
  // Where there is no such volume, 0/0 gives the intended NaN.
  field.cauchy.array().rowwise() /= volume_with_stress.transpose().array();
  field.von_mises.array() /= volume_with_stress.array();
  field.principal_stretches.array().rowwise() /= volume.transpose().array();
  return field;
}

}  // namespace

BodyStress find_stress(const Assembly& assembly, const TetMesh& mesh, const NodalVector& u,
                       const NodalVector& p) {
  NodalVector state = NodalVector::Zero(assembly.state_size());
  state.head(u.size()) = u;
  for (Eigen::Index i = 0; i < p.size(); ++i) {
    state[u.size() + i] = p[i] / assembly.pressure_scale()[i];
  }
  const Eigen::MatrixXd sums = assembly.stress_sums(state);
  BodyStress stress;
  stress.of_cells = of_cells(sums);
  stress.at_points = at_points(stress.of_cells, mesh, sums);
  return stress;
}

}  // namespace palpate
