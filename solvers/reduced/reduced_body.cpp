// SPDX-License-Identifier: BSD-3-Clause
#include "reduced/reduced_body.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// Above this ratio of two residuals, the tangent is computed anew.
constexpr double kSlowContraction = 0.3;
/// Sufficient decrease, as a share of what the slope promises.
constexpr double kDecrease = 1e-4;
constexpr int kMaxBacktracks = 8;
/// The smallest factor by which one backtrack shortens a Newton step.
constexpr double kLeastBacktrack = 0.1;
/// The rounding of a potential, as a share of it.
constexpr double kRounding = 1e-13;
/// The least displacement in the norm of the residual, as a share of the largest in training.
constexpr double kLeastScale = 1e-3;

void require(bool good, const char* name, double value, const char* what) {
  if (good) return;
  throw InputError(std::string("The option ") + name + " of a reduced body is " + quantity(value) +
                   "; " + what);
}

}  // namespace

void validate(const ReducedBodyOptions& options) {
  require(options.time_step > 0 && std::isfinite(options.time_step), "time_step", options.time_step,
          "it must be a number of seconds above 0.");
  require(options.tolerance > 0 && options.tolerance < 1, "tolerance", options.tolerance,
          "it must be between 0 and 1.");
  require(options.max_iterations >= 1, "max_iterations", options.max_iterations,
          "it must be at least 1.");
  require(options.max_evaluations >= 1, "max_evaluations", options.max_evaluations,
          "it must be at least 1.");
  require(options.max_tangents >= 1, "max_tangents", options.max_tangents,
          "it must be at least 1.");
  require(options.max_halvings >= 0 && options.max_halvings <= 30, "max_halvings",
          options.max_halvings, "it must be from 0 to 30.");
  require(options.largest_trust > 0, "largest_trust", options.largest_trust, "it must be above 0.");
  require(options.largest_speed > 0, "largest_speed", options.largest_speed,
          "it must be a number of m/s above 0.");
}

std::string to_string(ReducedOutcome outcome) {
  switch (outcome) {
    case ReducedOutcome::converged: return "converged";
    case ReducedOutcome::not_converged: return "not converged";
    case ReducedOutcome::beyond_training: return "beyond training";
    case ReducedOutcome::invalid_input: return "invalid input";
    case ReducedOutcome::tools_ahead: return "tools ahead";
  }
  return "unknown";
}

ReducedBody::ReducedBody(const ReducedModel& model, const ReducedBodyOptions& options)
    : model_((validate(model), model)),
      options_((validate(options), options)),
      has_inertia_(model.has_inertia()),
      energy_(model),
      memory_(model) {
  const Eigen::Index n = model.num_coordinates();
  for (Past* past : {&now_, &before_}) {
    past->y.setZero(n);
    past->velocity.setZero(n);
  }
  for (Eigen::VectorXd* of : {&y_before_that_, &centre_, &y_, &trial_from_, &way_, &of_mass_,
                              &whole_force_, &residual_, &direction_}) {
    of->setZero(n);
  }
  for (Eigen::VectorXd* of : {&tools_from_, &tools_change_, &place_, &force_, &body_force_}) {
    of->setZero(model.num_tool_coordinates);
  }
  holding_.setConstant(model.num_tool_coordinates / 3, std::numeric_limits<double>::infinity());
  residual_weight_.setZero(n);
  residual_weight_.head(model.num_modes).setOnes();
  num_unknowns_ = model.num_modes;
  factor_.setZero(n, n);
  if (model.points.rest_gradients.size() > 0) {
    rest_det_f_ = energy_.evaluate(y_.data()).minimum_det_f;
    memory_.set_rest(energy_.law_stress(), energy_.strain());
  }
  if (memory_.is_viscous()) {
    energy_.set_memory(
        {memory_.factors().data(), memory_.stress().data(), memory_.moduli().data()});
  }
  rest();
}

