// SPDX-License-Identifier: BSD-3-Clause
#include "dynamics/dynamic_solver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "assembly/external_energy.h"
#include "assembly/mass.h"
#include "assembly/piece_support.h"
#include "base/error.h"
#include "base/quantity.h"
#include "dynamics/run_notes.h"
#include "dynamics/step_term.h"
#include "dynamics/viscosity.h"
#include "equilibrium/condensed_system.h"
#include "equilibrium/corrector.h"
#include "equilibrium/explanation.h"
#include "equilibrium/linearisation.h"
#include "equilibrium/ramp.h"
#include "interaction/held_points.h"
#include "interaction/interaction_list.h"
#include "soft_contact/soft_contact.h"
#include "threads/thread_team.h"

namespace palpate {
namespace {

/// The error of a step of BDF2, as a share of the difference of its result from a parabola through
/// the three states before, for equal steps: 2/9 h³u‴ of 11/9 h³u‴.
constexpr double kErrorShare = 2.0 / 11;
/// The bounds of the ratio of a step to the one before. BDF2 is stable for ratios below 1 + √2.
constexpr double kLongestRatio = 1.6;
constexpr double kShortestRatio = 0.3;
constexpr double kSafety = 0.9;
/// After a halving, this many steps are taken before the length is doubled.
constexpr int kStepsBeforeDoubling = 4;
/// Events that are nearer to each other than this share of the time step count as simultaneous.
constexpr double kInstant = 1e-3;
/// Shortest time step, s; the squares of shorter ones are of no use in the equations.
constexpr double kLeastTimeStep = 1e-12;
/// Shortest step as a share of the whole time; a shorter one would be lost in rounding.
constexpr double kLeastShare = 1e-12;

/// If a tool still passes through the surface of the body in a step of this share of the longest
/// one, the length of the step is not the cause.
constexpr double kShortestThrough = 1.0 / 16;

bool ends_run(Outcome outcome) {
  return outcome == Outcome::aborted || outcome == Outcome::budget_used_up;
}

std::vector<double> densities(const std::vector<Rheology>& rheologies) {
  std::vector<double> all;
  for (const Rheology& rheology : rheologies) all.push_back(rheology.density);
  return all;
}

InteractionList as_list(const Interaction& tools) {
  if (const auto* list = dynamic_cast<const InteractionList*>(&tools)) return *list;
  InteractionList list;
  list.add(tools);
  return list;
}

std::vector<Rheology> checked(const Scene& scene, const std::vector<Rheology>& rheologies) {
  if (rheologies.size() != scene.organ.materials.size()) {
    throw InputError("There are " + std::to_string(rheologies.size()) + " densities for " +
                     std::to_string(scene.organ.materials.size()) + " materials.");
  }
  for (const Rheology& rheology : rheologies) validate(rheology);
  if (!has_density(rheologies)) {
    throw InputError(
        "The body has no density, so that it has no motion in time. Give it one (Density of Assign "
        "Material, kg/m³; soft tissue has about 1000).");
  }
  if (scene.organ.has_body_force()) {
    throw InputError("A motion takes its gravity from its options, not from the scene.");
  }
  return rheologies;
}

}  // namespace

void validate(const DynamicsOptions& options) {
  const auto check = [](bool good, const std::string& what) {
    if (!good) throw InputError(what);
  };
  check(options.time_step >= kLeastTimeStep && std::isfinite(options.time_step),
        "The time step (TimeStep) is " + quantity(options.time_step, "s") +
            "; it must be at least " + quantity(kLeastTimeStep, "s") + ".");
  check(options.tolerance >= 0 && options.tolerance < 1,
        "The tolerance of a step (StepTolerance) is " + quantity(options.tolerance) +
            "; it must be from 0 to below 1.");
  check(options.spectral_radius >= 0 && options.spectral_radius <= 1,
        "The spectral radius (SpectralRadius) is " + quantity(options.spectral_radius) +
            "; it must be from 0 to 1.");
  check(options.max_halvings >= 0 && options.max_halvings <= 30,
        "A step may be halved (MaximumHalvings) " + std::to_string(options.max_halvings) +
            " times; give a number from 0 to 30.");
  check(options.gravity.allFinite(), "The gravity (BodyForce) has a component that is no number.");
  validate(options.equilibrium);
}

class DynamicSolver::Impl {
 public:
  Impl(const Scene& scene, const std::vector<Rheology>& rheologies, const Interaction& tools,
       DynamicsOptions options, std::unique_ptr<LinearSolver> linear_solver,
       const std::vector<const EnergyTerm*>& terms)
      : scene_(scene),
        rheologies_(checked(scene, rheologies)),
        options_(std::move(options)),
        all_tools_(as_list(tools)),
        contact_(make_soft_contact(scene)),
        further_(with_contact(contact_.get(), terms)),
        system_(scene, std::move(linear_solver), std::max(2, options_.equilibrium.kept_factors),
                options_.equilibrium.single_precision ? Precision::single_if_safe : Precision::full,
                further_),
        mass_(scene.body, densities(rheologies_), system_.assembly()),
        term_(system_.assembly(), mass_, mass_.weight(options_.gravity)) {
    if (scene_.body.has_supports_or_surface_loads()) external_.emplace(scene_, system_.assembly());
    system_.set_interaction(all_tools_);
    require_held();
    if (system_.is_iterative()) team_ = make_thread_team(options_.equilibrium.threads);
  }

