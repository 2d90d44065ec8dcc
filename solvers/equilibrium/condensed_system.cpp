// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/condensed_system.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "assembly/supports.h"
#include "base/error.h"
#include "base/quantity.h"
#include "elements/containment.h"

namespace palpate {
namespace {

/// The displacement scale is at least this share of the mean edge.
constexpr double kLeastDisplacement = 1e-3;
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
                                 int kept_factors, Precision precision,
                                 const std::vector<const EnergyTerm*>& terms)
    : mesh_(scene.body.mesh),
      holding_points_(palpate::holding_points(scene.body)),
      assembly_(scene),
      pattern_(assembly_),
      constraints_(scene.body, assembly_),
      rest_(NodalVector::Zero(assembly_.state_size())),
      kept_factors_(static_cast<std::size_t>(kept_factors)),
      precision_(is_saddle() ? Precision::full : precision) {
  for (const EnergyTerm* term : terms) {
    PairBlocks at_rest;
    term->take_blocks(rest_, at_rest);
    pattern_.add(at_rest.pairs);
    constraints_.set_pattern(pattern());
  }
  if (solver != nullptr) {
    take_solver(std::move(solver));
  }
  measure_stiffness();
  if (spare_solver_ == nullptr) {
    krylov_ = std::make_unique<KrylovTangent>(mesh_, assembly_, pattern(), undeformed_);
  }
}

void CondensedSystem::measure_stiffness() {
  assemble(NodalVector::Zero(assembly_.state_size()), undeformed_);
  constraints_.measure(undeformed_);
  constraints_.constrain(undeformed_);
  const Index num_displacements = pattern().size - assembly_.num_unknown_pressures();
  double sum = 0;
  for (Index c = 0; c < num_displacements; ++c) sum += undeformed_[pattern().column_start[c]];
  mean_diagonal_ = sum / num_displacements;
  inverse_row_norm_ = row_norms(pattern(), undeformed_).cwiseInverse();
}

void CondensedSystem::set_terms(std::vector<const EnergyTerm*> terms) {
  terms_ = std::move(terms);
  places_of_terms_.assign(terms_.size(), {});
  measure_stiffness();
  for (KeptFactor& factor : factors_) factor.state.resize(0);
  drop_rest_factor();
  rest_is_safe_.reset();
  has_tangent_ = false;
  is_settled_ = terms_.empty();
  rest_stability_.reset();
  if (is_settled_) rest_stability_.emplace();
}

void CondensedSystem::set_rest(const NodalVector& state) {
  rest_ = state;
  drop_rest_factor();
  is_settled_ = true;
  if (!terms_.empty()) rest_stability_.reset();
}

std::vector<PairBlocks> CondensedSystem::blocks_of_terms(const NodalVector& state) {
  std::vector<PairBlocks> blocks(terms_.size());
  bool has_grown = false;
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    terms_[i]->take_blocks(state, blocks[i]);
    if (pattern_.has_room_for(blocks[i].pairs)) continue;
    const SymmetricPattern before = pattern();
    pattern_.add(blocks[i].pairs);
    pattern_.add(terms_[i]->pairs_around(state));
    spread_undeformed(before);
    has_grown = true;
  }
  if (has_grown) {
    analyse_anew();
    if (interaction_ != nullptr) place_tool();
  }
  for (std::size_t i = 0; i < terms_.size(); ++i) {
    if (places_of_terms_[i].pairs() != blocks[i].pairs) {
      places_of_terms_[i] = PairPlaces(blocks[i].pairs, assembly_, pattern());
    }
  }
  return blocks;
}

void CondensedSystem::spread_undeformed(const SymmetricPattern& before) {
  std::vector<double> values(pattern().row.size(), 0.0);
  const std::vector<Index> positions = positions_in(pattern(), before);
  for (std::size_t i = 0; i < positions.size(); ++i) values[positions[i]] = undeformed_[i];
  undeformed_ = std::move(values);
}

