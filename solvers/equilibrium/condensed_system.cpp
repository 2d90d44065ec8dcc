// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/condensed_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "assembly/supports.h"
#include "base/error.h"
#include "base/quantity.h"
#include "elements/containment.h"
#include "linear/condition.h"
#include "linear/product.h"

namespace palpate {
namespace {

/// The displacement scale is at least this share of the mean edge.
constexpr double kLeastDisplacement = 1e-3;
/// Entries of coordinate_of_unknown_ that are no coordinates.
constexpr Index kFree = -1;
constexpr Index kIdle = -2;
/// The factor at rest serves a tool only if its solutions have a relative error below this, which
/// one step of refinement removes.
constexpr double kRefinable = 1e-8;
/// A body that keeps fewer factors than this does not share the factor at rest: it would have none
/// left for a state of a solve.
constexpr std::size_t kLeastFactorsToShare = 3;

Eigen::VectorXd row_norms(const SymmetricPattern& pattern, const std::vector<double>& values) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(pattern.size);
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      squares[c] += values[i] * values[i];
      if (pattern.row[i] != c) squares[pattern.row[i]] += values[i] * values[i];
    }
  }
  return squares.cwiseSqrt();
}

}  // namespace

CondensedSystem::CondensedSystem(const Scene& scene, std::unique_ptr<LinearSolver> solver,
                                 int kept_factors, Precision precision)
    : mesh_(scene.mesh),
      fixed_(scene.fixed),
      holding_points_(palpate::holding_points(scene)),
      assembly_(scene),
      constraints_(scene, assembly_),
      rest_(NodalVector::Zero(assembly_.state_size())),
      kept_factors_(static_cast<std::size_t>(kept_factors)),
      precision_(is_saddle() ? Precision::full : precision) {
  if (solver != nullptr) {
    take_solver(std::move(solver));
  }
  measure_rest();
  if (spare_solver_ == nullptr) {
    krylov_ = std::make_unique<KrylovTangent>(mesh_, assembly_, rest_values_);
  }
}

void CondensedSystem::measure_rest() {
  const SymmetricPattern& pattern = assembly_.pattern();
  assemble(NodalVector::Zero(assembly_.state_size()), rest_values_);
  constraints_.measure(rest_values_);
  constraints_.constrain(rest_values_);
  const Index num_displacements = pattern.size - assembly_.num_unknown_pressures();
  double sum = 0;
  for (Index c = 0; c < num_displacements; ++c) sum += rest_values_[pattern.column_start[c]];
  mean_diagonal_ = sum / num_displacements;
  inverse_row_norm_ = row_norms(pattern, rest_values_).cwiseInverse();
}

void CondensedSystem::set_terms(std::vector<const EnergyTerm*> terms) {
  terms_ = std::move(terms);
  measure_rest();
  for (KeptFactor& factor : factors_) factor.state.resize(0);
  rest_is_safe_.reset();
  has_tangent_ = false;
}

void CondensedSystem::take_solver(std::unique_ptr<LinearSolver> solver) {
  const SymmetricPattern& pattern = assembly_.pattern();
  if (!assembly_.multipliers().empty() && !assembly_.has_stabilised_pressures() &&
      !solver->pivots()) {
    throw InputError(std::string("The linear solver ") + solver->name() +
                     " cannot solve for an incompressible law, whose tangent is indefinite. Use "
                     "MUMPS, or a law with a bulk modulus.");
  }
  {
    const Timer timer(work_.analysis_seconds);
    ++work_.analyses;
    solver->analyse(pattern);
  }
  if (assembly_.is_linear() || kept_factors_ >= kLeastFactorsToShare) {
    most_shared_ = RestFactor::most_held(*solver, pattern.size);
  }
  spare_solver_ = std::move(solver);
  factors_.reserve(kept_factors_);  // so that pointers to them stay valid
}

