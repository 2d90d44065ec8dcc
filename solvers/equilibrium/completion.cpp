// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/completion.h"

namespace palpate {

NodalVector state_of(const HeldBody& body, const Equilibrium& equilibrium) {
  if (!body.is_saddle()) return equilibrium.u;
  NodalVector state(body.assembly().state_size());
  state << equilibrium.u, equilibrium.p / body.assembly().pressure_scale();
  return state;
}

Eigen::MatrixXd sensitivity_of(const HeldBody& body, const Equilibrium& equilibrium) {
  if (!body.is_saddle()) return equilibrium.v;
  Eigen::MatrixXd sensitivity(body.assembly().state_size(), equilibrium.v.cols());
  sensitivity << equilibrium.v, equilibrium.p_v / body.assembly().pressure_scale();
  return sensitivity;
}

Outcome complete(HeldBody& body, const NodalVector& state, Equilibrium& equilibrium) {
  TangentFactor* factor = body.factorise(state);
  if (factor == nullptr) return Outcome::tangent_not_factorised;
  const Assembly& assembly = body.assembly();
  const Eigen::Index parameters = body.num_parameters();
  const Eigen::Index displacements = 3 * Eigen::Index{assembly.num_points()};

  Eigen::MatrixXd v_i = -body.k_ia();
  body.solve(*factor, v_i);
  equilibrium.stiffness = body.k_aa() + body.k_ia().transpose() * v_i;
  equilibrium.stiffness =
      0.5 * (equilibrium.stiffness + equilibrium.stiffness.transpose()).eval();
  Eigen::MatrixXd sensitivity(assembly.state_size(), parameters);
  for (Eigen::Index column = 0; column < parameters; ++column) {
    NodalVector of_column = body.as_state(v_i.col(column));
    body.place_sites(Eigen::VectorXd::Unit(parameters, column), of_column);
    sensitivity.col(column) = of_column;
  }
  if (!sensitivity.allFinite() || !equilibrium.stiffness.allFinite()) {
    return Outcome::tangent_not_factorised;
  }
  equilibrium.u = state.head(displacements);
  equilibrium.v = sensitivity.topRows(displacements);
  equilibrium.p = assembly.pressure_scale() * state.tail(assembly.num_pressures());
  equilibrium.p_v = assembly.pressure_scale() * sensitivity.bottomRows(assembly.num_pressures());
  equilibrium.energy = body.evaluate(state);
  equilibrium.reaction = body.reaction();
  equilibrium.negative_pivots = body.negative_pivots(*factor);
  const Assembly::Determinant least = assembly.minimum_det_f(state);
  equilibrium.minimum_det_f = least.value;
  equilibrium.minimum_det_f_cell = least.cell;
  equilibrium.num_inverted_cells = least.num_inverted_cells;
  equilibrium.flags = 0;
  if (least.value <= 0) equilibrium.flags |= flags::inverted;
  if (equilibrium.negative_pivots > 0) equilibrium.flags |= flags::unstable;
  return Outcome::converged;
}

}  // namespace palpate