void ReducedBody::rest() noexcept {
  for (Past* past : {&now_, &before_}) {
    past->y.setZero();
    past->velocity.setZero();
    past->step = 0;
  }
  y_before_that_.setZero();
  memory_.forget();
  tools_from_.setZero();
  force_.setZero();
  body_force_.setZero();
  state_ = {};
  state_.minimum_det_f = rest_det_f_;
}

bool ReducedBody::is_prescribed(Eigen::Index tool) const noexcept {
  return std::isinf(holding_[tool]);
}

void ReducedBody::hold(Index tool, double stiffness) noexcept {
  assert(tool >= 0 && tool < holding_.size() && stiffness >= 0);
  if (holding_[tool] == stiffness) return;
  holding_[tool] = stiffness;
  const Eigen::Index n = model_.num_modes;
  const Eigen::Index first = 3 * static_cast<Eigen::Index>(tool);
  // The tool is led on from its present place, and its former holding has no more effect.
  tools_from_.segment<3>(first) = now_.y.segment<3>(n + first);
  body_force_.segment<3>(first).setZero();
  for (Eigen::Index i = first; i < first + 3; ++i) {
    residual_weight_[n + i] = is_prescribed(tool) ? 0 : 1 / std::sqrt(model_.tool_stiffness(i, i));
  }
  const bool all_prescribed = (residual_weight_.tail(3 * holding_.size()).array() == 0).all();
  num_unknowns_ = all_prescribed ? n : n + 3 * holding_.size();
}

const ReducedState& ReducedBody::step(const double* d) noexcept {
  return step(d, options_.time_step);
}

const ReducedState& ReducedBody::step(const double* d, double length) noexcept {
  const Eigen::Index n = model_.num_modes;
  state_.iterations = state_.evaluations = state_.tangents = state_.halvings = 0;
  for (Eigen::Index tool = 0; tool < holding_.size(); ++tool) {
    const Eigen::Index first = 3 * tool;
    const Eigen::Map<const Vec3> told(d + first);
    if (holding_[tool] == 0) {
      tools_change_.segment<3>(first).setZero();
      continue;
    }
    if (!told.allFinite()) {
      state_.outcome = ReducedOutcome::invalid_input;
      return state_;
    }
    if (is_prescribed(tool)) tools_from_.segment<3>(first) = now_.y.segment<3>(n + first);
    tools_change_.segment<3>(first) = told - tools_from_.segment<3>(first);
  }
  const bool are_ahead = limit_speed(length);
  double done = 0;
  double share = 1;
  for (;;) {
    const double next = std::min(1.0, done + share);
    place_ = tools_from_ + next * tools_change_;
    state_.outcome = attempt((next - done) * length);
    if (state_.outcome == ReducedOutcome::converged) {
      take_step((next - done) * length);
      done = next;
      if (done == 1) break;
      continue;
    }
    // Shorter steps towards such a place are not tried.
    if (state_.outcome == ReducedOutcome::beyond_training) break;
    if (state_.halvings == options_.max_halvings || !may_linearise()) break;
    ++state_.halvings;
    share /= 2;
  }
  tools_from_ += done * tools_change_;
  if (done < 1) {
    // The body stands still.
    now_.velocity.setZero();
    now_.step = 0;
    state_.kinetic = 0;
  } else if (are_ahead) {
    state_.outcome = ReducedOutcome::tools_ahead;
  }
  tell_force(d);
  return state_;
}

