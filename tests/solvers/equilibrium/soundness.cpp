// SPDX-License-Identifier: BSD-3-Clause
#include "solvers/equilibrium/soundness.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "solvers/equilibrium/state.h"
#include "solvers/support/deformation.h"

namespace palpate::test {
namespace {

/// Of a component of the residual, in shares of Σ|K_ij| times the largest displacement. A solver
/// that measures by the mean row leaves more where a body has parts of different stiffness.
constexpr double kResidual = 1e-6;
/// Newton step from a solution, in shares of the displacement of the sites: what the residual of
/// each row does not show, such as the net force on a stiff part that is free to move.
constexpr double kDisplacement = 1e-6;
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

}  // namespace

std::vector<std::string> faults(const Equilibrium& state, const Assembly& assembly,
                                const Constraint& constraint, const TetMesh* mesh) {
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
  require(std::isfinite(state.energy) && std::isfinite(state.residual) &&
              std::isfinite(state.minimum_det_f),
          "a figure is not finite");
  require(to_string(state.outcome) != "unknown", "the outcome has no name");
  const Flags told = state.flags & ~flags::inertia_not_computed;
  require((state.outcome == Outcome::converged && told == 0) || !state.message.empty(),
          "what went wrong is not explained");
  require(((state.flags & flags::inverted) != 0) == (state.minimum_det_f <= 0),
          "the least det F is ", state.minimum_det_f, " and the flag 'inverted' says otherwise");
  if ((state.flags & flags::inertia_not_computed) == 0) {
    require(((state.flags & flags::unstable) != 0) == (state.negative_pivots > 0), "there are ",
            state.negative_pivots, " negative pivots and the flag 'unstable' says otherwise");
  }
  require(state.outcome != Outcome::converged || state.displacement_error <= kDisplacement,
          "converged, though a Newton step would move it by ", state.displacement_error);
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
  for (std::size_t i = 0; i < constraint.points.size(); ++i) {
    const Index point = constraint.points[i];
    const Index site = constraint.site_of_point[i];
    held[point] = 1;
    require(Vec3(state.u.segment<3>(3 * point)) == Vec3(state.t.segment<3>(3 * site)), "point ",
            point, " is not where its site is");
    reaction.segment<3>(3 * site) += force.segment<3>(3 * point);
    in_sum.segment<3>(3 * site) += force.segment<3>(3 * point).cwiseAbs();
  }
  require((state.reaction - reaction).norm() <= 1e-12 * in_sum.norm(), "the reaction is ",
          reaction.transpose(), " in place of ", state.reaction.transpose());

  // A displacement that is less than a millionth of an edge is none, after one that was larger.
  const double largest = std::max(whole.lpNorm<Eigen::Infinity>(), 1e-6 * assembly.mean_edge());
  for (Index i = 0; i < assembly.pattern().size; ++i) {
    const Index place = assembly.state_of_unknown()[i];
    if (place < 3 * assembly.num_points() && held[place / 3] != 0) continue;
    if (std::abs(force[place]) <= kResidual * rows[i] * largest) continue;
    require(false, "the residual at place ", place, " of the state is ", std::abs(force[place]),
            ", ", std::abs(force[place]) / (rows[i] * largest), " of its scale");
    break;
  }
  if (mesh != nullptr) {
    const double least = least_det_f(*mesh, state.u);
    require(std::abs(least - state.minimum_det_f) <= kDetF * std::max(1.0, std::abs(least)),
            "the least det F is ", least, " in place of ", state.minimum_det_f);
  }
  return result;
}

}  // namespace palpate::test