  [[nodiscard]] const Work& work() const { return system_.work(); }
  /// The threads of a body without a factor; else null.
  [[nodiscard]] Team* team() const { return team_.get(); }

  DynamicState run(const ToolPath& path, double until, const TakeState& take,
                   const Eigen::VectorXd& clear) {
    start_ = SteadyClock::now();
    if (path.num_coordinates() != system_.num_coordinates()) {
      throw InputError("The way of the tools has " + std::to_string(path.num_coordinates()) +
                       " coordinates, but the tools have " +
                       std::to_string(system_.num_coordinates()) + '.');
    }
    if (!(until >= 0 && std::isfinite(until))) {
      throw InputError("The motion ends at " + quantity(until) +
                       " s (EndTime); it must end at a time that is not negative.");
    }
    DynamicState state =
        begin(path.at(0), clear.size() > 0 ? clear : Eigen::VectorXd::Zero(path.num_coordinates()));
    if (state.outcome != Outcome::converged || !take(state)) return state;
    RunNotes notes(contact_ != nullptr);
    notes.add(state);
    const double longest = std::min(options_.time_step, until);
    double next = longest;
    int good_steps = 0;
    // Events within this time are simultaneous: no step is left over from rounding, or between two
    // tools that are let go one shortly after the other, or shortly before the end.
    const double instant = kInstant * longest;
    const double shortest =
        std::max(std::ldexp(longest, -options_.max_halvings), kLeastShare * until);
    while (until - state.motion.time > instant) {
      let_go(path, state, instant);
      const double release = path.next_release(state.motion.time + instant);
      const double event = until - release > instant ? release : until;
      const double left = event - state.motion.time;
      // The last two steps before an event have the same length.
      const double num_steps = std::max(1.0, std::ceil(left / next - kInstant));
      double length = num_steps <= 2 ? left / num_steps : next;
      DynamicState to;
      int halvings = 0;
      for (;; ++halvings) {
        to =
            moves_too_far(path, state, length) ? untried(state, length) : step(path, state, length);
        if (ends_run(to.outcome)) break;
        // Shorter steps would only approach the time at which the tool passes through.
        if (to.outcome == Outcome::tool_inside && length <= kShortestThrough * options_.time_step) {
          break;
        }
        const bool accurate = options_.tolerance == 0 || to.local_error <= allowed_error(path, to);
        if (to.outcome == Outcome::converged && accurate) break;
        if (0.5 * length < shortest) {
          to.flags |= flags::inaccurate;
          break;
        }
        length /= 2;
        good_steps = 0;
      }
      to.halvings = halvings;
      if (length == left) to.motion.time = event;
      if (to.outcome != Outcome::converged) {
        state.outcome = to.outcome;
        const bool is_of_steps = !ends_run(to.outcome) && to.outcome != Outcome::tool_inside;
        state.message = is_of_steps ? to.message + advice(state, shortest) : to.message;
        return state;
      }
      end_step(state, to);
      state = std::move(to);
      notes.add(state);
      next = std::max(next_length(path, state, length, good_steps), shortest);
      if (!take(state)) {
        state.outcome = Outcome::aborted;
        return state;
      }
    }
    state.message = notes.describe(scene_.body.mesh, system_.assembly(), shortest);
    return state;
  }