void ReducedBody::tell_force(const double* d) noexcept {
  // The distances by which prescribed tools have gone on without the body.
  auto way = way_.tail(3 * holding_.size());
  way.setZero();
  force_ = body_force_;
  for (Eigen::Index tool = 0; tool < holding_.size(); ++tool) {
    if (holding_[tool] == 0) continue;
    const Eigen::Index first = 3 * tool;
    const Vec3 ahead =
        Eigen::Map<const Vec3>(d + first) - now_.y.segment<3>(model_.num_modes + first);
    if (is_prescribed(tool)) {
      way.segment<3>(first) = ahead;
    } else {
      force_.segment<3>(first) = holding_[tool] * ahead;
    }
  }
  for (Eigen::Index tool = 0; tool < holding_.size(); ++tool) {
    if (!is_prescribed(tool)) continue;
    force_.segment<3>(3 * tool).noalias() += model_.tool_stiffness.middleRows<3>(3 * tool) * way;
  }
}

bool ReducedBody::limit_speed(double length) noexcept {
  if (!has_inertia_) return false;
  bool is_short = false;
  for (Eigen::Index tool = 0; tool < tools_change_.size(); tool += 3) {
    auto change = tools_change_.segment<3>(tool);
    const double distance = change.norm();
    const double longest = options_.largest_speed * length;
    if (!(distance > longest)) continue;
    change *= longest / distance;
    is_short = true;
  }
  return is_short;
}

double ReducedBody::trust_of_places() const noexcept {
  double largest = 0;
  for (Eigen::Index i = 0; i < place_.size(); ++i) {
    if (holding_[i / 3] == 0) continue;
    largest = std::max(largest, std::abs(place_[i]) / model_.trained_tools[i]);
  }
  return largest;
}

double ReducedBody::trust_of_tools() const noexcept {
  return (y_.tail(model_.num_tool_coordinates).array().abs() / model_.trained_tools.array())
      .maxCoeff();
}

double ReducedBody::trust() const noexcept {
  if (model_.num_modes == 0) return trust_of_tools();
  const double of_modes =
      (y_.head(model_.num_modes).array().abs() / model_.trained_modes.array()).maxCoeff();
  return std::max(of_modes, trust_of_tools());
}

void ReducedBody::set_step(double length) noexcept {
  const double last = now_.step;
  if (last == 0) {
    rate_ = Vec3(1, -1, 0) / length;
  } else {
    const double w = length / last;
    rate_ = Vec3((1 + 2 * w) / (1 + w), -(1 + w), w * w / (1 + w)) / length;
  }
  inertia_ = has_inertia_ ? rate_[0] * rate_[0] : 0;
  if (has_inertia_) {
    centre_ = -(rate_[1] / rate_[0]) * now_.y - (rate_[1] / inertia_) * now_.velocity -
              (rate_[2] / rate_[0]) * before_.y - (rate_[2] / inertia_) * before_.velocity;
  }
  if (memory_.is_viscous()) memory_.begin_step(length, rate_);
}

void ReducedBody::predict(double length) noexcept {
  const Eigen::Index n = num_unknowns_;
  // Newton's form of the polynomial through the last states.
  y_.head(n) = now_.y.head(n);
  if (now_.step > 0) {
    const double h1 = now_.step;
    way_.head(n) = (now_.y.head(n) - before_.y.head(n)) / h1;
    y_.head(n) += length * way_.head(n);
    if (before_.step > 0) {
      const double h2 = before_.step;
      of_mass_.head(n) = (before_.y.head(n) - y_before_that_.head(n)) / h2;
      y_.head(n) += length * (length + h1) / (h1 + h2) * (way_.head(n) - of_mass_.head(n));
    }
  }
  put_prescribed();
}

void ReducedBody::put_prescribed() noexcept {
  for (Eigen::Index tool = 0; tool < holding_.size(); ++tool) {
    if (!is_prescribed(tool)) continue;
    y_.segment<3>(model_.num_modes + 3 * tool) = place_.segment<3>(3 * tool);
  }
}

