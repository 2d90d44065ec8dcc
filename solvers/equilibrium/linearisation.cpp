// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/linearisation.h"

#include <algorithm>

namespace palpate {

void take_worst_cell(const Assembly& assembly, const NodalVector& x, LinearisedState& state) {
  const Assembly::Determinant least = assembly.minimum_det_f(x);
  state.minimum_det_f = least.value;
  state.minimum_det_f_cell = least.cell;
  state.num_inverted_cells = least.num_inverted_cells;
}

void take_determinant(const Assembly& assembly, const NodalVector& x, LinearisedState& state) {
  take_worst_cell(assembly, x, state);
  state.flags = state.minimum_det_f <= 0 ? flags::inverted : 0;
}

namespace {

/// Fills in the members that follow from x.
void take_vector(const CondensedSystem& system, const NodalVector& x, LinearisedState& state) {
  const Assembly& assembly = system.assembly();
  state.u = x.head(3 * Eigen::Index{assembly.num_points()});
  state.p = x.tail(assembly.num_pressures()).cwiseProduct(system.pressure_scale());
  take_determinant(assembly, x, state);
}

/// Fills in the members that follow from v of the free unknowns.
void take_sensitivity(const CondensedSystem& system, const Eigen::Ref<const Eigen::MatrixXd>& v_i,
                      LinearisedState& state) {
  const Assembly& assembly = system.assembly();
  const Eigen::Index coordinates = system.num_coordinates();
  const Eigen::Index displacements = 3 * Eigen::Index{assembly.num_points()};
  Eigen::MatrixXd sensitivity(assembly.state_size(), coordinates);
  for (Eigen::Index column = 0; column < coordinates; ++column) {
    NodalVector of_column = system.as_state(v_i.col(column));
    system.prescribe_change(Eigen::VectorXd::Unit(coordinates, column), of_column);
    sensitivity.col(column) = of_column;
  }
  state.v = sensitivity.topRows(displacements);
  state.p_v =
      system.pressure_scale().asDiagonal() * sensitivity.bottomRows(assembly.num_pressures());
}

/// The length of a Newton step, as a share of the displacement scale at t.
double error_of(const CondensedSystem& system, const NodalVector& newton_step,
                const Eigen::VectorXd& t) {
  return newton_step.head(3 * Eigen::Index{system.assembly().num_points()})
             .lpNorm<Eigen::Infinity>() /
         system.displacement_scale(t);
}

void take_inertia(int negative_pivots, LinearisedState& state) {
  state.negative_pivots = negative_pivots;
  if (negative_pivots > 0) state.flags |= flags::unstable;
}

void take_stiffness(const Eigen::MatrixXd& k, LinearisedState& state) {
  state.stiffness = 0.5 * (k + k.transpose());
}

/// The linearisation of the body at rest with a tool that does not touch it. The system knows the
/// stability of the rest.
Linearisation at_rest_alone(const CondensedSystem& system, const Eigen::VectorXd& t,
                            const NodalVector& x) {
  const Assembly& assembly = system.assembly();
  const Index coordinates = system.num_coordinates();
  Linearisation result;
  LinearisedState& state = result.state;
  state.t = t;
  take_vector(system, x, state);
  state.v.setZero(state.u.size(), coordinates);
  state.p_v.setZero(assembly.num_pressures(), coordinates);
  state.reaction.setZero(coordinates);
  state.stiffness.setZero(coordinates, coordinates);
  const RestStability& stability = *system.rest_stability();
  state.negative_pivots = stability.negative_pivots;
  state.lowest_eigenvalue = stability.lowest_eigenvalue;
  state.displacement_error = stability.displacement_error;
  state.flags |= flags::touches_nothing | stability.flags;
  result.newton_step.setZero(assembly.state_size());
  return result;
}

/// The largest number of iterations of conjugate gradients; more would cost as much as a
/// factorisation.
constexpr int kMaxGradientSteps = 14;

/// A step of refinement that is shorter than this share of v leaves an error of about its square.
constexpr double kLastRefinement = 1e-4;
constexpr int kMaxRefinements = 4;

/// The allowed relative residual of a Newton step that is computed only for its length.
constexpr double kNewtonStepError = 1e-2;

/// −∂²Π/∂x_i∂q − K_ii v.
Eigen::MatrixXd residual_of(const CondensedSystem& system, const CondensedTangent& tangent,
                            const Eigen::MatrixXd& v) {
  return -tangent.mixed - system.times(tangent, v);
}

/// Computes k from the functional that is stationary in v.
void take_stiffness(const CondensedTangent& tangent, const Eigen::MatrixXd& v,
                    const Eigen::MatrixXd& residual, LinearisedState& state) {
  take_stiffness(tangent.of_coordinates + tangent.mixed.transpose() * v - v.transpose() * residual,
                 state);
}

/// Does a step of refinement of v, with a factor of the tangent.
Eigen::MatrixXd refine_once(CondensedSystem& system, const CondensedTangent& tangent,
                            TangentFactor& factor, Eigen::Ref<Eigen::MatrixXd> v) {
  Eigen::MatrixXd step = residual_of(system, tangent, v);
  system.solve(factor, step);
  v += step;
  return step;
}

/// Refines v, which comes from a rough factor of the tangent.
/// @returns false: the factor is not good enough.
bool refine(CondensedSystem& system, const CondensedTangent& tangent, TangentFactor& factor,
            Eigen::Ref<Eigen::MatrixXd> v) {
  for (int i = 0; i < kMaxRefinements; ++i) {
    const Eigen::MatrixXd step = refine_once(system, tangent, factor, v);
    if ((step.colwise().norm().array() <= kLastRefinement * v.colwise().norm().array()).all()) {
      return true;
    }
  }
  return false;
}

std::optional<Linearisation> linearise_with_factor(CondensedSystem& system,
                                                   const Eigen::VectorXd& t, const NodalVector& x) {
  const auto tangent = system.tangent(t, x);
  TangentFactor* factor = system.factorise(*tangent);
  if (factor == nullptr) return std::nullopt;
  const Eigen::Index coordinates = system.num_coordinates();

  Linearisation result;
  LinearisedState& state = result.state;
  state.t = t;
  const Evaluation at = system.evaluate(t, x);
  state.energy = at.energy;
  state.reaction = system.reaction(at);
  const Eigen::VectorXd r = system.residual(at);
  Eigen::MatrixXd solutions(r.size(), coordinates + 1);
  solutions << tangent->mixed, r;
  solutions = -solutions;
  const Eigen::MatrixXd right_hand_sides = solutions;
  system.solve(*factor, solutions);
  if (factor->is_rough() && !refine(system, *tangent, *factor, solutions.leftCols(coordinates))) {
    factor = system.factorise_accurately(*tangent);
    if (factor == nullptr) return std::nullopt;
    solutions = right_hand_sides;
    system.solve(*factor, solutions);
  }
  if (!solutions.allFinite()) return std::nullopt;
  auto v_i = solutions.leftCols(coordinates);
  result.newton_step = system.as_state(solutions.col(coordinates));
  state.displacement_error = error_of(system, result.newton_step, t);
  if (system.is_linear()) {
    // All displacements are multiples of v, so its error counts.
    const Eigen::MatrixXd error = refine_once(system, *tangent, *factor, v_i);
    state.displacement_error =
        std::max(state.displacement_error, error.rowwise().lpNorm<1>().maxCoeff());
  }
  take_stiffness(tangent->of_coordinates + tangent->mixed.transpose() * v_i, state);
  take_sensitivity(system, v_i, state);
  take_vector(system, x, state);
  take_inertia(system.negative_pivots(*factor), state);
  return result;
}

/// Linearises by iteration; for the arguments see linearise_without_factor().
std::optional<Linearisation> linearise_by_krylov(CondensedSystem& system, const Eigen::VectorXd& t,
                                                 const NodalVector& x, double error,
                                                 InertiaSearch search) {
  const auto tangent = system.tangent(t, x);
  Linearisation result;
  LinearisedState& state = result.state;
  state.t = t;
  const Evaluation at = system.evaluate(t, x);
  state.energy = at.energy;
  state.reaction = system.reaction(at);
  Eigen::MatrixXd v = -tangent->mixed;
  if (system.solve(*tangent, v, error).status != SolveStatus::converged) return std::nullopt;
  const Eigen::VectorXd r = system.residual(at);
  Eigen::MatrixXd step = -r;
  if (system.solve(*tangent, step, kNewtonStepError).status == SolveStatus::not_finite)
    return std::nullopt;
  result.newton_step = system.as_state(step.col(0));
  state.displacement_error = error_of(system, result.newton_step, t);
  Eigen::MatrixXd residual = residual_of(system, *tangent, v);
  if (system.is_linear()) {
    // All displacements are multiples of v, so its error counts.
    Eigen::MatrixXd refinement = residual;
    if (system.solve(*tangent, refinement, error).status != SolveStatus::converged)
      return std::nullopt;
    v += refinement;
    state.displacement_error =
        std::max(state.displacement_error, error * refinement.rowwise().lpNorm<1>().maxCoeff());
    residual = residual_of(system, *tangent, v);
  }
  take_stiffness(*tangent, v, residual, state);
  take_sensitivity(system, v, state);
  take_vector(system, x, state);
  if (search == InertiaSearch::none) {
    state.flags |= flags::inertia_not_computed;
    return result;
  }
  const Inertia inertia = system.find_inertia(*tangent);
  take_inertia(inertia.num_negative, state);
  state.lowest_eigenvalue = inertia.lowest_eigenvalue;
  if (inertia.knowledge == Inertia::Knowledge::unknown) state.flags |= flags::inertia_not_computed;
  return result;
}

/// Linearises with find(is_at_rest). Where the tool touches nothing, the stability of the rest is
/// found once and used for all places of the tool.
template <class Find>
std::optional<Linearisation> linearise_by(const Find& find, CondensedSystem& system,
                                          const Eigen::VectorXd& t, const NodalVector& x) {
  if (!system.feels_nothing(t, x)) return find(false);
  if (!system.rest_stability()) {
    const std::optional<Linearisation> at_rest = find(true);
    if (!at_rest) return std::nullopt;
    const LinearisedState& state = at_rest->state;
    system.set_rest_stability({state.negative_pivots, state.lowest_eigenvalue,
                               state.displacement_error,
                               state.flags & (flags::unstable | flags::inertia_not_computed)});
  }
  return at_rest_alone(system, t, x);
}

}  // namespace

std::optional<Linearisation> linearise(CondensedSystem& system, const Eigen::VectorXd& t,
                                       const NodalVector& x) {
  return linearise_by([&](bool /*is_at_rest*/) { return linearise_with_factor(system, t, x); },
                      system, t, x);
}

LinearisedState superpose(CondensedSystem& system, const LinearisedState& start,
                          const Eigen::VectorXd& t, const NodalVector& x) {
  LinearisedState state;
  state.t = t;
  const Evaluation at = system.evaluate(t, x);
  state.energy = at.energy;
  state.reaction = system.reaction(at);
  state.stiffness = start.stiffness;
  state.v = start.v;
  state.p_v = start.p_v;
  state.displacement_error = start.displacement_error;
  take_vector(system, x, state);
  take_inertia(start.negative_pivots, state);
  state.lowest_eigenvalue = start.lowest_eigenvalue;
  state.flags |= start.flags & flags::inertia_not_computed;
  return state;
}

std::optional<LinearisedState> linearise_by_iteration(
    CondensedSystem& system, const EquilibriumOptions& options, const Correction& correction,
    const LinearisedState& start, const Eigen::VectorXd& t, const NodalVector& x, double error) {
  if (system.is_saddle()) return std::nullopt;
  const NodalVector start_x = system.vector_of(start);
  TangentFactor* factor = correction.factor;
  if (factor == nullptr) factor = system.find_factor(start.t, start_x);
  if (factor == nullptr) factor = system.factorise(start.t, start_x);
  if (factor == nullptr || system.negative_pivots(*factor) > 0) return std::nullopt;
  const auto precondition = [&](Eigen::Ref<Eigen::MatrixXd> columns) {
    correction.quasi_newton->apply(columns, [&](auto each) { system.solve(*factor, each); });
  };
  LinearisedState state;
  state.t = t;
  const auto tangent = system.tangent(t, x);
  const Evaluation at = system.evaluate(t, x);
  state.energy = at.energy;
  state.reaction = system.reaction(at);
  const Eigen::Index coordinates = system.num_coordinates();
  Eigen::MatrixXd v(tangent->mixed.rows(), coordinates);
  for (Eigen::Index c = 0; c < coordinates; ++c) v.col(c) = system.as_unknowns(start.v.col(c));
  Eigen::MatrixXd residual = residual_of(system, *tangent, v);
  const Eigen::VectorXd r = system.residual(at);

  Eigen::MatrixXd z(r.size(), coordinates + 1);
  z << residual, r;
  precondition(z);
  state.displacement_error =
      z.col(coordinates).lpNorm<Eigen::Infinity>() / system.displacement_scale(t);
  if (!(state.displacement_error <= options.displacement_error())) return std::nullopt;
  z.conservativeResize(Eigen::NoChange, coordinates);
  Eigen::MatrixXd p = z;
  Eigen::RowVectorXd rho = residual.cwiseProduct(z).colwise().sum();
  const auto is_done = [&] {
    return (z.colwise().norm().array() <= error * v.colwise().norm().array()).all();
  };
  for (int i = 0; !is_done(); ++i) {
    if (i == kMaxGradientSteps) return std::nullopt;
    const Eigen::MatrixXd q = system.times(*tangent, p);
    const Eigen::RowVectorXd curvature = p.cwiseProduct(q).colwise().sum();
    if (!(curvature.array() > 0).all()) return std::nullopt;
    const Eigen::RowVectorXd alpha = rho.cwiseQuotient(curvature);
    v += p * alpha.asDiagonal();
    residual -= q * alpha.asDiagonal();
    z = residual;
    precondition(z);
    const Eigen::RowVectorXd next_rho = residual.cwiseProduct(z).colwise().sum();
    p = z + p * next_rho.cwiseQuotient(rho).asDiagonal();
    rho = next_rho;
  }
  take_stiffness(*tangent, v, residual, state);
  take_sensitivity(system, v, state);
  take_vector(system, x, state);
  state.negative_pivots = 0;
  state.flags |= flags::inertia_not_computed;
  return state;
}

std::optional<Linearisation> linearise_without_factor(CondensedSystem& system,
                                                      const Eigen::VectorXd& t,
                                                      const NodalVector& x, double error,
                                                      InertiaSearch search) {
  const auto find = [&](bool is_at_rest) {
    return linearise_by_krylov(system, t, x, error,
                               is_at_rest ? InertiaSearch::lowest_eigenvalue : search);
  };
  return linearise_by(find, system, t, x);
}

}  // namespace palpate
