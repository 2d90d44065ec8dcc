// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/completion.h"

namespace palpate {

namespace {

/// s of each pressure, Pa/m.
Eigen::Map<const Eigen::VectorXd> pressure_scale(const HeldBody& body) {
  const auto& scale = body.assembly().pressure_scale();
  return {scale.data(), static_cast<Eigen::Index>(scale.size())};
}

}  // namespace

NodalVector state_of(const HeldBody& body, const Equilibrium& equilibrium) {
  if (!body.is_saddle()) return equilibrium.u;
  NodalVector state(body.assembly().state_size());
  state << equilibrium.u, equilibrium.p.cwiseQuotient(pressure_scale(body));
  return state;
}

Eigen::MatrixXd sensitivity_of(const HeldBody& body, const Equilibrium& equilibrium) {
  if (!body.is_saddle()) return equilibrium.v;
  Eigen::MatrixXd sensitivity(body.assembly().state_size(), equilibrium.v.cols());
  sensitivity << equilibrium.v,
      pressure_scale(body).cwiseInverse().asDiagonal() * equilibrium.p_v;
  return sensitivity;
}

Outcome complete(HeldBody& body, const NodalVector& state, Equilibrium& equilibrium,
                 NodalVector* newton_step) {
  TangentFactor* factor = body.factorise(state);
  if (factor == nullptr) return Outcome::tangent_not_factorised;
  const Assembly& assembly = body.assembly();
  const Eigen::Index parameters = body.num_parameters();
  const Eigen::Index displacements = 3 * Eigen::Index{assembly.num_points()};

  equilibrium.energy = body.evaluate(state);
  equilibrium.reaction = body.reaction();
  Eigen::VectorXd r;
  body.residual(r);
  Eigen::MatrixXd solutions(r.size(), parameters + 1);
  solutions << body.k_ia(), r;
  solutions = -solutions;
  body.solve(*factor, solutions);
  const auto v_i = solutions.leftCols(parameters);
  const NodalVector step = body.as_state(solutions.col(parameters));
  equilibrium.displacement_error =
      step.head(displacements).lpNorm<Eigen::Infinity>() / body.displacement_scale(equilibrium.t);
  if (newton_step != nullptr) *newton_step = step;
  equilibrium.stiffness = body.k_aa() + body.k_ia().transpose() * v_i;
  equilibrium.stiffness =
      0.5 * (equilibrium.stiffness + equilibrium.stiffness.transpose()).eval();
  Eigen::MatrixXd sensitivity(assembly.state_size(), parameters);
  for (Eigen::Index column = 0; column < parameters; ++column) {
    NodalVector of_column = body.as_state(v_i.col(column));
    body.place_sites(Eigen::VectorXd::Unit(parameters, column), of_column);
    sensitivity.col(column) = of_column;
  }
  if (!sensitivity.allFinite() || !equilibrium.stiffness.allFinite() || !step.allFinite()) {
    return Outcome::tangent_not_factorised;
  }
  equilibrium.u = state.head(displacements);
  equilibrium.v = sensitivity.topRows(displacements);
  equilibrium.p = state.tail(assembly.num_pressures()).cwiseProduct(pressure_scale(body));
  equilibrium.p_v =
      pressure_scale(body).asDiagonal() * sensitivity.bottomRows(assembly.num_pressures());
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
