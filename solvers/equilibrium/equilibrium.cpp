// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/equilibrium.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "assembly/external_energy.h"
#include "assembly/piece_support.h"
#include "base/error.h"
#include "equilibrium/condensed_system.h"
#include "equilibrium/corrector.h"
#include "equilibrium/explanation.h"
#include "equilibrium/linearisation.h"
#include "equilibrium/ramp.h"
#include "equilibrium/third_derivative.h"
#include "interaction/held_points.h"
#include "interaction/interaction_list.h"
#include "soft_contact/soft_contact.h"
#include "threads/thread_team.h"

namespace palpate {
namespace {

/// The error of the energy of a step that counts as a jump, as a share of its change. Across a jump
/// the error is a large share, and on a smooth path a far smaller one.
constexpr double kEnergyGap = 0.05;
/// A further allowance, as a share of the work of the change of force, for steps over which the
/// energy hardly changes.
constexpr double kWorkGap = 0.01;
/// If rounding does not allow the displacement the accuracy that was asked for, as with stiffnesses
/// that differ by 1e9, an error up to this is accepted and flagged.
constexpr double kMostDisplacementError = 1e-6;
/// A Newton step longer than this share of the displacement does not correct rounding: the tangent
/// is nearly singular there, and the step may lead to another branch.
constexpr double kMostPolish = 1e-2;
/// After this many failures in a row, the path is followed instead of halving the step again.
constexpr int kFailuresBeforeFollowing = 3;
/// The relative residual of v without a factor. The error of k is the square of it, and the third
/// derivative has about the same relative error as v.
constexpr double kSensitivityErrorWithoutFactor = 1e-6;
/// The largest number of points of a path within a solve; each takes two or three factorisations.
constexpr int kMaxPathPoints = 150;

/// The names of the loads that act: the properties BodyForce, AppliedPressure, AppliedTraction, and
/// further terms.
std::string names_of_loads(const Scene& scene, const std::vector<const EnergyTerm*>& terms) {
  std::string names;
  const auto add = [&](bool is_there, const char* name) {
    if (is_there) names += (names.empty() ? "" : " and ") + std::string(name);
  };
  add(scene.organ.has_body_force(), "BodyForce");
  add(!scene.body.applied_pressure.empty(), "AppliedPressure");
  add(!scene.body.applied_traction.empty(), "AppliedTraction");
  add(!terms.empty(), "further energies");
  return names;
}

Scene checked(Scene scene) {
  check(scene);
  return scene;
}

void take(LinearisedState state, Equilibrium& equilibrium) {
  static_cast<LinearisedState&>(equilibrium) = std::move(state);
}

/// Whether a step from a state has shown that the body can move freely at rest.
bool is_mobile(Outcome outcome, const Equilibrium& from) {
  return outcome == Outcome::tangent_not_factorised && (from.flags & flags::touches_nothing) != 0;
}

/// Whether two equilibria can lie on one smooth path, by their energies, reactions and stiffnesses.
bool agree(const CondensedSystem& system, const Equilibrium& from, const Equilibrium& to) {
  // The tool has touched nothing, and now touches the body. There is one branch, which begins
  // there.
  if (from.stiffness.isZero(0) && from.reaction.isZero(0)) return true;
  const Eigen::VectorXd d = to.t - from.t;
  const double change = to.energy - from.energy;
  const double expected =
      0.5 * d.dot(from.reaction + to.reaction) + d.dot((from.stiffness - to.stiffness) * d) / 12;
  const double allowed =
      kEnergyGap * std::max(std::abs(change), std::abs(expected)) +
      kWorkGap * 0.5 * std::abs(d.dot(to.reaction - from.reaction)) +
      kEnergyRounding * (std::abs(from.energy) + std::abs(to.energy) + system.energies_at_rest() +
                         system.mean_stiffness() * d.squaredNorm());
  return std::abs(change - expected) <= allowed;
}

}  // namespace

void validate(const EquilibriumOptions& options) {
  const auto require = [](bool condition, const char* message) {
    if (!condition) throw InputError(message);
  };
  require(options.tolerance > 0 && options.tolerance < 1, "tolerance must be between 0 and 1.");
  require(options.max_iterations >= 1, "max_iterations must be at least 1.");
  require(options.max_halvings >= 0, "max_halvings must not be negative.");
  require(options.max_steps >= 1, "max_steps must be at least 1.");
  require(options.max_seconds >= 0, "max_seconds must not be negative.");
  require(options.contraction >= 0 && options.contraction < 1,
          "contraction must be at least 0 and less than 1.");
  require(options.kept_factors >= 2, "kept_factors must be at least 2.");
  require(options.threads >= 0 && options.threads <= kMostThreads,
          "threads must be from 0, as many as there are cores, to 1024.");
}

class EquilibriumSolver::Impl {
 public:
  /// @param scene, options Both must be valid.
  Impl(const Scene& scene, EquilibriumOptions options, std::unique_ptr<LinearSolver> solver,
       const std::vector<const EnergyTerm*>& terms, std::unique_ptr<Team> team)
      : options_(std::move(options)),
        team_(std::move(team)),
        contact_(make_soft_contact(scene)),
        system_(scene, std::move(solver), options_.kept_factors,
                options_.single_precision ? Precision::single_if_safe : Precision::full,
                with_contact(contact_.get(), terms)),
        support_(scene),
        rest_(NodalVector::Zero(system_.assembly().state_size())) {
    settled_.outcome = Outcome::converged;
    if (scene.has_load() || !scene.body.support_stiffness.empty() || contact_ != nullptr ||
        !terms.empty()) {
      set_external(scene, terms);
    }
  }