void CondensedSystem::analyse_anew() {
  places_of_terms_.assign(terms_.size(), {});
  constraints_.set_pattern(pattern());
  ++pattern_age_;
  if (krylov_ == nullptr) {
    std::unique_ptr<LinearSolver> solver =
        spare_solver_ != nullptr ? std::move(spare_solver_) : any_solver().another();
    // Factors that were made before stay those of the tangents at their states.
    factors_.remove_if([](const KeptFactor& factor) { return factor.state.size() == 0; });
    take_solver(std::move(solver));
  }
  has_tangent_ = false;
  if (krylov_ != nullptr) {
    krylov_ = std::make_unique<KrylovTangent>(mesh_, assembly_, pattern(), undeformed_);
  }
}

std::vector<char> CondensedSystem::find_idle_multipliers() const {
  const SymmetricPattern& pattern = pattern_.whole();
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
  std::vector<Index> coordinates(pattern().size, kFree);
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
  is_shared_.reset();
  has_tangent_ = false;
  for (KeptFactor& factor : factors_) factor.state.resize(0);
  make_room_for_tool();
  place_tool();
}

void CondensedSystem::make_room_for_tool() {
  const std::vector<PointPair> couplings = interaction_->couplings();
  if (pattern_.has_room_for(couplings)) return;
  const SymmetricPattern before = pattern();
  pattern_.add(couplings);
  spread_undeformed(before);
  drop_rest_factor();
  analyse_anew();
}

void CondensedSystem::place_tool() {
  const SymmetricPattern& pattern = pattern_.whole();
  std::replace(coordinate_of_unknown_.begin(), coordinate_of_unknown_.end(), kIdle, kFree);
  const std::vector<char> idle = find_idle_multipliers();
  for (Index unknown = 0; unknown < pattern.size; ++unknown) {
    if (idle[unknown] != 0) coordinate_of_unknown_[unknown] = kIdle;
  }
  couplings_.clear();
  held_.clear();
  idle_.clear();
  idle_diagonal_.clear();
  if (krylov_ != nullptr) {
    std::vector<char> held(static_cast<std::size_t>(pattern.size / 3));
    for (std::size_t node = 0; node < held.size(); ++node) {
      held[node] = coordinate_of_unknown_[3 * node] >= 0 ? 1 : 0;
    }
    krylov_->hold(held);
  }
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

double CondensedSystem::longest_step() const {
  double longest = interaction_ == nullptr ? std::numeric_limits<double>::infinity()
                                           : interaction_->longest_step();
  for (const EnergyTerm* term : terms_) longest = std::min(longest, term->longest_step());
  return longest;
}

double CondensedSystem::longest_share(const NodalVector& state, const NodalVector& step) const {
  double longest = 1;
  for (const EnergyTerm* term : terms_) {
    longest = std::min(longest, term->longest_share(state, step));
  }
  return longest;
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
  Eigen::VectorXd r(pattern().size);
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
  Eigen::VectorXd unknowns(pattern().size);
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
  const std::vector<PairBlocks> blocks = blocks_of_terms(state);
  NodalVector force;
  std::vector<double>& of_materials = pattern_.has_grown() ? of_materials_ : values;
  assembly_.tangent(state, force, of_materials);
  (void)add_terms(state, force, &of_materials);
  if (pattern_.has_grown()) pattern_.spread(of_materials_, values);
  for (std::size_t i = 0; i < blocks.size(); ++i) places_of_terms_[i].add(blocks[i].values, values);
}

double CondensedSystem::add_terms(const NodalVector& state, NodalVector& force,
                                  std::vector<double>* values) const {
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
  if (!is_settled_ || state != rest_) return false;
  const bool is_constant = std::all_of(terms_.begin(), terms_.end(), [](const EnergyTerm* term) {
    return term->is_constant_at_rest();
  });
  if (!is_constant) return false;
  if (!has_potential()) return true;
  PotentialHessian hessian;
  hessian.of_coordinates.setZero(num_coordinates(), num_coordinates());
  interaction_->add_hessian(q, state, hessian);
  return hessian.of_points.empty();
}

void CondensedSystem::add_potential(CondensedTangent& tangent) const {
  PotentialHessian hessian;
  hessian.of_coordinates.setZero(num_coordinates(), num_coordinates());
  interaction_->add_hessian(tangent.q, tangent.state, hessian);
  const auto& unknown_of_point = assembly_.unknown_of_point();
  for (const auto& [point_a, point_b, value] : hessian.of_points) {
    const Index a = unknown_of_point[point_a];
    const Index b = unknown_of_point[point_b];
    if (a < 0 || b < 0) continue;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < (a == b ? i + 1 : 3); ++j) {
        const Index position = pattern().find(std::max(a + i, b + j), std::min(a + i, b + j));
        assert(position >= 0 && "the tool couples points that its couplings() do not tell");
        tangent.values[position] += value(i, j);
      }
    }
  }
  for (const auto& [point, coordinate, value] : hessian.mixed) {
    const Index unknown = unknown_of_point[point];
    if (unknown < 0) continue;
    const Index prescribed = coordinate_of_unknown_[unknown];
    if (prescribed < 0) {
      tangent.mixed.block(unknown, coordinate, 3, value.cols()) += value;
    } else {
      tangent.of_coordinates.block(prescribed, coordinate, 3, value.cols()) += value;
      tangent.of_coordinates.block(coordinate, prescribed, value.cols(), 3) += value.transpose();
    }
  }
  tangent.of_coordinates += hessian.of_coordinates;
}