 private:
  /// Requires that each piece of the body is held where the motion begins: by what is fixed alone
  /// if it comes to rest first, else by bonded tools too. Later, inertia keeps pieces that were let
  /// go from being singular.
  void require_held() const {
    const bool has_load = scene_.has_load() || !options_.gravity.isZero(0);
    const bool settles = options_.settled && has_load;
    PieceSupport(scene_).require_held(settles ? std::vector<Index>() : held_points(all_tools_));
  }

  /// Whether a tool could pass through the body in a step.
  [[nodiscard]] bool moves_too_far(const ToolPath& path, const DynamicState& from,
                                   double length) const {
    if (!system_.interaction().has_potential()) return false;
    const Eigen::VectorXd way = path.at(from.motion.time + length) - from.tools;
    return way.lpNorm<Eigen::Infinity>() > system_.interaction().longest_step();
  }

  [[nodiscard]] static DynamicState untried(const DynamicState& from, double length) {
    DynamicState to;
    to.outcome = Outcome::not_converged;
    to.message =
        "In the step of " + quantity(length, "s") + " from " + quantity(from.motion.time) +
        " s on a tool moves so far that it could pass through the body, or a part of it through "
        "another one.";
    return to;
  }

  /// Advice for a motion that ends because no step may be shorter.
  [[nodiscard]] std::string advice(const DynamicState& last, double shortest) const {
    return " No step may be shorter than " + quantity(shortest) +
           " s (TimeStep, halved MaximumHalvings times). The least det F before it is " +
           quantity(last.minimum_det_f) + " in " +
           describe_cell(scene_.body.mesh, last.minimum_det_f_cell) +
           ". Move the tools more slowly or less far, give those that hold the body a TipRadius, "
           "refine the mesh there, or allow for more halvings" +
           advise_finer_quadrature(system_.assembly()) + '.';
  }

  /// Lets go of the tools whose time has come.
  void let_go(const ToolPath& path, DynamicState& state, double instant) {
    bool any = false;
    for (Index tool = 0; tool < tools_.num_tools(); ++tool) {
      if (released_[tool] || path.release(tool) > state.motion.time + instant) continue;
      released_[tool] = any = true;
      tools_.let_go(tool, state.tools.segment<3>(3 * Eigen::Index{tool}));
      state.force.segment<3>(3 * Eigen::Index{tool}).setZero();
    }
    if (!any) return;
    system_.set_interaction(tools_);
    last_inertia_ = 0;
    factor_of_.reset();
    // The acceleration jumps, so that earlier states say nothing about the next one.
    state.motion.acceleration = acceleration_when_let_go(state.motion.acceleration);
    state.motion.step = 0;
    history_.clear();
    remember(state.motion);
  }

  /// Moves tools that were let go to the points that they held.
  void place_released(DynamicState& state) const {
    for (Index tool = 0; tool < tools_.num_tools(); ++tool) {
      const std::vector<PrescribedPoint> points = all_tools_.tool(tool).prescribed_points();
      if (!released_[tool] || points.empty()) continue;
      Vec3 sum = Vec3::Zero();
      for (const PrescribedPoint& p : points) {
        const Eigen::Index first = 3 * Eigen::Index{p.point};
        sum += state.motion.u.segment<3>(first) - rest_.segment<3>(first);
      }
      state.tools.segment<3>(3 * Eigen::Index{tool}) = sum / static_cast<double>(points.size());
    }
  }