  /// The threads of the solver; null: there is only one.
  Team* team() const { return team_.get(); }
  void set_interaction(const Interaction& interaction) {
    if (interaction.num_coordinates() == 0) {
      throw InputError("No active node was given. Name a point that is not fixed.");
    }
    system_.set_interaction(interaction);
    held_by_tool_ = held_points(interaction);
    mobile_part_.reset();
  }
  const Equilibrium& settled() const { return settled_; }
  const EquilibriumOptions& options() const { return options_; }
  Equilibrium rest(const Eigen::VectorXd& t);
  Equilibrium solve(const Eigen::VectorXd& t, const Equilibrium& start, Tangent tangent);
  Equilibrium settle(const Equilibrium& near);
  void forget(const Equilibrium& state) { system_.forget(state.t, system_.vector_of(state)); }
  Path trace(const Eigen::VectorXd& t, const Equilibrium& start, const PathOptions& options);
  double condition(const Equilibrium& state);

  const CondensedSystem& system() const { return system_; }

 private:
  /// The present state of a solve.
  struct Progress {
    Equilibrium state;
    /// The share of the distance that is done.
    double way = 0;
    /// The change of ∂x/∂way over the last step, and the length of that step as a share of the
    /// distance.
    NodalVector bend;
    double last_stride = 0;
    std::vector<Fold> folds;
    int iterations = 0;
    int steps = 0;
  };

