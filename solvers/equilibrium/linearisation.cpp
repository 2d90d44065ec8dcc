// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/linearisation.h"

#include <algorithm>

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
  sensitivity << equilibrium.v, pressure_scale(body).cwiseInverse().asDiagonal() * equilibrium.p_v;
  return sensitivity;
}

namespace {

/// Fills in what follows from the state.
void take_state(const HeldBody& body, const NodalVector& state, Equilibrium& equilibrium) {
  const Assembly& assembly = body.assembly();
  equilibrium.u = state.head(3 * Eigen::Index{assembly.num_points()});
  equilibrium.p = state.tail(assembly.num_pressures()).cwiseProduct(pressure_scale(body));
  const Assembly::Determinant least = assembly.minimum_det_f(state);
  equilibrium.minimum_det_f = least.value;
  equilibrium.minimum_det_f_cell = least.cell;
  equilibrium.num_inverted_cells = least.num_inverted_cells;
  equilibrium.flags = least.value <= 0 ? flags::inverted : 0;
}

/// Fills in what follows from v of the free unknowns.
void take_sensitivity(const HeldBody& body, const Eigen::Ref<const Eigen::MatrixXd>& v_i,
                      Equilibrium& equilibrium) {
  const Assembly& assembly = body.assembly();
  const Eigen::Index parameters = body.num_parameters();
  const Eigen::Index displacements = 3 * Eigen::Index{assembly.num_points()};
  Eigen::MatrixXd sensitivity(assembly.state_size(), parameters);
  for (Eigen::Index column = 0; column < parameters; ++column) {
    NodalVector of_column = body.as_state(v_i.col(column));
    body.place_sites(Eigen::VectorXd::Unit(parameters, column), of_column);
    sensitivity.col(column) = of_column;
  }
  equilibrium.v = sensitivity.topRows(displacements);
  equilibrium.p_v =
      pressure_scale(body).asDiagonal() * sensitivity.bottomRows(assembly.num_pressures());
}

/// Fills in how far Newton's method would still move the body.
void take_newton_step(const HeldBody& body, const Eigen::VectorXd& unknowns,
                      Equilibrium& equilibrium, NodalVector* newton_step) {
  const NodalVector step = body.as_state(unknowns);
  equilibrium.displacement_error =
      step.head(3 * Eigen::Index{body.assembly().num_points()}).lpNorm<Eigen::Infinity>() /
      body.displacement_scale(equilibrium.t);
  if (newton_step != nullptr) *newton_step = step;
}

void take_inertia(int negative_pivots, Equilibrium& equilibrium) {
  equilibrium.negative_pivots = negative_pivots;
  if (negative_pivots > 0) equilibrium.flags |= flags::unstable;
}

void set_stiffness(const Eigen::MatrixXd& k, Equilibrium& equilibrium) {
  equilibrium.stiffness = 0.5 * (k + k.transpose());
}

/// Iterations of conjugate gradients at most: more would cost as much as a factorisation.
constexpr int kMaxIterations = 14;

/// A step of refinement that is this small beside v leaves an error of about its square.
constexpr double kLastRefinement = 1e-4;
constexpr int kMaxRefinements = 4;

/// Takes a step of refinement of v, with a factor of the last tangent.
Eigen::MatrixXd refine_once(HeldBody& body, TangentFactor& factor, Eigen::Ref<Eigen::MatrixXd> v) {
  Eigen::MatrixXd step = -body.k_ia() - body.times_tangent(v);
  body.solve(factor, step);
  v += step;
  return step;
}

/// Makes v accurate, which comes of a rough factor of the last tangent.
/// @returns false where the factor is not good enough.
bool refine(HeldBody& body, TangentFactor& factor, Eigen::Ref<Eigen::MatrixXd> v) {
  for (int i = 0; i < kMaxRefinements; ++i) {
    const Eigen::MatrixXd step = refine_once(body, factor, v);
    if ((step.colwise().norm().array() <= kLastRefinement * v.colwise().norm().array()).all()) {
      return true;
    }
  }
  return false;
}

}  // namespace