  void set_terms() {
    std::vector<const EnergyTerm*> terms{&term_};
    if (external_) terms.push_back(&*external_);
    terms.insert(terms.end(), further_.begin(), further_.end());
    system_.set_terms(std::move(terms));
  }

  void set_load_share(double share) {
    term_.set_load_share(share);
    if (external_) external_->set_share(share);
  }

  /// Follows a ramp to where the motion begins.
  void follow(const Ramp& ramp, const char* failure, const char* advice, NodalVector& x,
              DynamicState& state) {
    const RampEnd end = follow_ramp(
        system_, options_.equilibrium, [this] { return interruption(); }, ramp, x);
    state.outcome = end.outcome;
    state.residual = end.residual;
    state.iterations += end.iterations;
    if (end.outcome == Outcome::converged) return;
    state.message = std::string(failure) + ": " + palpate::describe(end) + ". " + advice +
                    advise_finer_quadrature(system_.assembly()) + '.';
  }

  /// Finds the rest under the loads, with the tools brought to q from coordinates where they do not
  /// touch the body.
  DynamicState begin(const Eigen::VectorXd& q, const Eigen::VectorXd& clear) {
    system_.begin_solve();
    unscale();
    term_.set_inertia(0, {});
    term_.set_past({});
    term_.set_memory(nullptr);
    set_terms();
    NodalVector x = NodalVector::Zero(system_.assembly().state_size());
    DynamicState state;
    // First the body comes to rest, and then the tools come to it.
    Ramp load;
    load.at = [this](double share) {
      set_load_share(options_.settled ? share : 0);
      return Eigen::VectorXd();
    };
    system_.set_interaction(InteractionList());
    follow(load, "The body finds no rest under its loads, BodyForce and those of its surface",
           "Make them smaller or the body stiffer, or fix more of it", x, state);
    system_.set_rest(x);
    rest_ = x;
    tools_ = all_tools_;
    released_.assign(static_cast<std::size_t>(tools_.num_tools()), 0);
    system_.set_interaction(tools_);
    const Eigen::VectorXd way = q - clear;
    Ramp approach;
    // At the end, rounding must not change q.
    approach.at = [&](double share) {
      return share < 1 ? Eigen::VectorXd(clear + share * way) : q;
    };
    if (tools_.has_potential()) {
      const double longest_step = tools_.longest_step();
      while (approach.longest_increment * way.lpNorm<Eigen::Infinity>() > longest_step) {
        approach.longest_increment /= 2;
      }
    }
    if (state.outcome == Outcome::converged) {
      follow(approach, "The body finds no rest on the way of the tools to their first place",
             "Let the tools begin nearer to the body at rest, or refine the mesh there", x, state);
    }
    set_load_share(1);
    const Eigen::Index n = 3 * Eigen::Index{system_.assembly().num_points()};
    state.motion.u = x.head(n);
    state.motion.velocity = state.motion.acceleration = NodalVector::Zero(n);
    state.tools = q;
    const bool is_viscous = std::any_of(rheologies_.begin(), rheologies_.end(),
                                        [](const Rheology& of) { return of.is_viscous(); });
    viscosity_.reset();
    if (is_viscous) viscosity_.emplace(scene_, rheologies_, system_.assembly(), x);
    last_inertia_ = 0;
    history_.clear();
    largest_way_ = 0;
    last_x_ = x;
    state.p = pressures_of(x);
    state.force = Eigen::VectorXd::Zero(q.size());
    if (state.outcome == Outcome::converged) {
      measure(x, state.motion.acceleration, state);
      if (!options_.settled) {
        state.motion.acceleration = acceleration_when_let_go(state.motion.acceleration);
        measure(x, state.motion.acceleration, state);
      }
      take_determinant(x, state);
    }
    remember(state.motion);
    return state;
  }

