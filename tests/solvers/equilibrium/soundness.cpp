// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/equilibrium/soundness.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "solvers/equilibrium/state.h"
#include "solvers/support/bezier.h"
#include "solvers/support/deformation.h"

namespace palpate::test {
namespace {

/// EquilibriumOptions::tolerance is a share of this displacement, or of that of the tool spaces
/// where it is larger; in shares of the mean edge.
constexpr double kLeastDisplacement = 1e-3;
/// Of a residual that is summed up here in another order; times Σ|K_ij| |u|.
constexpr double kRounding = 1e-14;
/// EquilibriumOptions::displacement_error() is this many tolerances.
constexpr double kDisplacement = 100;
/// The most where rounding allows no better, which a flag must tell.
constexpr double kMostDisplacement = 1e-6;
/// Of det F, which is computed here by another order of operations; times the size of ∇u cubed.
constexpr double kDetF = 1e-9;

/// Σ|K_ij| over each row.
Eigen::VectorXd row_sums(const SymmetricPattern& pattern, const std::vector<double>& values) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(pattern.size);
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      sums[c] += std::abs(values[i]);
      if (pattern.row[i] != c) sums[pattern.row[i]] += std::abs(values[i]);
    }
  }
  return sums;
}

/// Root of the sum of squares over each row.
Eigen::VectorXd row_norms(const SymmetricPattern& pattern, std::vector<double> values) {
  for (double& value : values) value *= value;
  return row_sums(pattern, values).cwiseSqrt();
}

}  // namespace

std::vector<std::string> faults(const Equilibrium& state, const Assembly& assembly,
                                const Interaction& tool, double tolerance, const TetMesh* mesh) {
  std::vector<std::string> result;
  const auto require = [&](bool holds, const auto&... what) {
    if (holds) return;
    std::ostringstream text;
    (text << ... << what);
    result.push_back(text.str());
  };
  require(state.t.allFinite() && state.u.allFinite() && state.v.allFinite() &&
              state.p.allFinite() && state.p_v.allFinite() && state.reaction.allFinite() &&
              state.stiffness.allFinite(),
          "a vector holds numbers that are none");
  require(std::isfinite(state.energy) && std::isfinite(state.summary.residual) &&
              std::isfinite(state.minimum_det_f),
          "a figure is not finite");
  require(to_string(state.outcome) != "unknown", "the outcome has no name");
  const Flags told = state.flags & ~flags::inertia_not_computed;
  require((state.outcome == Outcome::converged && told == 0) || !state.summary.message.empty(),
          "what went wrong is not explained");
  require(((state.flags & flags::inverted) != 0) == (state.minimum_det_f <= 0),
          "the least det F is ", state.minimum_det_f, " and the flag 'inverted' says otherwise");
  if ((state.flags & flags::inertia_not_computed) == 0) {
    require(((state.flags & flags::unstable) != 0) == (state.negative_pivots > 0), "there are ",
            state.negative_pivots, " negative pivots and the flag 'unstable' says otherwise");
  }
  const bool is_inaccurate = (state.flags & flags::inaccurate) != 0;
  require(is_inaccurate == (state.displacement_error > kDisplacement * tolerance),
          "a Newton step would move it by ", state.displacement_error,
          " and the flag 'inaccurate' says otherwise");
  require(state.displacement_error <= std::max(kMostDisplacement, kDisplacement * tolerance),
          "a Newton step would move it by ", state.displacement_error);
  require(state.p.size() == assembly.num_pressures(), "there are ", state.p.size(),
          " pressures in place of ", assembly.num_pressures());
  if (!result.empty() || state.outcome == Outcome::tangent_not_factorised) return result;

  NodalVector force;
  std::vector<double> values;
  const NodalVector whole = state_of(assembly, state);
  const double energy = assembly.tangent(whole, force, values).energy;
  require(std::abs(state.energy - energy) <= 1e-12 * std::abs(energy), "the energy is ", energy,
          " in place of ", state.energy);
  const Eigen::VectorXd rows = row_sums(assembly.pattern(), values);
  std::vector<char> held(assembly.num_points(), 0);
  Eigen::VectorXd reaction = Eigen::VectorXd::Zero(state.t.size());
  Eigen::VectorXd in_sum = reaction;
  for (const auto& [point, coordinate] : tool.prescribed_points()) {
    held[point] = 1;
    require(Vec3(state.u.segment<3>(3 * point)) == Vec3(state.t.segment<3>(coordinate)), "point ",
            point, " is not where its tool is");
    reaction.segment<3>(coordinate) += force.segment<3>(3 * point);
    in_sum.segment<3>(coordinate) += force.segment<3>(3 * point).cwiseAbs();
  }
  require((state.reaction - reaction).norm() <= 1e-12 * in_sum.norm(), "the reaction is ",
          reaction.transpose(), " in place of ", state.reaction.transpose());

  std::vector<double> values_at_rest;
  NodalVector force_at_rest;
  (void)assembly.tangent(NodalVector::Zero(assembly.state_size()), force_at_rest, values_at_rest);
  const Eigen::VectorXd norms = row_norms(assembly.pattern(), values_at_rest);
  const double scale =
      std::max(state.t.lpNorm<Eigen::Infinity>(), kLeastDisplacement * assembly.mean_edge());
  const double largest = whole.lpNorm<Eigen::Infinity>();
  for (Index i = 0; i < assembly.pattern().size; ++i) {
    const Index place = assembly.state_of_unknown()[i];
    if (place < 3 * assembly.num_points() && held[place / 3] != 0) continue;
    const double rounding = kRounding * rows[i] * largest;
    const double residual = std::max(0.0, std::abs(force[place]) - rounding) / (norms[i] * scale);
    if (residual <= std::min(tolerance, (1 + kRounding) * state.summary.residual)) continue;
    require(false, "the residual at place ", place, " of the state is ", residual,
            " of its scale, and the largest is said to be ", state.summary.residual);
    break;
  }
  if (mesh != nullptr) {
    TetMesh oriented = *mesh;
    check_and_orient(oriented);
    const double least = least_det_f(oriented, state.u);
    bool inverted = least <= 0;
    for (Index c = 0; c < oriented.num_cells() && !inverted; ++c) {
      inverted = is_inverted(corner_jacobians(oriented, c, state.u));
    }
    require(inverted == (state.minimum_det_f <= 0), "det F is ", inverted ? "not " : "",
            "positive everywhere, and its least value is said to be ", state.minimum_det_f);
    const bool is_between = least > 0 && inverted;
    require(is_between ||
                std::abs(least - state.minimum_det_f) <= kDetF * std::max(1.0, std::abs(least)),
            "the least det F is ", least, " in place of ", state.minimum_det_f);
  }
  return result;
}

}  // namespace palpate::test