  void begin();
  /// Finds the rest of the body under its loads and springs and with further terms.
  void set_external(const Scene& scene, const std::vector<const EnergyTerm*>& terms);
  void require_coordinates(const Eigen::VectorXd& t) const;
  [[nodiscard]] Outcome interruption() const;
  /// Tries a step from progress, and gives the equilibrium at next_t that it leads to.
  Equilibrium step(double stride, const Eigen::VectorXd& next_t, Tangent tangent,
                   Progress& progress);
  /// Completes the equilibrium at x, after further Newton steps if the displacement needs them.
  Outcome polish(NodalVector& x, Equilibrium& next, Tangent tangent, Progress& progress);
  /// Linearises with a factor or, in an iterative system, without one.
  /// @param tangent What is needed in an iterative system.
  std::optional<Linearisation> linearise_at(const Eigen::VectorXd& t, const NodalVector& x,
                                            Tangent tangent);
  /// The outcome of a state at which linearise_at() gives nothing.
  Outcome no_tangent() const {
    return system_.is_iterative() ? Outcome::tangent_not_solved : Outcome::tangent_not_factorised;
  }
  /// @throws InputError the system is iterative, so that there is no factor.
  /// @param what What the factor is needed for.
  void require_factor(const char* what) const;
  /// Sets flags::inaccurate if the displacement is less accurate than was asked for.
  void tell_accuracy(Equilibrium& state) const;
  /// Adds the third derivative to an equilibrium that has converged, if it was asked for.
  void add_third_derivative(Equilibrium& state);
  /// Makes the next equilibrium the present one.
  void advance(double stride, const Eigen::VectorXd& way, Equilibrium next, Progress& progress);
  /// Predicts a state near the equilibrium at next_t, with a finite energy; nothing: none was
  /// found.
  std::optional<NodalVector> predict(double stride, const Eigen::VectorXd& next_t,
                                     const Progress& progress);
  /// Follows the path, around its folds, to t. If this fails, the state of progress is unchanged.
  Outcome follow(const Eigen::VectorXd& t, Progress& progress);
  /// Finds the least det F of a state, and the cell that has it.
  void find_worst_cell(Equilibrium& state) const;
  /// The message about a solve that has done the share `way` of the distance to t.
  [[nodiscard]] std::string explain_end(const Equilibrium& state, const Eigen::VectorXd& t,
                                        double way);
  /// The fold at which the body jumped, between two equilibria that do not agree.
  static Fold jump(const Equilibrium& from, const Equilibrium& to, double way);