  /// The acceleration of the body under the forces that were measured, m/s².
  /// @param before The acceleration; that of the points that tools prescribe is kept.
  [[nodiscard]] NodalVector acceleration_when_let_go(const NodalVector& before) const {
    std::vector<char> free(scene_.body.fixed.size());
    const std::vector<Index>& unknown = system_.assembly().unknown_of_point();
    for (std::size_t p = 0; p < free.size(); ++p) free[p] = unknown[p] >= 0 ? 1 : 0;
    NodalVector of_tools = NodalVector::Zero(unbalanced_.size());
    for (const auto& [point, coordinate] : system_.prescribed_points()) {
      free[point] = 0;
      of_tools.segment<3>(3 * Eigen::Index{point}) = before.segment<3>(3 * Eigen::Index{point});
    }
    const NodalVector force = -unbalanced_ - mass_.times(of_tools);
    return mass_.acceleration(force, free, scene_.body.held_directions) +
           of_tools.head(before.size());
  }

  /// Tries a step. It changes nothing but the factors that are kept.
  DynamicState step(const ToolPath& path, const DynamicState& from, double length) {
    system_.begin_solve();
    const TimeStep time(options_.integrator, options_.spectral_radius, from.motion, length);
    bool changes = time.inertia() != last_inertia_;
    term_.set_inertia(time.inertia(), time.centre());
    if (time.share_of_past() > 0) term_.set_past(time.share_of_past() * unbalanced_);
    if (viscosity_) {
      changes = viscosity_->begin_step(length, time.rate()) || changes;
      term_.set_memory(&viscosity_->memory());
    }
    if (changes) {
      last_inertia_ = time.inertia();
      set_terms();
      factor_of_.reset();
    }
    const Eigen::VectorXd q = path.at(from.motion.time + length);
    NodalVector x = last_x_;
    const NodalVector predicted = extrapolated(from.motion.time + length);
    x.head(predicted.size()) = predicted;
    system_.prescribe(q, x);
    const auto is_safe = [&] { return system_.longest_share(last_x_, x - last_x_) == 1; };
    if (!is_safe() || !system_.evaluate(q, x).is_finite()) {
      x = last_x_;
      x.head(predicted.size()) = from.motion.u;
      system_.prescribe(q, x);
      if (!is_safe()) return untried(from, length);
    }
    LinearisedState start;
    if (factor_of_) {
      start = *factor_of_;
    } else {
      start.t = q;
      start.u = x.head(predicted.size());
      start.p = pressures_of(x);
    }
    const Correction correction = correct_from(start, q, x);
    DynamicState to;
    to.outcome = correction.outcome;
    to.residual = correction.residual;
    to.iterations = correction.iterations;
    if (correction.outcome != Outcome::converged) {
      to.message = "The step of " + quantity(length, "s") + " from " + quantity(from.motion.time) +
                   (correction.outcome == Outcome::tool_inside
                        ? " s on takes a tool through the surface of the body. Make the edges of "
                          "the mesh under it at most as long as its radius, or press less deep."
                        : " s on is " + to_string(correction.outcome) + '.');
      return to;
    }
    if (correction.factor != nullptr && correction.factor_state.size() > 0) {
      factor_of_.emplace();
      take(correction.factor_t, correction.factor_state, *factor_of_);
    } else if (correction.factor != nullptr) {
      factor_of_ = std::move(start);
    }
    to.motion = time.end(x);
    to.tools = q;
    if (!to.motion.u.allFinite()) {
      to.outcome = Outcome::not_converged;
      to.message = "The step of " + quantity(length, "s") + " from " + quantity(from.motion.time) +
                   " s on has displacements that are no numbers.";
      return to;
    }
    take_determinant(x, to);
    const NodalVector difference = to.motion.u - predicted;
    to.local_error =
        kErrorShare * difference.reshaped(3, difference.size() / 3).colwise().norm().maxCoeff();
    solution_ = x;
    return to;
  }

  /// Completes a step that is accepted.
  void end_step(const DynamicState& from, DynamicState& to) {
    const double length = to.motion.step;
    const TimeStep time(options_.integrator, options_.spectral_radius, from.motion, length);
    last_x_ = solution_;
    to.p = pressures_of(last_x_);
    if (viscosity_) viscosity_->end_step(length, time.rate(), last_x_);
    measure(last_x_, time.acceleration_of(to.motion), to);
    place_released(to);
    to.energy.work = from.energy.work + 0.5 * (from.force + to.force).dot(to.tools - from.tools);
    remember(to.motion);
  }