std::vector<char> CondensedSystem::find_idle_multipliers() const {
  const SymmetricPattern& pattern = assembly_.pattern();
  std::vector<char> idle(pattern.size, 0);
  for (Index unknown : assembly_.multipliers()) idle[unknown] = 1;
  for (Index c = 0; c < pattern.size - assembly_.num_unknown_pressures(); ++c) {
    if (coordinate_of_unknown_[c] != kFree) continue;
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      idle[pattern.row[i]] = 0;
    }
  }
  // If a free unknown is coupled with some stabilised pressures, the other ones follow from these.
  const auto& multipliers = assembly_.multipliers();
  const bool some_felt = std::any_of(multipliers.begin(), multipliers.end(),
                                     [&](Index unknown) { return idle[unknown] == 0; });
  if (assembly_.has_stabilised_pressures() && some_felt) idle.assign(pattern.size, 0);
  return idle;
}

void CondensedSystem::set_interaction(const Interaction& interaction) {
  const auto& unknown_of_point = assembly_.unknown_of_point();
  const SymmetricPattern& pattern = assembly_.pattern();
  std::vector<Index> coordinates(pattern.size, kFree);
  std::vector<PrescribedPoint> prescribed = interaction.prescribed_points();
  for (const auto& [point, coordinate] : prescribed) {
    if (point < 0 || point >= assembly_.num_points()) {
      throw InputError("Active node " + std::to_string(point) + " does not exist: the body has " +
                       std::to_string(assembly_.num_points()) + " points, counted from 0.");
    }
    const Index unknown = unknown_of_point[point];
    if (unknown < 0) {
      throw InputError("Active node " + std::to_string(point) + " at " +
                       quantity(mesh_.points[point], "m") +
                       " is fixed or belongs to no cell, so it cannot be moved. Choose another.");
    }
    if (constraints_.holds(point)) {
      throw InputError("Active node " + std::to_string(point) + " at " +
                       quantity(mesh_.points[point], "m") +
                       " is held along a direction (HeldDirection), so a tool that is bonded to it "
                       "cannot move it. Choose another, or a smaller TipRadius.");
    }
    if (coordinates[unknown] >= 0) {
      throw InputError("Active node " + std::to_string(point) + " is named twice.");
    }
    for (int c = 0; c < 3; ++c) coordinates[unknown + c] = coordinate + c;
  }
  interaction_ = interaction.clone();
  prescribed_points_ = std::move(prescribed);
  coordinate_of_unknown_ = std::move(coordinates);
  const std::vector<char> idle = find_idle_multipliers();
  for (Index unknown = 0; unknown < pattern.size; ++unknown) {
    if (idle[unknown] != 0) coordinate_of_unknown_[unknown] = kIdle;
  }
  couplings_.clear();
  held_.clear();
  idle_.clear();
  idle_diagonal_.clear();
  for (KeptFactor& factor : factors_) factor.state.resize(0);
  if (krylov_ != nullptr) {
    std::vector<char> held(static_cast<std::size_t>(pattern.size / 3));
    for (std::size_t node = 0; node < held.size(); ++node) {
      held[node] = coordinate_of_unknown_[3 * node] >= 0 ? 1 : 0;
    }
    krylov_->hold(held);
  }
  is_shared_.reset();
  has_tangent_ = false;
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      const Index row = pattern.row[i];
      const Index of_row = coordinate_of_unknown_[row];
      const Index of_column = coordinate_of_unknown_[c];
      if (of_row == kIdle || of_column == kIdle) {
        (row == c ? idle_diagonal_ : idle_).push_back(i);
      } else if (of_row >= 0 && of_column >= 0) {
        held_.push_back({i, of_row, of_column, row == c});
      } else if (of_row >= 0) {
        couplings_.push_back({i, c, of_row});
      } else if (of_column >= 0) {
        couplings_.push_back({i, row, of_column});
      }
    }
  }
}

double CondensedSystem::displacement_scale(const Eigen::VectorXd& q) const {
  return std::max(interaction_->displacement_scale(q), kLeastDisplacement * assembly_.mean_edge());
}

double CondensedSystem::norm(const Eigen::VectorXd& r) const {
  return r.cwiseProduct(inverse_row_norm_).lpNorm<Eigen::Infinity>();
}

double CondensedSystem::euclidean_norm(const Eigen::VectorXd& r) const {
  return r.cwiseProduct(inverse_row_norm_).norm();
}

