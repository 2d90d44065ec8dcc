// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/inner_extension.h"

namespace palpate {
namespace {

/// Relative residual of conjugate gradients.
constexpr double kTolerance = 1e-3;

}  // namespace

InnerExtension::InnerExtension(const Assembly& assembly, const std::vector<Index>& known) {
  const Eigen::Index displacements = 3 * Eigen::Index{assembly.num_points()};
  std::vector<char> is_known(static_cast<std::size_t>(displacements), 0);
  for (const Index p : known) {
    for (int a = 0; a < 3; ++a) is_known[static_cast<std::size_t>(3 * p + a)] = 1;
  }
  // The index of each unknown among those inside; −1: it is not inside.
  const std::vector<Index>& state_of_unknown = assembly.state_of_unknown();
  std::vector<Index> number(state_of_unknown.size(), -1);
  for (std::size_t i = 0; i < state_of_unknown.size(); ++i) {
    const Index place = state_of_unknown[i];
    if (place >= displacements || is_known[static_cast<std::size_t>(place)] != 0) continue;
    number[i] = static_cast<Index>(inside_.size());
    inside_.push_back(place);
  }
  if (inside_.empty()) return;
  NodalVector force;
  std::vector<double> values;
  (void)assembly.tangent(NodalVector::Zero(assembly.state_size()), force, values);
  const SymmetricPattern& pattern = assembly.pattern();
  std::vector<Eigen::Triplet<double>> inner;
  std::vector<Eigen::Triplet<double>> coupling;
  for (Index column = 0; column < pattern.size; ++column) {
    for (Index at = pattern.column_start[column]; at < pattern.column_start[column + 1]; ++at) {
      const Index row = pattern.row[at];
      const Index a = number[static_cast<std::size_t>(row)];
      const Index b = number[static_cast<std::size_t>(column)];
      const Index of_row = state_of_unknown[static_cast<std::size_t>(row)];
      const Index of_column = state_of_unknown[static_cast<std::size_t>(column)];
      if (a >= 0 && b >= 0) {
        inner.emplace_back(a, b, values[at]);
        if (a != b) inner.emplace_back(b, a, values[at]);
      } else if (a >= 0 && of_column < displacements) {
        coupling.emplace_back(a, of_column, values[at]);
      } else if (b >= 0 && of_row < displacements) {
        coupling.emplace_back(b, of_row, values[at]);
      }
    }
  }
  const auto size = static_cast<Eigen::Index>(inside_.size());
  inner_.resize(size, size);
  inner_.setFromTriplets(inner.begin(), inner.end());
  coupling_.resize(size, displacements);
  coupling_.setFromTriplets(coupling.begin(), coupling.end());
  solver_.setTolerance(kTolerance);
  solver_.compute(inner_);
}

void InnerExtension::fill(NodalVector& u) const {
  if (inside_.empty()) return;
  for (const Index place : inside_) u[place] = 0;
  const Eigen::VectorXd load = -(coupling_ * u);
  const Eigen::VectorXd found = solver_.solve(load);
  for (std::size_t i = 0; i < inside_.size(); ++i) {
    u[inside_[i]] = found[static_cast<Eigen::Index>(i)];
  }
}

}  // namespace palpate