  /// Computes the energies of a state and the force on the tools, which is that on their points.
  void measure(const NodalVector& x, const NodalVector& acceleration, DynamicState& state) {
    NodalVector force;
    Eigen::VectorXd of_tools = Eigen::VectorXd::Zero(state.tools.size());
    unscale();
    state.energy.elastic = system_.assembly().residual(x, force).energy;
    if (viscosity_) system_.assembly().scale_energy(scene_, viscosity_->factors());
    if (system_.interaction().has_potential()) {
      state.energy.elastic += system_.interaction().potential(state.tools, x, force, of_tools);
    }
    if (viscosity_) {
      (void)system_.assembly().add_memory(viscosity_->stress_now(), x, force);
      state.energy.viscous_stored = viscosity_->stored();
      state.energy.dissipated = viscosity_->work() - viscosity_->stored();
    }
    state.energy.weight = -term_.load().dot(x);
    force -= term_.load();
    if (external_) {
      const double of_springs = external_->of_springs(x);
      state.energy.elastic += of_springs;
      state.energy.weight += external_->add(x, force, nullptr) - of_springs;
    }
    for (const EnergyTerm* term : further_) state.energy.elastic += term->add(x, force, nullptr);
    unbalanced_ = force;
    force += mass_.times(acceleration);
    state.energy.kinetic =
        0.5 * state.motion.velocity.dot(
                  mass_.times(state.motion.velocity).head(state.motion.velocity.size()));
    for (const auto& [point, coordinate] : system_.prescribed_points()) {
      of_tools.segment<3>(coordinate) += force.segment<3>(3 * Eigen::Index{point});
    }
    state.force = of_tools;
  }

  void take_determinant(const NodalVector& x, DynamicState& state) const {
    LinearisedState at;
    palpate::take_determinant(system_.assembly(), x, at);
    state.minimum_det_f = at.minimum_det_f;
    state.minimum_det_f_cell = at.minimum_det_f_cell;
    state.num_inverted_cells = at.num_inverted_cells;
    state.flags = at.flags;
  }

  Correction correct_from(const LinearisedState& start, const Eigen::VectorXd& q, NodalVector& x) {
    const EquilibriumOptions& options = options_.equilibrium;
    const Interruption interruption = [&] {
      if (options.abort_requested && options.abort_requested()) return Outcome::aborted;
      if (options.max_seconds > 0 && seconds_since(start_) > options.max_seconds) {
        return Outcome::budget_used_up;
      }
      return Outcome::converged;
    };
    return system_.is_iterative() ? correct_by_iteration(system_, options, interruption, q, x)
                                  : correct(system_, options, interruption, start, q, x);
  }

  [[nodiscard]] Outcome interruption() const {
    const EquilibriumOptions& options = options_.equilibrium;
    if (options.abort_requested && options.abort_requested()) return Outcome::aborted;
    if (options.max_seconds > 0 && seconds_since(start_) > options.max_seconds) {
      return Outcome::budget_used_up;
    }
    return Outcome::converged;
  }

  void take(const Eigen::VectorXd& q, const NodalVector& x, LinearisedState& state) const {
    state.t = q;
    state.u = x.head(3 * Eigen::Index{system_.assembly().num_points()});
    state.p = pressures_of(x);
  }

  [[nodiscard]] NodalVector pressures_of(const NodalVector& x) const {
    return x.tail(system_.assembly().num_pressures()).cwiseProduct(system_.pressure_scale());
  }

  /// Removes the viscous factors: the energies of the materials are those of their laws from now
  /// on.
  void unscale() {
    if (!viscosity_) return;
    system_.assembly().scale_energy(scene_, std::vector<double>(rheologies_.size(), 1.0));
  }

  /// The allowed error of a step, m.
  [[nodiscard]] double allowed_error(const ToolPath& path, const DynamicState& to) const {
    largest_way_ = std::max(largest_way_, (to.tools - path.at(0)).lpNorm<Eigen::Infinity>());
    const double scale = system_.num_coordinates() == 0
                             ? system_.assembly().mean_edge()
                             : std::max(largest_way_, 1e-3 * system_.assembly().mean_edge());
    return options_.tolerance * scale;
  }