Evaluation CondensedSystem::evaluate(const Eigen::VectorXd& q, const NodalVector& state) {
  const Timer timer(work_.residual_seconds);
  ++work_.residuals;
  Evaluation at;
  at.of_coordinates.setZero(num_coordinates());
  at.energy = assembly_.residual(state, at.force).energy;
  at.energy += add_terms(state, at.force, nullptr);
  if (has_potential()) {
    at.energy += interaction_->potential(q, state, at.force, at.of_coordinates);
  }
  return at;
}

Eigen::VectorXd CondensedSystem::residual(const Evaluation& at) const {
  const auto& state_of_unknown = assembly_.state_of_unknown();
  Eigen::VectorXd r(assembly_.pattern().size);
  for (Index i = 0; i < r.size(); ++i) {
    r[i] = coordinate_of_unknown_[i] >= 0 ? 0 : at.force[state_of_unknown[i]];
  }
  constraints_.project(r);
  return r;
}

Eigen::VectorXd CondensedSystem::reaction(const Evaluation& at) const {
  Eigen::VectorXd h = at.of_coordinates;
  for (const auto& [point, coordinate] : prescribed_points_) {
    h.segment<3>(coordinate) += at.force.segment<3>(3 * Eigen::Index{point});
  }
  return h;
}

void CondensedSystem::prescribe(const Eigen::VectorXd& q, NodalVector& state) const {
  for (const auto& [point, coordinate] : prescribed_points_) {
    const Eigen::Index place = 3 * Eigen::Index{point};
    state.segment<3>(place) = rest_.segment<3>(place) + q.segment<3>(coordinate);
  }
}

void CondensedSystem::prescribe_change(const Eigen::VectorXd& of_q, NodalVector& of_state) const {
  for (const auto& [point, coordinate] : prescribed_points_) {
    of_state.segment<3>(3 * Eigen::Index{point}) = of_q.segment<3>(coordinate);
  }
}

Eigen::Map<const Eigen::VectorXd> CondensedSystem::pressure_scale() const {
  const auto& scale = assembly_.pressure_scale();
  return {scale.data(), static_cast<Eigen::Index>(scale.size())};
}

NodalVector CondensedSystem::vector_of(const LinearisedState& state) const {
  if (!is_saddle()) return state.u;
  NodalVector x(assembly_.state_size());
  x << state.u, state.p.cwiseQuotient(pressure_scale());
  return x;
}

Eigen::MatrixXd CondensedSystem::sensitivity_of(const LinearisedState& state) const {
  if (!is_saddle()) return state.v;
  Eigen::MatrixXd sensitivity(assembly_.state_size(), state.v.cols());
  sensitivity << state.v, pressure_scale().cwiseInverse().asDiagonal() * state.p_v;
  return sensitivity;
}

Eigen::VectorXd CondensedSystem::as_unknowns(const NodalVector& state) const {
  const auto& state_of_unknown = assembly_.state_of_unknown();
  Eigen::VectorXd unknowns(assembly_.pattern().size);
  for (Index i = 0; i < unknowns.size(); ++i) {
    unknowns[i] = coordinate_of_unknown_[i] >= 0 ? 0 : state[state_of_unknown[i]];
  }
  return unknowns;
}

NodalVector CondensedSystem::as_state(const Eigen::VectorXd& unknowns) const {
  const auto& state_of_unknown = assembly_.state_of_unknown();
  NodalVector state = NodalVector::Zero(assembly_.state_size());
  for (Index i = 0; i < unknowns.size(); ++i) state[state_of_unknown[i]] = unknowns[i];
  return state;
}

void CondensedSystem::assemble(const NodalVector& state, std::vector<double>& values) {
  const Timer timer(work_.assembly_seconds);
  ++work_.assemblies;
  NodalVector force;
  assembly_.tangent(state, force, values);
  (void)add_terms(state, force, &values);
}

double CondensedSystem::add_terms(const NodalVector& state, NodalVector& force,
                                  std::vector<double>* values) {
  double energy = 0;
  for (const EnergyTerm* term : terms_) energy += term->add(state, force, values);
  return energy;
}

bool CondensedSystem::tool_is_inside(const Eigen::VectorXd& q, const NodalVector& state) const {
  if (!has_potential()) return false;
  const std::vector<Vec3> places = interaction_->inner_places(q);
  return !places.empty() && body_contains_any(mesh_, state, places);
}

