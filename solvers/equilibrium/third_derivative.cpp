// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/third_derivative.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

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

/// D²r[v_a, v_b] for each pair of coordinates, a ≥ b [d].
using SecondDifferences = std::vector<std::vector<Eigen::VectorXd>>;

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
      const double change =
          (v.middleRows<3>(3 * Eigen::Index{p}) - v.middleRows<3>(3 * Eigen::Index{q}))
              .squaredNorm();
      largest_square =
          std::max(largest_square, change / (mesh.points[p] - mesh.points[q]).squaredNorm());
    }
  }
  return std::sqrt(largest_square);
}

/// @returns nothing if a residual is not defined.
std::optional<SecondDifferences> differences(CondensedSystem& system, const Eigen::VectorXd& t,
                                             const NodalVector& x, const Eigen::MatrixXd& v,
                                             double step) {
  const Eigen::Index d = v.cols();
  bool defined = true;
  const auto force_at = [&](const Eigen::VectorXd& way) -> Eigen::VectorXd {
    const Evaluation at = system.evaluate(t + way, x + v * way);
    defined = defined && at.is_finite();
    return v.transpose() * at.force + at.of_coordinates;
  };
  const Eigen::VectorXd middle = force_at(Eigen::VectorXd::Zero(d));
  const auto along = [&](const Eigen::VectorXd& way) -> Eigen::VectorXd {
    return (force_at(step * way) + force_at(-step * way) - 2 * middle) / (step * step);
  };
  SecondDifferences second(static_cast<std::size_t>(d));
  for (Eigen::Index a = 0; a < d; ++a) {
    for (Eigen::Index b = 0; b < a; ++b) {
      second[a].push_back(along(Eigen::VectorXd::Unit(d, a) + Eigen::VectorXd::Unit(d, b)));
    }
    second[a].push_back(along(Eigen::VectorXd::Unit(d, a)));
  }
  for (Eigen::Index a = 0; a < d; ++a) {
    for (Eigen::Index b = 0; b < a; ++b) {
      second[a][b] = 0.5 * (second[a][b] - second[a][a] - second[b][b]);
    }
  }
  if (!defined) return std::nullopt;
  return second;
}

}  // namespace

Eigen::VectorXd third_derivative(CondensedSystem& system, const Equilibrium& equilibrium) {
  const Eigen::Index d = system.num_coordinates();
  Eigen::VectorXd t = Eigen::VectorXd::Zero(num_third_derivatives(d));
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
  if (!second) {
    return Eigen::VectorXd::Constant(t.size(), std::numeric_limits<double>::quiet_NaN());
  }
  Eigen::Index next = 0;
  for (Eigen::Index a = 0; a < d; ++a) {
    for (Eigen::Index b = a; b < d; ++b) {
      for (Eigen::Index c = b; c < d; ++c) {
        t[next++] = ((*second)[b][a][c] + (*second)[c][b][a] + (*second)[c][a][b]) / 3;
      }
    }
  }
  return t;
}

}  // namespace palpate