Outcome linearise(HeldBody& body, const NodalVector& state, Equilibrium& equilibrium,
                  NodalVector* newton_step) {
  TangentFactor* factor = body.factorise(state);
  if (factor == nullptr) return Outcome::tangent_not_factorised;
  const Eigen::Index parameters = body.num_parameters();

  equilibrium.energy = body.evaluate(state);
  equilibrium.reaction = body.reaction();
  Eigen::VectorXd r;
  body.residual(r);
  Eigen::MatrixXd solutions(r.size(), parameters + 1);
  solutions << body.k_ia(), r;
  solutions = -solutions;
  const Eigen::MatrixXd right_hand_sides = solutions;
  body.solve(*factor, solutions);
  if (factor->is_rough() && !refine(body, *factor, solutions.leftCols(parameters))) {
    factor = body.factorise_accurately(state);
    if (factor == nullptr) return Outcome::tangent_not_factorised;
    solutions = right_hand_sides;
    body.solve(*factor, solutions);
  }
  if (!solutions.allFinite()) return Outcome::tangent_not_factorised;
  auto v_i = solutions.leftCols(parameters);
  take_newton_step(body, solutions.col(parameters), equilibrium, newton_step);
  if (body.assembly().is_linear()) {
    // All displacements are made of v.
    const Eigen::MatrixXd error = refine_once(body, *factor, v_i);
    equilibrium.displacement_error =
        std::max(equilibrium.displacement_error, error.rowwise().lpNorm<1>().maxCoeff());
  }
  set_stiffness(body.k_aa() + body.k_ia().transpose() * v_i, equilibrium);
  take_sensitivity(body, v_i, equilibrium);
  take_state(body, state, equilibrium);
  take_inertia(body.negative_pivots(*factor), equilibrium);
  return Outcome::converged;
}

void superpose(HeldBody& body, const Equilibrium& start, const NodalVector& state,
               Equilibrium& equilibrium) {
  equilibrium.energy = body.evaluate(state);
  equilibrium.reaction = body.reaction();
  equilibrium.stiffness = start.stiffness;
  equilibrium.v = start.v;
  equilibrium.p_v = start.p_v;
  equilibrium.displacement_error = start.displacement_error;
  take_state(body, state, equilibrium);
  take_inertia(start.negative_pivots, equilibrium);
}

bool linearise_by_iteration(HeldBody& body, const EquilibriumOptions& options,
                            const Correction& correction, const Equilibrium& start,
                            const NodalVector& state, double error, Equilibrium& equilibrium) {
  if (body.is_saddle()) return false;
  const NodalVector start_state = state_of(body, start);
  TangentFactor* factor = correction.factor;
  if (factor == nullptr) factor = body.find_factor(start_state);
  if (factor == nullptr) factor = body.factorise(start_state);
  if (factor == nullptr || body.negative_pivots(*factor) > 0) return false;
  const auto precondition = [&](Eigen::Ref<Eigen::MatrixXd> columns) {
    correction.quasi_newton->apply(columns, [&](auto each) { body.solve(*factor, each); });
  };
  body.assemble_tangent(state);
  equilibrium.energy = body.evaluate(state);
  equilibrium.reaction = body.reaction();
  const Eigen::Index parameters = body.num_parameters();
  Eigen::MatrixXd v(body.k_ia().rows(), parameters);
  for (Eigen::Index c = 0; c < parameters; ++c) v.col(c) = body.as_unknowns(start.v.col(c));
  Eigen::MatrixXd residual = -body.k_ia() - body.times_tangent(v);
  Eigen::VectorXd r;
  body.residual(r);

  Eigen::MatrixXd z(r.size(), parameters + 1);
  z << residual, r;
  precondition(z);
  equilibrium.displacement_error =
      z.col(parameters).lpNorm<Eigen::Infinity>() / body.displacement_scale(equilibrium.t);
  if (!(equilibrium.displacement_error <= options.displacement_error())) return false;
  z.conservativeResize(Eigen::NoChange, parameters);
  Eigen::MatrixXd p = z;
  Eigen::RowVectorXd rho = residual.cwiseProduct(z).colwise().sum();
  const auto is_done = [&] {
    return (z.colwise().norm().array() <= error * v.colwise().norm().array()).all();
  };
  for (int i = 0; !is_done(); ++i) {
    if (i == kMaxIterations) return false;
    const Eigen::MatrixXd q = body.times_tangent(p);
    const Eigen::RowVectorXd curvature = p.cwiseProduct(q).colwise().sum();
    if (!(curvature.array() > 0).all()) return false;
    const Eigen::RowVectorXd alpha = rho.cwiseQuotient(curvature);
    v += p * alpha.asDiagonal();
    residual -= q * alpha.asDiagonal();
    z = residual;
    precondition(z);
    const Eigen::RowVectorXd next_rho = residual.cwiseProduct(z).colwise().sum();
    p = z + p * next_rho.cwiseQuotient(rho).asDiagonal();
    rho = next_rho;
  }
  set_stiffness(body.k_aa() + body.k_ia().transpose() * v - v.transpose() * residual, equilibrium);
  take_sensitivity(body, v, equilibrium);
  take_state(body, state, equilibrium);
  equilibrium.negative_pivots = 0;
  equilibrium.flags |= flags::inertia_not_computed;
  return true;
}

}  // namespace palpate