bool CondensedSystem::feels_nothing(const Eigen::VectorXd& q, const NodalVector& state) const {
  return prescribed_points_.empty() && !is_linear() && is_as_at_rest(q, state);
}

bool CondensedSystem::is_as_at_rest(const Eigen::VectorXd& q, const NodalVector& state) const {
  if (is_linear()) return true;
  if (!terms_.empty() || !state.isZero(0)) return false;
  if (!has_potential()) return true;
  PotentialHessian hessian;
  hessian.of_coordinates.setZero(num_coordinates(), num_coordinates());
  interaction_->add_hessian(q, state, hessian);
  return hessian.of_points.empty();
}

TangentFactor* CondensedSystem::find_factor(const Eigen::VectorXd& q, const NodalVector& state) {
  if (is_shared_ == true && is_as_at_rest(q, state)) return rest_factor_.get();
  return find_kept_factor(q, state);
}

CondensedSystem::KeptFactor* CondensedSystem::find_kept_factor(const Eigen::VectorXd& q,
                                                               const NodalVector& state) {
  const auto found = std::find_if(factors_.begin(), factors_.end(), [&](const KeptFactor& f) {
    if (f.state.size() == 0) return false;
    return is_linear() || (f.state == state && (!has_potential() || f.q == q));
  });
  if (found == factors_.end()) return nullptr;
  found->last_use = ++uses_;
  return &*found;
}

void CondensedSystem::forget(const Eigen::VectorXd& q, const NodalVector& state) {
  if (is_linear()) return;  // its factor is that of all states
  if (KeptFactor* factor = find_kept_factor(q, state)) factor->state.resize(0);
}

LinearSolver& CondensedSystem::spare_solver() {
  if (spare_solver_ == nullptr) {
    const Timer timer(work_.analysis_seconds);
    LinearSolver& other =
        rest_factor_ != nullptr ? rest_factor_->solver() : *factors_.front().solver;
    spare_solver_ = other.another();
  }
  return *spare_solver_;
}

CondensedSystem::KeptFactor& CondensedSystem::factor_to_replace() {
  const auto empty = std::find_if(factors_.begin(), factors_.end(),
                                  [](const KeptFactor& f) { return f.state.size() == 0; });
  if (empty != factors_.end()) return *empty;
  const std::size_t others = is_shared_ == true ? 1 : 0;
  if (factors_.size() + others < kept_factors_) {
    (void)spare_solver();
    return factors_.emplace_back(std::move(spare_solver_));
  }
  return *std::min_element(
      factors_.begin(), factors_.end(),
      [](const KeptFactor& a, const KeptFactor& b) { return a.last_use < b.last_use; });
}

Index CondensedSystem::position(Index row, Index column) const {
  const SymmetricPattern& pattern = assembly_.pattern();
  const auto first = pattern.row.begin() + pattern.column_start[column];
  const auto last = pattern.row.begin() + pattern.column_start[column + 1];
  return static_cast<Index>(std::lower_bound(first, last, row) - pattern.row.begin());
}

void CondensedSystem::add_potential(const Eigen::VectorXd& q, const NodalVector& state) {
  PotentialHessian hessian;
  hessian.of_coordinates.setZero(num_coordinates(), num_coordinates());
  interaction_->add_hessian(q, state, hessian);
  const auto& unknown_of_point = assembly_.unknown_of_point();
  for (const auto& [point_a, point_b, value] : hessian.of_points) {
    const Index a = unknown_of_point[point_a];
    const Index b = unknown_of_point[point_b];
    if (a < 0 || b < 0) continue;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < (a == b ? i + 1 : 3); ++j) {
        values_[position(std::max(a + i, b + j), std::min(a + i, b + j))] += value(i, j);
      }
    }
  }
  for (const auto& [point, coordinate, value] : hessian.mixed) {
    const Index unknown = unknown_of_point[point];
    if (unknown < 0) continue;
    const Index prescribed = coordinate_of_unknown_[unknown];
    if (prescribed < 0) {
      mixed_.block(unknown, coordinate, 3, value.cols()) += value;
    } else {
      of_coordinates_.block(prescribed, coordinate, 3, value.cols()) += value;
      of_coordinates_.block(coordinate, prescribed, value.cols(), 3) += value.transpose();
    }
  }
  of_coordinates_ += hessian.of_coordinates;
}