std::shared_ptr<const CondensedTangent> CondensedSystem::tangent(const Eigen::VectorXd& q,
                                                                 const NodalVector& state) {
  if (has_tangent_ && is_linear()) return last_tangent_;
  if (last_tangent_ == nullptr || last_tangent_.use_count() > 1) {
    last_tangent_ = std::make_shared<CondensedTangent>();
  }
  CondensedTangent& tangent = *last_tangent_;
  tangent.q = q;
  tangent.state = state;
  std::vector<double>& values = tangent.values;
  if (terms_.empty() && (assembly_.is_linear() || state.isZero(0))) {
    values = undeformed_;
  } else {
    assemble(state, values);
  }
  has_tangent_ = true;
  tangent.mixed.setZero(pattern().size, num_coordinates());
  tangent.of_coordinates.setZero(num_coordinates(), num_coordinates());
  if (has_potential()) {
    add_potential(tangent);
    constraints_.project(tangent.mixed);
  }
  // Values that were constrained at rest do not change when they are constrained again.
  constraints_.constrain(values);
  for (const Coupling& c : couplings_) {
    tangent.mixed(c.unknown, c.coordinate) += std::exchange(values[c.position], 0.0);
  }
  for (const Held& h : held_) {
    const double value = std::exchange(values[h.position], h.diagonal ? mean_diagonal_ : 0.0);
    tangent.of_coordinates(h.coordinate_a, h.coordinate_b) += value;
    if (!h.diagonal) tangent.of_coordinates(h.coordinate_b, h.coordinate_a) += value;
  }
  for (Index position : idle_) values[position] = 0;
  // The diagonal is negative as that of every pressure, so that the count of negative pivots stays
  // right.
  for (Index position : idle_diagonal_) values[position] = -mean_diagonal_;
  if (krylov_ != nullptr) krylov_->take(values);
  return last_tangent_;
}

Eigen::MatrixXd CondensedSystem::times(const CondensedTangent& tangent,
                                       const Eigen::MatrixXd& columns) const {
  // Three columns share each pass over the values.
  constexpr int kTogether = 3;
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, kTogether, Eigen::RowMajor>;
  const SymmetricPattern& pattern = pattern_.whole();
  const std::vector<double>& values = tangent.values;
  Eigen::MatrixXd product(columns.rows(), columns.cols());
  for (Eigen::Index first = 0; first < columns.cols(); first += kTogether) {
    const Eigen::Index together = std::min<Eigen::Index>(kTogether, columns.cols() - first);
    Rows x = Rows::Zero(columns.rows(), kTogether);
    x.leftCols(together) = columns.middleCols(first, together);
    Rows y = Rows::Zero(x.rows(), kTogether);
    for (Index c = 0; c < pattern.size; ++c) {
      const Eigen::RowVector3d x_c = x.row(c);
      Eigen::RowVector3d y_c = Eigen::RowVector3d::Zero();
      Index i = pattern.column_start[c];
      y_c += values[i] * x_c;  // the diagonal is the first of its column
      for (++i; i < pattern.column_start[c + 1]; ++i) {
        y.row(pattern.row[i]) += values[i] * x_c;
        y_c += values[i] * x.row(pattern.row[i]);
      }
      y.row(c) += y_c;
    }
    product.middleCols(first, together) = y.leftCols(together);
  }
  return product;
}

}  // namespace palpate