  [[nodiscard]] double next_length(const ToolPath& path, const DynamicState& state, double length,
                                   int& good_steps) const {
    ++good_steps;
    if (options_.tolerance == 0) {
      if (length >= options_.time_step || good_steps < kStepsBeforeDoubling) {
        return std::min(length, options_.time_step);
      }
      good_steps = 0;
      return std::min(2 * length, options_.time_step);
    }
    const double ratio =
        kSafety * std::cbrt(allowed_error(path, state) / std::max(state.local_error, 1e-300));
    // A small change is not worth a factorisation.
    const double factor = std::clamp(ratio, kShortestRatio, kLongestRatio);
    return std::min(factor < 1 || factor > 1.2 ? factor * length : length, options_.time_step);
  }

  void remember(const BodyMotion& motion) {
    history_.push_back({motion.time, motion.u});
    if (history_.size() > 3) history_.erase(history_.begin());
  }

  /// The polynomial through the last states, evaluated at a time.
  [[nodiscard]] NodalVector extrapolated(double time) const {
    NodalVector sum = NodalVector::Zero(history_.back().u.size());
    for (std::size_t i = 0; i < history_.size(); ++i) {
      double weight = 1;
      for (std::size_t j = 0; j < history_.size(); ++j) {
        if (j == i) continue;
        weight *= (time - history_[j].time) / (history_[i].time - history_[j].time);
      }
      sum += weight * history_[i].u;
    }
    return sum;
  }

  struct Past {
    double time;
    NodalVector u;
  };

  Scene scene_;
  std::vector<Rheology> rheologies_;
  DynamicsOptions options_;
  /// All tools, and those that hold the body now.
  InteractionList all_tools_;
  InteractionList tools_;
  /// Whether each tool was let go.
  std::vector<char> released_;
  std::unique_ptr<Team> team_;
  /// The contact of the parts with each other; null: they have none.
  std::unique_ptr<const SoftContact> contact_;
  /// That contact, and energy terms that do not follow from the scene.
  std::vector<const EnergyTerm*> further_;
  CondensedSystem system_;
  MassMatrix mass_;
  StepTerm term_;
  /// Supports, and loads other than gravity; empty: there are none.
  std::optional<ExternalEnergy> external_;
  std::optional<Viscosity> viscosity_;
  /// The state of rest in which the motion begins [state_size].
  NodalVector rest_;
  double last_inertia_ = 0;
  std::vector<Past> history_;
  /// The forces at the end of the last step without inertia, N [state_size].
  NodalVector unbalanced_;
  /// The state at the end of the last step, and the solution of the step that was tried last.
  NodalVector last_x_;
  NodalVector solution_;
  /// The tool and the state of the last factor.
  std::optional<LinearisedState> factor_of_;
  mutable double largest_way_ = 0;
  /// Start of the run.
  SteadyClock::time_point start_{};
};

DynamicSolver::DynamicSolver(const Scene& scene, const std::vector<Rheology>& rheologies,
                             const Interaction& tools, DynamicsOptions options,
                             std::unique_ptr<LinearSolver> linear_solver,
                             const std::vector<const EnergyTerm*>& terms) {
  validate(options);
  Scene checked_scene = scene;
  check(checked_scene);
  impl_ = std::make_unique<Impl>(checked_scene, rheologies, tools, std::move(options),
                                 std::move(linear_solver), terms);
}
DynamicSolver::~DynamicSolver() = default;
DynamicSolver::DynamicSolver(DynamicSolver&&) noexcept = default;
DynamicSolver& DynamicSolver::operator=(DynamicSolver&&) noexcept = default;

const Work& DynamicSolver::work() const { return impl_->work(); }

DynamicState DynamicSolver::run(const ToolPath& path, double until, const TakeState& take,
                                const Eigen::VectorXd& clear) {
  return with_team(impl_->team(), [&] { return impl_->run(path, until, take, clear); });
}

}  // namespace palpate