void CondensedSystem::assemble_tangent(const Eigen::VectorXd& q, const NodalVector& state) {
  if (has_tangent_ && is_linear()) return;
  if (terms_.empty() && (assembly_.is_linear() || state.isZero(0))) {
    values_ = rest_values_;
  } else {
    assemble(state, values_);
  }
  has_tangent_ = true;
  mixed_.setZero(assembly_.pattern().size, num_coordinates());
  of_coordinates_.setZero(num_coordinates(), num_coordinates());
  if (has_potential()) {
    add_potential(q, state);
    constraints_.project(mixed_);
  }
  // Values that were constrained at rest do not change when they are constrained again.
  constraints_.constrain(values_);
  for (const Coupling& c : couplings_) {
    mixed_(c.unknown, c.coordinate) += std::exchange(values_[c.position], 0.0);
  }
  for (const Held& h : held_) {
    const double value = std::exchange(values_[h.position], h.diagonal ? mean_diagonal_ : 0.0);
    of_coordinates_(h.coordinate_a, h.coordinate_b) += value;
    if (!h.diagonal) of_coordinates_(h.coordinate_b, h.coordinate_a) += value;
  }
  for (Index position : idle_) values_[position] = 0;
  // The diagonal is negative as that of every pressure, so that the count of negative pivots stays
  // right.
  for (Index position : idle_diagonal_) values_[position] = -mean_diagonal_;
  if (krylov_ != nullptr) krylov_->take(values_);
}

Eigen::MatrixXd CondensedSystem::times_tangent(const Eigen::MatrixXd& columns) const {
  // Three columns share each pass over the values.
  constexpr int kTogether = 3;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, kTogether, Eigen::RowMajor>;
  Eigen::MatrixXd product(columns.rows(), columns.cols());
  for (Eigen::Index first = 0; first < columns.cols(); first += kTogether) {
    const Rows x = columns.middleCols<kTogether>(first);
    Rows y = Rows::Zero(x.rows(), kTogether);
    const SymmetricPattern& pattern = assembly_.pattern();
    for (Index c = 0; c < pattern.size; ++c) {
      const Eigen::RowVector3d x_c = x.row(c);
      Eigen::RowVector3d y_c = Eigen::RowVector3d::Zero();
      Index i = pattern.column_start[c];
      y_c += values_[i] * x_c;  // the diagonal is the first of its column
      for (++i; i < pattern.column_start[c + 1]; ++i) {
        y.row(pattern.row[i]) += values_[i] * x_c;
        y_c += values_[i] * x.row(pattern.row[i]);
      }
      y.row(c) += y_c;
    }
    product.middleCols<kTogether>(first) = y;
  }
  return product;
}

bool CondensedSystem::shares_rest_factor() {
  if (is_shared_) return *is_shared_;
  is_shared_ = false;
  std::vector<Index> held;
  for (Index i = 0; i < assembly_.pattern().size; ++i) {
    if (coordinate_of_unknown_[i] != kFree) held.push_back(i);
  }
  const auto num_held = static_cast<Index>(held.size());
  if (num_held > most_shared_ || !idle_diagonal_.empty()) return false;
  if (rest_factor_ == nullptr) {
    LinearSolver& solver = spare_solver();
    const Timer timer(work_.factorisation_seconds);
    ++work_.factorisations;
    if (solver.factorise(rest_values_) != FactorStatus::ok) {
      most_shared_ = 0;  // the body floats if nothing is held
      return false;
    }
    rest_factor_ = std::make_unique<RestFactor>(std::move(spare_solver_), assembly_.pattern().size);
  }
  {
    const Timer timer(work_.solve_seconds);
    work_.right_hand_sides += num_held;
    rest_factor_->hold(std::move(held));
  }
  is_shared_ = error_of_rest_factor() <= kRefinable;
  return *is_shared_;
}

