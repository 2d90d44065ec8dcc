// SPDX-License-Identifier: BSD-3-Clause
#include "discretisation/pressure_recovery.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <utility>

#include "elements/tetrahedron.h"

namespace palpate {
namespace {

/// A linear polynomial is fitted to as many cells at the least; to fewer a constant.
constexpr std::size_t kLeastOfLinear = 10;

}  // namespace

PressureRecovery::PressureRecovery(const TetMesh& mesh, std::vector<Index> pressures_of_corners,
                                   Index num_pressures)
    : pressures_of_corners_(std::move(pressures_of_corners)) {
  if (num_pressures == 0) return;
  for (const QuadraturePoint& point : quadrature(mesh.order)) {
    shares_.emplace_back(shape_values(ElementOrder::linear, point.xi));
  }
  corners_.resize(3, 4 * Eigen::Index{mesh.num_cells()});
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    for (int a = 0; a < 4; ++a) {
      corners_.col(4 * Eigen::Index{c} + a) = mesh.points[mesh.cell(c)[a]];
    }
  }
  make_gradients(mesh, num_pressures);
}

void PressureRecovery::make_gradients(const TetMesh& mesh, Index num_pressures) {
  std::vector<std::vector<Index>> cells_around(static_cast<std::size_t>(num_pressures));
  std::vector<Vec3> places(static_cast<std::size_t>(num_pressures));
  // ∂λ/∂x of each cell.
  std::vector<Eigen::Matrix<double, 3, 4>> of_cells(static_cast<std::size_t>(mesh.num_cells()));
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    if (pressure(c, 0) < 0) continue;
    const auto x = corners_.middleCols<4>(4 * Eigen::Index{c});
    Mat3 edges;
    for (int a = 0; a < 3; ++a) edges.col(a) = x.col(a + 1) - x.col(0);
    const Mat3 inverse = edges.inverse();
    auto& gradients = of_cells[c];
    gradients.rightCols<3>() = inverse.transpose();
    gradients.col(0) = -gradients.rightCols<3>().rowwise().sum();
    for (int a = 0; a < 4; ++a) {
      cells_around[pressure(c, a)].push_back(c);
      places[pressure(c, a)] = x.col(a);
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Index node = 0; node < num_pressures; ++node) {
    const std::vector<Index>& cells = cells_around[node];
    const int terms = cells.size() >= kLeastOfLinear ? 4 : 1;
    Eigen::MatrixXd fit(static_cast<Eigen::Index>(cells.size()), terms);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      fit(row, 0) = 1;
      if (terms == 1) continue;
      const Vec3 centre = corners_.middleCols<4>(4 * Eigen::Index{cells[i]}).rowwise().mean();
      fit.row(row).tail<3>() = (centre - places[node]).transpose();
    }
    if (terms == 4) fit.rightCols<3>() /= fit.rightCols<3>().rowwise().norm().maxCoeff();
    // The polynomial at the node is its first coefficient.
    const Eigen::RowVectorXd weights = fit.completeOrthogonalDecomposition().pseudoInverse().row(0);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      for (int a = 0; a < 4; ++a) {
        for (int k = 0; k < 3; ++k) {
          entries.emplace_back(3 * node + k, pressure(cells[i], a),
                               weights[static_cast<Eigen::Index>(i)] * of_cells[cells[i]](k, a));
        }
      }
    }
  }
  gradients_.resize(3 * Eigen::Index{num_pressures}, num_pressures);
  gradients_.setFromTriplets(entries.begin(), entries.end());
}

template <class Value>
NodalVector PressureRecovery::at_each_point(Value&& value) const {
  const Eigen::Index num_cells = corners_.cols() / 4;
  const auto per_cell = static_cast<Eigen::Index>(shares_.size());
  NodalVector result = NodalVector::Zero(num_cells * per_cell);
  for (Eigen::Index point = 0; point < result.size(); ++point) {
    const auto cell = static_cast<Index>(point / per_cell);
    if (pressure(cell, 0) < 0) continue;
    result[point] = value(cell, shares_[static_cast<std::size_t>(point % per_cell)]);
  }
  return result;
}

NodalVector PressureRecovery::at_points(const Eigen::Ref<const NodalVector>& p) const {
  return at_each_point([&](Index cell, const Eigen::Vector4d& shares) {
    double sum = 0;
    for (int a = 0; a < 4; ++a) sum += shares[a] * p[pressure(cell, a)];
    return sum;
  });
}

NodalVector PressureRecovery::errors(const Eigen::Ref<const NodalVector>& p) const {
  const Eigen::VectorXd gradients = gradients_ * p;
  return at_each_point([&](Index cell, const Eigen::Vector4d& shares) {
    const auto x = corners_.middleCols<4>(4 * Eigen::Index{cell});
    const Vec3 place = x * shares;
    double sum = 0;
    for (int a = 0; a < 4; ++a) {
      const Vec3 gradient = gradients.segment<3>(3 * Eigen::Index{pressure(cell, a)});
      sum += 0.5 * shares[a] * gradient.dot(place - x.col(a));
    }
    return sum;
  });
}

}  // namespace palpate