double ReducedBody::evaluate(bool with_tangent) noexcept {
  sums_ = with_tangent ? energy_.linearise(y_.data()) : energy_.evaluate(y_.data());
  whole_force_ = energy_.force();
  double potential = sums_.potential;
  if (has_inertia_) {
    way_ = y_ - centre_;
    of_mass_.noalias() = model_.mass * way_;
    whole_force_ += inertia_ * of_mass_;
    potential += 0.5 * inertia_ * way_.dot(of_mass_);
  }
  residual_ = whole_force_;
  for (Eigen::Index tool = 0; tool < holding_.size(); ++tool) {
    if (is_prescribed(tool)) continue;
    const Eigen::Index first = model_.num_modes + 3 * tool;
    const Vec3 stretch = y_.segment<3>(first) - place_.segment<3>(3 * tool);
    residual_.segment<3>(first) += holding_[tool] * stretch;
    potential += 0.5 * holding_[tool] * stretch.squaredNorm();
  }
  ++state_.evaluations;
  if (with_tangent) ++state_.tangents;
  return potential;
}

double ReducedBody::residual_norm() const noexcept {
  return residual_.head(num_unknowns_).cwiseProduct(residual_weight_.head(num_unknowns_)).norm();
}

void ReducedBody::prepare_factor() noexcept {
  if (has_inertia_) factor_ += inertia_ * model_.mass;
  for (Eigen::Index tool = 0; tool < holding_.size(); ++tool) {
    const Eigen::Index first = model_.num_modes + 3 * tool;
    if (!is_prescribed(tool)) {
      factor_.diagonal().segment<3>(first).array() += holding_[tool];
      continue;
    }
    // A prescribed coordinate is no unknown, so it is decoupled.
    factor_.middleRows<3>(first).setZero();
    factor_.middleCols<3>(first).setZero();
    factor_.diagonal().segment<3>(first).setOnes();
  }
}

void ReducedBody::factorise() noexcept {
  const ReducedKernels& kernels = best_reduced_kernels();
  const Eigen::Index n = num_unknowns_;
  factor_ = energy_.tangent();
  prepare_factor();
  if (kernels.factorise(n, factor_.rows(), factor_.data())) return;
  // If the material is not stable here, take the stiffness at rest.
  factor_.setIdentity();
  const Eigen::Index d = model_.num_tool_coordinates;
  factor_.bottomRightCorner(d, d) = model_.tool_stiffness;
  prepare_factor();
  (void)kernels.factorise(n, factor_.rows(), factor_.data());
}

ReducedOutcome ReducedBody::attempt(double length) noexcept {
  const Eigen::Index n = num_unknowns_;
  const Eigen::Index d = model_.num_tool_coordinates;
  state_.trust = trust_of_places();
  if (state_.trust > options_.largest_trust) return ReducedOutcome::beyond_training;
  if (!may_linearise()) return ReducedOutcome::not_converged;
  set_step(length);
  predict(length);
  double potential = evaluate(true);
  if (!std::isfinite(potential)) {
    if (!may_linearise()) return ReducedOutcome::not_converged;
    y_.head(n) = now_.y.head(n);
    put_prescribed();
    potential = evaluate(true);
    if (!std::isfinite(potential)) return ReducedOutcome::not_converged;
  }
  direction_.tail(d).noalias() = model_.tool_stiffness * y_.tail(d);
  const double least = kLeastScale * kLeastScale *
                       model_.trained_tools.cwiseAbs2().dot(model_.tool_stiffness.diagonal());
  const double scale = std::sqrt(std::max(y_.tail(d).dot(direction_.tail(d)), least));
  double norm = residual_norm();
  bool has_factor = false;
  for (int iteration = 0; !(norm <= options_.tolerance * scale); ++iteration) {
    if (iteration == options_.max_iterations) return ReducedOutcome::not_converged;
    ++state_.iterations;
    if (!has_factor) factorise();
    has_factor = true;
    direction_.head(n) = -residual_.head(n);
    for (Eigen::Index i = model_.num_modes; i < n; ++i) {
      if (residual_weight_[i] == 0) direction_[i] = 0;
    }
    const auto lower = factor_.topLeftCorner(n, n).triangularView<Eigen::Lower>();
    lower.solveInPlace(direction_.head(n));
    lower.transpose().solveInPlace(direction_.head(n));
    const double slope = residual_.head(n).dot(direction_.head(n));
    trial_from_ = y_;
    const double potential_from = potential;
    const double norm_from = norm;
    double way = 1;
    for (int backtrack = 0;; ++backtrack) {
      if (!may_evaluate()) return ReducedOutcome::not_converged;
      y_.head(n) = trial_from_.head(n) + way * direction_.head(n);
      potential = evaluate(false);
      norm = residual_norm();
      if (potential <= potential_from + kDecrease * way * slope) break;
      // If rounding hides the decrease, the residual decides.
      if (std::abs(way * slope) < kRounding * std::abs(potential_from) && norm < norm_from) break;
      if (backtrack == kMaxBacktracks) return ReducedOutcome::not_converged;
      const double best = -slope * way / (2 * (potential - potential_from - slope * way));
      way *= std::isfinite(potential) ? std::clamp(best, kLeastBacktrack, 0.5) : 0.5;
    }
    if (norm > kSlowContraction * norm_from && norm > options_.tolerance * scale) {
      if (!may_linearise()) return ReducedOutcome::not_converged;
      potential = evaluate(true);
      has_factor = false;
    }
  }
  state_.residual = norm / scale;
  if (!std::isfinite(norm)) return ReducedOutcome::not_converged;
  state_.trust = trust();
  return ReducedOutcome::converged;
}