double CondensedSystem::error_of_rest_factor() {
  Eigen::VectorXd x(assembly_.pattern().size);
  for (Index i = 0; i < x.size(); ++i) {
    x[i] = coordinate_of_unknown_[i] != kFree ? 0 : (i % 2 == 0 ? 1 : -1);
  }
  constraints_.project(x);
  Eigen::VectorXd found = product(assembly_.pattern(), values_, x);
  solve(*rest_factor_, found);
  const double error = (found - x).norm() / x.norm();
  return std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
}

TangentFactor* CondensedSystem::factorise(const Eigen::VectorXd& q, const NodalVector& state) {
  if (is_as_at_rest(q, state)) {
    assemble_tangent(q, state);
    if (shares_rest_factor()) return rest_factor_.get();
  }
  const Precision usual = usual_precision();
  KeptFactor* factor = factorise_alone(q, state, single_fails_ ? Precision::full : usual);
  if (usual == Precision::full) return factor;
  if (factor != nullptr) factor->is_provisional = single_fails_;
  single_fails_ = factor == nullptr || !factor->solver->is_single();
  return factor;
}

void CondensedSystem::begin_solve() {
  if (krylov_ != nullptr) krylov_->begin_solve();
  single_fails_ = false;
  for (KeptFactor& factor : factors_) {
    if (factor.is_provisional) factor.state.resize(0);
  }
}

TangentFactor* CondensedSystem::factorise_accurately(const Eigen::VectorXd& q,
                                                     const NodalVector& state) {
  KeptFactor* factor = factorise_alone(q, state, Precision::full);
  // A kept factor must be the usual one of its state, whatever was asked for.
  const bool is_usual = is_linear() || usual_precision() == Precision::full;
  if (factor != nullptr && !is_usual) factor->state.resize(0);
  return factor;
}

/// If the tangent at rest is not safe in single precision, as with parts of very different
/// stiffness, later tangents are not either.
Precision CondensedSystem::usual_precision() {
  if (precision_ == Precision::full) return precision_;
  if (!rest_is_safe_) {
    LinearSolver& solver = spare_solver();
    const Timer timer(work_.factorisation_seconds);
    ++work_.factorisations;
    rest_is_safe_ =
        solver.factorise(rest_values_, precision_) == FactorStatus::ok && solver.is_single();
  }
  return *rest_is_safe_ ? precision_ : Precision::full;
}

CondensedSystem::KeptFactor* CondensedSystem::factorise_alone(const Eigen::VectorXd& q,
                                                              const NodalVector& state,
                                                              Precision precision) {
  if (is_linear()) {
    KeptFactor* factor = find_kept_factor(q, state);
    if (factor != nullptr && (precision != Precision::full || !factor->is_rough())) return factor;
  }
  KeptFactor& factor = factor_to_replace();
  factor.state.resize(0);
  factor.is_provisional = false;
  assemble_tangent(q, state);
  const Timer timer(work_.factorisation_seconds);
  ++work_.factorisations;
  if (factor.solver->factorise(values_, precision) != FactorStatus::ok) return nullptr;
  factor.q = q;
  factor.state = state;
  factor.last_use = ++uses_;
  return &factor;
}

void CondensedSystem::solve(TangentFactor& factor, Eigen::Ref<Eigen::MatrixXd> columns) {
  const Timer timer(work_.solve_seconds);
  work_.right_hand_sides += columns.cols();
  factor.solve(columns);
  constraints_.project(columns);
}

SolveSummary CondensedSystem::solve(Eigen::Ref<Eigen::MatrixXd> columns, double tolerance) {
  const Timer timer(work_.solve_seconds);
  work_.right_hand_sides += columns.cols();
  SolveSummary summary = krylov_->solve(columns, tolerance);
  work_.krylov_iterations += summary.iterations;
  constraints_.project(columns);
  return summary;
}

Inertia CondensedSystem::find_inertia() {
  const Timer timer(work_.solve_seconds);
  return krylov_->inertia();
}

int CondensedSystem::negative_pivots(const TangentFactor& factor) const {
  return factor.negative_pivots() - assembly_.num_unknown_pressures();
}

double CondensedSystem::condition(TangentFactor& factor) const {
  return condition_estimate(assembly_.pattern(), values_,
                            [&](auto columns) { factor.solve(columns); });
}

}  // namespace palpate