  EquilibriumOptions options_;
  std::unique_ptr<Team> team_;
  /// The contact of the parts with each other; null: they have none.
  std::unique_ptr<const SoftContact> contact_;
  CondensedSystem system_;
  PieceSupport support_;
  /// The points that the tool prescribes.
  std::vector<Index> held_by_tool_;
  /// The part of the body that turns, once this was searched for; an empty text: none does.
  std::optional<std::string> mobile_part_;
  /// The loads and springs of the body; empty: there are none.
  std::optional<ExternalEnergy> external_;
  /// The state of rest without a tool, and its energy, J.
  NodalVector rest_;
  double rest_energy_ = 0;
  Equilibrium settled_;
  SteadyClock::time_point start_{};
};

void EquilibriumSolver::Impl::begin() {
  start_ = SteadyClock::now();
  system_.begin_solve();
}

void EquilibriumSolver::Impl::require_coordinates(const Eigen::VectorXd& t) const {
  if (system_.num_coordinates() == 0) throw InputError("No active node was chosen.");
  if (t.size() != system_.num_coordinates()) {
    throw InputError("A displacement of " + std::to_string(system_.num_coordinates()) +
                     " components is needed, three for each active node; " +
                     std::to_string(t.size()) + " were given.");
  }
  if (!t.allFinite()) throw InputError("The displacement is not finite.");
}

Outcome EquilibriumSolver::Impl::interruption() const {
  if (options_.abort_requested && options_.abort_requested()) return Outcome::aborted;
  if (options_.max_seconds > 0 && seconds_since(start_) > options_.max_seconds) {
    return Outcome::budget_used_up;
  }
  return Outcome::converged;
}

void EquilibriumSolver::Impl::set_external(const Scene& scene,
                                           const std::vector<const EnergyTerm*>& terms) {
  begin();
  const Assembly& assembly = system_.assembly();
  external_.emplace(scene, assembly);
  std::vector<const EnergyTerm*> all = with_contact(contact_.get(), terms);
  all.insert(all.begin(), &*external_);
  system_.set_terms(std::move(all));
  system_.set_interaction(InteractionList());
  if (!scene.has_load() && terms.empty()) {
    system_.set_rest(rest_);
    rest_energy_ = system_.evaluate(Eigen::VectorXd(), rest_).energy;
    return;
  }
  Ramp ramp;
  ramp.at = [this](double share) {
    external_->set_share(share);
    return Eigen::VectorXd();
  };
  const RampEnd end = follow_ramp(
      system_, options_, [this] { return interruption(); }, ramp, rest_);
  external_->set_share(1);
  system_.set_rest(rest_);
  NodalVector force;
  const double of_materials = assembly.residual(rest_, force).energy;
  const double of_external = external_->add(rest_, force, nullptr);
  double of_terms = 0;
  for (const EnergyTerm* term : with_contact(contact_.get(), terms)) {
    of_terms += term->add(rest_, force, nullptr);
  }
  system_.set_energies_at_rest(std::abs(of_materials) + std::abs(of_external) + std::abs(of_terms));
  external_->count_from(rest_, of_materials + of_terms);
  rest_energy_ = system_.evaluate(Eigen::VectorXd(), rest_).energy;
  Equilibrium& state = settled_;
  state.u = rest_.head(3 * Eigen::Index{assembly.num_points()});
  state.p = rest_.tail(assembly.num_pressures()).cwiseProduct(system_.pressure_scale());
  state.energy = of_materials + of_external + of_terms;
  state.outcome = end.outcome;
  state.summary.residual = end.residual;
  state.summary.iterations = end.iterations;
  take_determinant(assembly, rest_, state);
  state.summary.seconds = seconds_since(start_);
  if (end.outcome != Outcome::converged) {
    if (auto mobile = support_.find_mobile_piece({})) {
      state.summary.message = std::move(*mobile);
      return;
    }
    std::ostringstream text;
    text << "The body finds no rest under its load, " << names_of_loads(scene, terms) << ": "
         << describe(end) << ". Make the load smaller or the body stiffer, or fix more of it"
         << advise_finer_quadrature(assembly) << '.';
    state.summary.message = text.str();
  }
}

Equilibrium EquilibriumSolver::Impl::rest(const Eigen::VectorXd& t) {
  begin();
  const Index coordinates = system_.num_coordinates();
  require_coordinates(t);
  const Assembly& assembly = system_.assembly();
  Equilibrium state;
  state.t = t;
  state.u = rest_.head(3 * Eigen::Index{assembly.num_points()});
  state.v.setZero(state.u.size(), coordinates);
  state.p = rest_.tail(assembly.num_pressures()).cwiseProduct(system_.pressure_scale());
  state.p_v.setZero(assembly.num_pressures(), coordinates);
  state.reaction.setZero(coordinates);
  state.stiffness.setZero(coordinates, coordinates);
  if (settled_.outcome != Outcome::converged) {
    state.outcome = settled_.outcome;
    state.summary.message = settled_.summary.message;
    return state;
  }
  if (system_.evaluate(t, rest_).energy != rest_energy_) {
    throw InputError("The body is touched at the start, by " + system_.interaction().describe(t) +
                     ". Let the tool start outside of it.");
  }
  if (system_.tool_is_inside(t, rest_)) {
    throw InputError("The tool is inside the body at the start: " +
                     system_.interaction().describe(t) + ". Let the tool start outside of it.");
  }
  // Search for mobile pieces directly: if the tool touches nothing, the tangent that would show
  // them may not be computed.
  const std::optional<std::string> mobile = support_.find_mobile_piece(held_by_tool_);
  std::optional<Linearisation> at_rest;
  if (!mobile) at_rest = linearise_at(state.t, rest_, Tangent::factorised);
  if (at_rest) {
    take(std::move(at_rest->state), state);
    state.outcome = Outcome::converged;
  } else {
    state.outcome = no_tangent();
  }
  tell_accuracy(state);
  state.summary.message = state.outcome == Outcome::converged ? explain(system_, state, state.t, 1)
                          : mobile                            ? *mobile
                                                              : explain_singular(system_);
  add_third_derivative(state);
  state.summary.seconds = seconds_since(start_);
  return state;
}

void EquilibriumSolver::Impl::add_third_derivative(Equilibrium& state) {
  if (!options_.third_derivatives || state.outcome != Outcome::converged) return;
  if ((state.flags & flags::touches_nothing) != 0) {
    state.third_derivative.setZero(num_third_derivatives(system_.num_coordinates()));
    return;
  }
  state.third_derivative = third_derivative(system_, state);
}

std::optional<NodalVector> EquilibriumSolver::Impl::predict(double stride,
                                                            const Eigen::VectorXd& next_t,
                                                            const Progress& progress) {
  const NodalVector here = system_.vector_of(progress.state);
  NodalVector predicted =
      here + system_.sensitivity_of(progress.state) * (next_t - progress.state.t);
  if (progress.last_stride > 0) {
    const NodalVector curved =
        predicted + (0.5 * stride * stride / progress.last_stride) * progress.bend;
    predicted = system_.evaluate(next_t, curved).is_finite() ? curved : predicted;
  }
  system_.prescribe(next_t, predicted);
  if (system_.longest_share(here, predicted - here) < 1) return std::nullopt;
  if (system_.evaluate(next_t, predicted).is_finite()) return predicted;
  return std::nullopt;
}

Equilibrium EquilibriumSolver::Impl::step(double stride, const Eigen::VectorXd& next_t,
                                          Tangent tangent, Progress& progress) {
  ++progress.steps;
  Equilibrium next;
  next.t = next_t;
  std::optional<NodalVector> state = predict(stride, next_t, progress);
  if (!state) return next;
  const auto interrupted = [this] { return interruption(); };
  const Correction correction =
      system_.is_iterative()
          ? correct_by_iteration(system_, options_, interrupted, next_t, *state)
          : correct(system_, options_, interrupted, progress.state, next_t, *state);
  progress.iterations += correction.iterations;
  next.summary.residual = correction.residual;
  next.outcome = correction.outcome;
  if (correction.outcome != Outcome::converged) return next;
  const bool is_linear = system_.is_linear();
  if (is_linear && correction.iterations == 0 &&
      progress.state.displacement_error <= options_.displacement_error()) {
    take(superpose(system_, progress.state, next_t, *state), next);
    return next;
  }
  const double error = tangent == Tangent::rough ? kRoughSensitivityError : kSensitivityError;
  if (tangent != Tangent::factorised && !is_linear && !system_.is_iterative()) {
    std::optional<LinearisedState> iterated = linearise_by_iteration(
        system_, options_, correction, progress.state, next_t, *state, error);
    if (iterated) {
      take(std::move(*iterated), next);
      return next;
    }
  }
  next.outcome = polish(*state, next, tangent, progress);
  return next;
}

std::optional<Linearisation> EquilibriumSolver::Impl::linearise_at(const Eigen::VectorXd& t,
                                                                   const NodalVector& x,
                                                                   Tangent tangent) {
  if (!system_.is_iterative()) return linearise(system_, t, x);
  const double error =
      tangent == Tangent::rough ? kRoughSensitivityError : kSensitivityErrorWithoutFactor;
  return linearise_without_factor(
      system_, t, x, error,
      tangent == Tangent::factorised ? InertiaSearch::lowest_eigenvalue : InertiaSearch::none);
}

void EquilibriumSolver::Impl::require_factor(const char* what) const {
  if (system_.is_iterative()) {
    throw InputError(std::string(what) +
                     " needs a factor of the tangent, and this body is solved for by iteration. "
                     "Choose a direct linear solver.");
  }
}

Outcome EquilibriumSolver::Impl::polish(NodalVector& x, Equilibrium& next, Tangent tangent,
                                        Progress& progress) {
  std::optional<Linearisation> first = linearise_at(next.t, x, tangent);
  if (!first) return no_tangent();
  Linearisation here = std::move(*first);
  while (here.state.displacement_error > options_.displacement_error()) {
    const double before = here.state.displacement_error;
    if (before > kMostPolish) return Outcome::not_converged;
    const NodalVector improved = x + here.newton_step;
    const Evaluation at = system_.evaluate(next.t, improved);
    if (!at.is_finite()) return Outcome::not_converged;
    const double residual = system_.norm(system_.residual(at)) / system_.displacement_scale(next.t);
    if (!(residual <= options_.tolerance)) break;
    ++progress.iterations;
    std::optional<Linearisation> there = linearise_at(next.t, improved, tangent);
    if (!there) return no_tangent();
    // A different inertia means another branch. If the error grows, only rounding is left.
    if (there->state.negative_pivots != here.state.negative_pivots ||
        !(there->state.displacement_error < before)) {
      break;
    }
    x = improved;
    here = std::move(*there);
    next.summary.residual = residual;
    if (here.state.displacement_error > 0.5 * before) break;
  }
  take(std::move(here.state), next);
  if (next.displacement_error > std::max(kMostDisplacementError, options_.displacement_error())) {
    return Outcome::not_converged;
  }
  tell_accuracy(next);
  return Outcome::converged;
}

void EquilibriumSolver::Impl::tell_accuracy(Equilibrium& state) const {
  if (state.displacement_error > options_.displacement_error()) state.flags |= flags::inaccurate;
}

void EquilibriumSolver::Impl::advance(double stride, const Eigen::VectorXd& way, Equilibrium next,
                                      Progress& progress) {
  progress.bend = (system_.sensitivity_of(next) - system_.sensitivity_of(progress.state)) * way;
  progress.last_stride = stride;
  progress.state = std::move(next);
  progress.way += stride;
}

Outcome EquilibriumSolver::Impl::follow(const Eigen::VectorXd& t, Progress& progress) {
  PathOptions options;
  options.max_points = std::clamp(options_.max_steps - progress.steps + 1, 2, kMaxPathPoints);
  Path path = follow_path(
      system_, options_, options, [this] { return interruption(); }, progress.state, t);
  progress.steps += static_cast<int>(path.points.size()) - 1;
  progress.iterations += path.end.summary.iterations;
  if (path.end.outcome != Outcome::converged) return path.end.outcome;
  NodalVector end = system_.vector_of(path.end);
  const Outcome outcome = polish(end, path.end, Tangent::factorised, progress);
  if (outcome != Outcome::converged) return outcome;
  for (Fold& fold : path.end.summary.folds) {
    fold.way = progress.way + (1 - progress.way) * fold.way;
    progress.folds.push_back(std::move(fold));
  }
  progress.state = std::move(path.end);
  progress.way = 1;
  return outcome;
}

Fold EquilibriumSolver::Impl::jump(const Equilibrium& from, const Equilibrium& to, double way) {
  return {way, from.t, from.energy, from.reaction, true, to.energy, to.reaction};
}

void EquilibriumSolver::Impl::find_worst_cell(Equilibrium& state) const {
  const Assembly& assembly = system_.assembly();
  NodalVector x = NodalVector::Zero(assembly.state_size());
  x.head(state.u.size()) = state.u;
  take_worst_cell(assembly, x, state);
}

std::string EquilibriumSolver::Impl::explain_end(const Equilibrium& state, const Eigen::VectorXd& t,
                                                 double way) {
  std::string text = explain(system_, state, t, way);
  // A factor would have shown a singular tangent; conjugate gradients just do not converge there.
  const bool is_lost =
      state.outcome == Outcome::not_converged || state.outcome == Outcome::tangent_not_solved;
  if (!is_lost || !system_.is_iterative()) return text;
  if (!mobile_part_) {
    std::vector<char> held = system_.holding_points();
    for (const Index point : held_by_tool_) held[point] = 1;
    mobile_part_ = find_mobile_part(system_.mesh(), held).value_or("");
  }
  return mobile_part_->empty() ? text : text + ' ' + *mobile_part_;
}

Equilibrium EquilibriumSolver::Impl::solve(const Eigen::VectorXd& t, const Equilibrium& start,
                                           Tangent tangent) {
  begin();
  require_coordinates(t);
  if (start.outcome != Outcome::converged) return start;
  const Eigen::VectorXd way = t - start.t;
  Progress progress;
  progress.state = start;
  // Lengths are powers of two, so that the last step ends at exactly 1.
  double longest_stride = 1;
  const double longest_step = system_.longest_step();
  while (longest_stride * way.lpNorm<Eigen::Infinity>() > longest_step) longest_stride *= 0.5;
  double stride = longest_stride;
  Outcome outcome = Outcome::converged;
  const double least_stride = std::ldexp(longest_stride, -options_.max_halvings);
  bool may_follow = options_.follow_folds && !system_.is_iterative();
  // On the way, v serves the next prediction alone. A factor is of use to the next step; without
  // factors, an exact v and the inertia would be for nothing.
  const Tangent on_the_way = system_.is_iterative() ? Tangent::rough : Tangent::factorised;
  int failures = 0;  // in a row
  while (progress.way < 1) {
    if (progress.steps >= options_.max_steps) {
      outcome = Outcome::budget_used_up;
      break;
    }
    // The lengths add up to exactly 1, since they are powers of two.
    stride = std::min({stride, longest_stride, 1 - progress.way});
    const double next_way = progress.way + stride;
    const bool last = next_way == 1;
    Equilibrium next = step(stride, last ? t : Eigen::VectorXd(start.t + next_way * way),
                            last ? tangent : on_the_way, progress);
    outcome = next.outcome;
    if (outcome == Outcome::aborted || outcome == Outcome::budget_used_up) break;
    if (outcome == Outcome::tool_inside) {
      // No path leads around this: the tool does not touch the body from outside any more.
      longest_stride = 0.5 * stride;
      if (longest_stride < least_stride) break;
      continue;
    }
    if (is_mobile(outcome, progress.state)) break;
    if (outcome == Outcome::converged && agree(system_, progress.state, next)) {
      advance(stride, way, std::move(next), progress);
      stride *= 2;
      failures = 0;
      continue;
    }
    // For an inverted body, the branch that it is on has no physical meaning.
    const bool worth_it = options_.follow_folds || (next.flags & flags::inverted) == 0;
    const bool least = 0.5 * stride < least_stride;
    if (may_follow && (++failures == kFailuresBeforeFollowing || least)) {
      may_follow = false;
      const Outcome of_path = follow(t, progress);
      if (of_path == Outcome::converged || of_path == Outcome::aborted ||
          of_path == Outcome::tool_inside) {
        outcome = of_path;
        break;
      }
    }
    if (!least && (worth_it || outcome != Outcome::converged)) {
      stride *= 0.5;
      continue;
    }
    if (outcome != Outcome::converged) break;
    // This is another equilibrium of less energy, to which the body jumps.
    progress.folds.push_back(jump(progress.state, next, progress.way));
    advance(stride, way, std::move(next), progress);
    progress.last_stride = 0;
  }
  Equilibrium& state = progress.state;
  const bool is_told_to = outcome == Outcome::aborted || outcome == Outcome::budget_used_up;
  if (outcome != Outcome::converged && !is_told_to && progress.way > 0 && system_.is_iterative() &&
      tangent != Tangent::rough) {
    // The solve ends on the way, where v is rough.
    auto exact = linearise_at(state.t, system_.vector_of(state), tangent);
    if (exact) take(std::move(exact->state), state);
  }
  state.outcome = outcome;
  state.summary.folds = std::move(progress.folds);
  if (!state.summary.folds.empty()) state.flags |= flags::near_fold;
  state.summary.iterations = progress.iterations;
  state.summary.steps = progress.steps;
  state.third_derivative.resize(0);  // that of the start
  if (tangent != Tangent::rough) add_third_derivative(state);
  state.summary.seconds = seconds_since(start_);
  // A start that was read from a file does not tell it.
  if (state.minimum_det_f_cell < 0) find_worst_cell(state);
  state.summary.message =
      is_mobile(outcome, state) ? explain_singular(system_) : explain_end(state, t, progress.way);
  return std::move(progress.state);
}

Equilibrium EquilibriumSolver::Impl::settle(const Equilibrium& near) {
  begin();
  require_coordinates(near.t);
  const Assembly& assembly = system_.assembly();
  Progress progress;
  progress.state = near;
  // Take only the unknowns from `near`. All other components of a state are zero, and the solve
  // would not change them.
  const Eigen::Index displacements = near.u.size();
  progress.state.u.setZero();
  progress.state.p.setZero(assembly.num_pressures());
  for (const Index place : assembly.state_of_unknown()) {
    if (place < displacements) {
      progress.state.u[place] = near.u[place];
    } else if (near.p.size() > 0) {
      progress.state.p[place - displacements] = near.p[place - displacements];
    }
  }
  system_.hold_directions(progress.state.u);
  progress.state.v.setZero(near.u.size(), system_.num_coordinates());
  progress.state.p_v.setZero(assembly.num_pressures(), system_.num_coordinates());
  Equilibrium settled = step(1, near.t, Tangent::factorised, progress);
  settled.summary.iterations = progress.iterations;
  settled.summary.steps = progress.steps;
  add_third_derivative(settled);
  settled.summary.seconds = seconds_since(start_);
  return settled;
}

Path EquilibriumSolver::Impl::trace(const Eigen::VectorXd& t, const Equilibrium& start,
                                    const PathOptions& options) {
  begin();
  validate(options);
  require_factor("A path");
  require_coordinates(t);
  if (start.outcome != Outcome::converged) return {{}, {}, start};
  if (t == start.t) throw InputError("A path needs a target that differs from its start.");
  Path path = follow_path(
      system_, options_, options, [this] { return interruption(); }, start, t);
  path.end.third_derivative.resize(0);  // that of the start
  tell_accuracy(path.end);
  path.end.summary.seconds = seconds_since(start_);
  path.end.summary.message = explain(system_, path.end, t, path.points.back().way);
  return path;
}

double EquilibriumSolver::Impl::condition(const Equilibrium& state) {
  require_factor("The condition number");
  begin();
  const auto tangent = system_.tangent(state.t, system_.vector_of(state));
  TangentFactor* factor = system_.factorise_accurately(*tangent);
  return factor == nullptr ? std::numeric_limits<double>::infinity()
                           : system_.condition(*tangent, *factor);
}

EquilibriumSolver::EquilibriumSolver(const Scene& scene, EquilibriumOptions options,
                                     std::unique_ptr<LinearSolver> linear_solver,
                                     const std::vector<const EnergyTerm*>& terms) {
  validate(options);
  const Scene sound = checked(scene);
  std::unique_ptr<Team> team =
      linear_solver == nullptr ? make_thread_team(options.threads) : nullptr;
  with_team(team.get(), [&] {
    impl_ = std::make_unique<Impl>(sound, std::move(options), std::move(linear_solver), terms,
                                   std::move(team));
  });
}
EquilibriumSolver::~EquilibriumSolver() = default;
EquilibriumSolver::EquilibriumSolver(EquilibriumSolver&&) noexcept = default;
EquilibriumSolver& EquilibriumSolver::operator=(EquilibriumSolver&&) noexcept = default;

const Assembly& EquilibriumSolver::assembly() const { return impl_->system().assembly(); }
const EquilibriumOptions& EquilibriumSolver::options() const { return impl_->options(); }

const Work& EquilibriumSolver::work() const { return impl_->system().work(); }
void EquilibriumSolver::set_interaction(const Interaction& interaction) {
  impl_->set_interaction(interaction);
}
const Equilibrium& EquilibriumSolver::settled() const { return impl_->settled(); }
Equilibrium EquilibriumSolver::rest(const Eigen::VectorXd& t) {
  return with_team(impl_->team(), [&] { return impl_->rest(t); });
}
Equilibrium EquilibriumSolver::rest() {
  return rest(Eigen::VectorXd::Zero(impl_->system().num_coordinates()));
}
Equilibrium EquilibriumSolver::solve(const Eigen::VectorXd& t, const Equilibrium& start,
                                     Tangent tangent) {
  return with_team(impl_->team(), [&] { return impl_->solve(t, start, tangent); });
}
Equilibrium EquilibriumSolver::settle(const Equilibrium& near) {
  return with_team(impl_->team(), [&] { return impl_->settle(near); });
}
Path EquilibriumSolver::trace(const Eigen::VectorXd& t, const Equilibrium& start,
                              const PathOptions& options) {
  return impl_->trace(t, start, options);
}
void EquilibriumSolver::forget(const Equilibrium& state) { impl_->forget(state); }
double EquilibriumSolver::condition(const Equilibrium& state) { return impl_->condition(state); }

void require_rest(const EquilibriumSolver& solver) {
  const Equilibrium& rest = solver.settled();
  if (rest.outcome == Outcome::converged || rest.outcome == Outcome::aborted) return;
  throw InputError(rest.summary.message);
}

}  // namespace palpate