void ReducedBody::take_step(double length) noexcept {
  const Eigen::Index n = model_.num_modes;
  const Eigen::Index d = model_.num_tool_coordinates;
  way_ = rate_[0] * y_ + rate_[1] * now_.y + rate_[2] * before_.y;
  y_before_that_ = before_.y;
  before_ = now_;
  now_.y = y_;
  now_.velocity = way_;
  now_.step = length;
  if (memory_.is_viscous()) {
    memory_.end_step(energy_.law_stress().data(), energy_.strain().data());
    state_.viscous_stored = memory_.stored();
    state_.dissipated = memory_.work() - memory_.stored();
  }
  // The work of the last force and of the new one; the force of a spring follows from its stretch.
  const auto moved = y_.tail(d) - before_.y.tail(d);
  state_.work += 0.5 * body_force_.dot(moved);
  for (Eigen::Index tool = 0; tool < holding_.size(); ++tool) {
    const Eigen::Index first = 3 * tool;
    body_force_.segment<3>(first) =
        is_prescribed(tool)
            ? Vec3(whole_force_.segment<3>(n + first))
            : Vec3(holding_[tool] * (place_.segment<3>(first) - y_.segment<3>(n + first)));
  }
  state_.work += 0.5 * body_force_.dot(moved);
  state_.minimum_det_f = sums_.minimum_det_f;
  state_.elastic = sums_.elastic;
  if (has_inertia_) {
    of_mass_.noalias() = model_.mass * now_.velocity;
    state_.kinetic = 0.5 * now_.velocity.dot(of_mass_);
  }
}

void ReducedBody::add_memory(MemoryRanges& ranges) const {
  palpate::add_memory(model_, ranges);
  ranges.push_back({this, sizeof *this});
  energy_.add_memory(ranges);
  memory_.add_memory(ranges);
  for (const Past* past : {&now_, &before_}) {
    palpate::add_memory(past->y, ranges);
    palpate::add_memory(past->velocity, ranges);
  }
  for (const Eigen::VectorXd* values :
       {&y_before_that_, &holding_, &residual_weight_, &tools_from_, &tools_change_, &place_,
        &centre_, &y_, &trial_from_, &way_, &of_mass_, &whole_force_, &residual_, &direction_,
        &force_, &body_force_}) {
    palpate::add_memory(*values, ranges);
  }
  palpate::add_memory(factor_, ranges);
}

}  // namespace palpate
