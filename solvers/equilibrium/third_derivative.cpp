// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/third_derivative.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "equilibrium/linearisation.h"

namespace palpate {
namespace {

/// The largest strain of a difference step. The relative error of the difference is its square.
/// Rounding, 1e-16 over the square, is as large at a third of this strain. The total error of T is
/// 1e-7, even where the body is stiff against changes of volume. v may have a larger error.
constexpr double kStrain = 3e-4;
/// The longest step as a share of the displacement scale: the potential of a tool has a scale of
/// its own.
constexpr double kLongestStep = 1e-3;
/// A step is halved at most this often if one of its ends inverts a cell.
constexpr int kMaxHalvings = 12;

/// The axes of each component of T.
constexpr int kAxes[10][3] = {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 1, 1}, {0, 1, 2},
                              {0, 2, 2}, {1, 1, 1}, {1, 1, 2}, {1, 2, 2}, {2, 2, 2}};

/// D²r[v_a, v_b] · v_c for each pair of axes.
struct SecondDifferences {
  Vec3 of[3][3];
};

/// An estimate of the largest strain of the columns of v per unit of t, 1/m, from lines between the
/// nodes of each cell.
double largest_strain(const TetMesh& mesh, const Eigen::MatrixXd& v) {
  double largest_square = 0;
  const int nodes = nodes_per_cell(mesh.order);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    for (int i = 0; i < nodes; ++i) {
      const Index p = cell[i];
      const Index q = cell[(i + 1) % nodes];
      const Mat3 change =
          v.middleRows<3>(3 * Eigen::Index{p}) - v.middleRows<3>(3 * Eigen::Index{q});
      largest_square = std::max(
          largest_square, change.squaredNorm() / (mesh.points[p] - mesh.points[q]).squaredNorm());
    }
  }
  return std::sqrt(largest_square);
}

/// @returns nothing if a residual is not defined.
std::optional<SecondDifferences> differences(CondensedSystem& system, const Eigen::VectorXd& t,
                                             const NodalVector& x, const Eigen::MatrixXd& v,
                                             double step) {
  bool defined = true;
  const auto force_at = [&](const Vec3& way) -> Vec3 {
    const Evaluation at = system.evaluate(t + way, x + v * way);
    defined = defined && at.is_finite();
    return v.transpose() * at.force + at.of_coordinates;
  };
  const Vec3 middle = force_at(Vec3::Zero());
  const auto along = [&](const Vec3& way) -> Vec3 {
    return (force_at(step * way) + force_at(-step * way) - 2 * middle) / (step * step);
  };
  SecondDifferences second;
  for (int a = 0; a < 3; ++a) second.of[a][a] = along(Vec3::Unit(a));
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < a; ++b) {
      const Vec3 both = along(Vec3::Unit(a) + Vec3::Unit(b));
      second.of[a][b] = 0.5 * (both - second.of[a][a] - second.of[b][b]);
      second.of[b][a] = second.of[a][b];
    }
  }
  if (!defined) return std::nullopt;
  return second;
}

}  // namespace

Eigen::VectorXd third_derivative(CondensedSystem& system, const Equilibrium& equilibrium) {
  assert(system.num_coordinates() == 3);
  Eigen::VectorXd t = Eigen::VectorXd::Zero(10);
  if (system.is_linear() || equilibrium.v.isZero(0)) return t;
  const NodalVector x = system.vector_of(equilibrium);
  const Eigen::MatrixXd v = system.sensitivity_of(equilibrium);
  double step = std::min(kStrain / largest_strain(system.mesh(), equilibrium.v),
                         kLongestStep * system.displacement_scale(equilibrium.t));
  std::optional<SecondDifferences> second = differences(system, equilibrium.t, x, v, step);
  for (int i = 0; !second && i < kMaxHalvings; ++i) {
    step *= 0.5;
    second = differences(system, equilibrium.t, x, v, step);
  }
  if (!second) return Eigen::VectorXd::Constant(10, std::numeric_limits<double>::quiet_NaN());
  for (int i = 0; i < 10; ++i) {
    const auto& [a, b, c] = kAxes[i];
    t[i] = (second->of[a][b][c] + second->of[b][c][a] + second->of[c][a][b]) / 3;
  }
  return t;
}

}  // namespace palpate
