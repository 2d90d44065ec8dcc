// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/equilibrium.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <utility>

#include "base/error.h"

namespace palpate {
namespace {

/// Sufficient decrease of the energy, as usual (Nocedal & Wright, 3.4).
constexpr double kSufficientDecrease = 1e-4;
/// Energies that differ by less than this share are equal but for rounding; the residual decides.
constexpr double kEnergyRounding = 1e-11;
constexpr int kMaxBacktracks = 15;
/// A factor is not judged by how the residual shrinks before this many iterations.
constexpr int kIterationsBeforeJudging = 6;
/// The force scale does not fall below that of a displacement of this share of the mean edge.
constexpr double kLeastDisplacement = 1e-3;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Adds the time of its scope to a sum.
class Timer {
 public:
  explicit Timer(double& sum) : sum_(sum), start_(Clock::now()) {}
  ~Timer() { sum_ += seconds_since(start_); }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  double& sum_;
  Clock::time_point start_;
};

std::string describe(const Vec3& p) {
  std::ostringstream text;
  text << '(' << p.x() << ", " << p.y() << ", " << p.z() << ") m";
  return text.str();
}

/// Approximates K⁻¹ by a factor and the last steps: limited-memory BFGS (Nocedal & Wright,
/// algorithm 7.4) whose initial matrix is the inverse of the tangent elsewhere (Matthies & Strang,
/// 1979). Each update costs a few products of vectors, a factorisation as much as thirty solves.
class QuasiNewton {
 public:
  using Solve = std::function<void(Eigen::Ref<Eigen::MatrixXd>)>;

  void clear() { pairs_.clear(); }

  /// @param step Change of the unknowns. @param change Change of the residual.
  void update(Eigen::VectorXd step, Eigen::VectorXd change) {
    const double curvature = step.dot(change);
    // Only a pair of positive curvature keeps the approximation positive definite.
    if (curvature <= kLeastCurvature * step.norm() * change.norm()) return;
    if (pairs_.size() == kMaxPairs) pairs_.erase(pairs_.begin());
    pairs_.push_back({std::move(step), std::move(change), 1 / curvature});
  }

  /// −K⁻¹ r, approximately.
  [[nodiscard]] Eigen::VectorXd direction(const Eigen::VectorXd& r, const Solve& solve) const {
    Eigen::VectorXd d = -r;
    std::vector<double> alpha(pairs_.size());
    for (std::size_t i = pairs_.size(); i-- > 0;) {
      alpha[i] = pairs_[i].inverse_curvature * pairs_[i].step.dot(d);
      d -= alpha[i] * pairs_[i].change;
    }
    solve(d);
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const double beta = pairs_[i].inverse_curvature * pairs_[i].change.dot(d);
      d += (alpha[i] - beta) * pairs_[i].step;
    }
    return d;
  }

 private:
  static constexpr std::size_t kMaxPairs = 20;
  static constexpr double kLeastCurvature = 1e-8;
  struct Pair {
    Eigen::VectorXd step;
    Eigen::VectorXd change;
    double inverse_curvature;
  };
  std::vector<Pair> pairs_;
};

}  // namespace

Constraint hold_nodes(const std::vector<Index>& nodes) {
  Constraint constraint;
  constraint.points = nodes;
  for (Index i = 0; i < static_cast<Index>(nodes.size()); ++i) constraint.site_of_point.push_back(i);
  constraint.num_sites = static_cast<Index>(nodes.size());
  return constraint;
}

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
}

double Work::floor_seconds() const {
  if (assemblies == 0 || factorisations == 0 || right_hand_sides == 0) return 0;
  return assembly_seconds / static_cast<double>(assemblies) +
         factorisation_seconds / static_cast<double>(factorisations) +
         3 * solve_seconds / static_cast<double>(right_hand_sides);
}

Work& Work::operator+=(const Work& other) {
  residuals += other.residuals;
  assemblies += other.assemblies;
  analyses += other.analyses;
  factorisations += other.factorisations;
  right_hand_sides += other.right_hand_sides;
  residual_seconds += other.residual_seconds;
  assembly_seconds += other.assembly_seconds;
  analysis_seconds += other.analysis_seconds;
  factorisation_seconds += other.factorisation_seconds;
  solve_seconds += other.solve_seconds;
  return *this;
}

class EquilibriumSolver::Impl {
 public:
  Impl(const Scene& scene, EquilibriumOptions options, std::unique_ptr<LinearSolver> solver)
      : options_(std::move(options)),
        points_(scene.mesh.points),
        assembly_(checked_assembly(scene)),
        work_{std::move(solver), {}} {
    validate(options_);
    const SymmetricPattern& pattern = assembly_.pattern();
    {
      const Timer timer(spent_.analysis_seconds);
      work_.solver->analyse(pattern);
    }
    ++spent_.analyses;
    assemble(NodalVector::Zero(3 * assembly_.num_points()));
    double sum = 0;
    for (Index c = 0; c < pattern.size; ++c) sum += values_[pattern.column_start[c]];
    mean_diagonal_ = sum / pattern.size;
  }

  void hold(const Constraint& constraint);
  Equilibrium rest();
  Equilibrium solve(const Eigen::VectorXd& t, const Equilibrium& start);

  const Assembly& assembly() const { return assembly_; }
  const Work& work() const { return spent_; }

 private:
  /// A factor, and the displacement whose tangent it is of; empty: none.
  struct Factor {
    std::unique_ptr<LinearSolver> solver;
    NodalVector u;

    [[nodiscard]] bool is_of(const NodalVector& other) const {
      return u.size() == other.size() && u == other;
    }
  };

  enum class Search { full_step, shortened, failed };

  /// A value of the pattern that couples an unknown that is held with one that is not.
  struct Coupling {
    Index position;
    Index unknown;
    Index parameter;
  };
  /// A value of the pattern between two unknowns that are held.
  struct Held {
    Index position;
    Index parameter_a;
    Index parameter_b;
    bool diagonal;
  };

  static Assembly checked_assembly(Scene scene) {
    check(scene);
    return Assembly(scene);
  }

  Assembly::Result evaluate(const NodalVector& u);
  void assemble(const NodalVector& u);
  FactorStatus factorise(const NodalVector& u, Factor& factor);
  void solve_linear(Factor& factor, Eigen::Ref<Eigen::MatrixXd> columns);
  /// A factor of the tangent at the start of a step; null where that is singular.
  Factor* factor_at_start(const Equilibrium& start);

  /// The residual's components that must vanish, by unknown; zero for those that are held.
  void gather_residual(Eigen::VectorXd& r) const;
  void place_sites(const Eigen::VectorXd& t, NodalVector& u) const;
  [[nodiscard]] double force_scale(const Eigen::VectorXd& t) const;

  /// Newton from u, whose sites are at t already, to equilibrium.
  Outcome correct(const Equilibrium& start, Equilibrium& state);
  /// Moves u along `step` as far as the energy falls; r and the energy follow.
  Search search(const Eigen::VectorXd& step, double slope, NodalVector& u, Eigen::VectorXd& r,
                double& energy, double& length);
  /// v, k, reaction, inertia and det F at an equilibrium.
  Outcome complete(Equilibrium& state);
  [[nodiscard]] Outcome interruption() const;
  void explain(Equilibrium& state, const Eigen::VectorXd& target, double way) const;

  EquilibriumOptions options_;
  std::vector<Vec3> points_;
  Assembly assembly_;
  /// Of the start of the present step, which many steps may share.
  Factor at_start_;
  /// Of where the present step is, in the end of its solution.
  Factor work_;
  Work spent_;
  double mean_diagonal_ = 0;

  Constraint constraint_;
  /// Parameter of each unknown, −1 for those that are not held.
  std::vector<Index> parameter_of_unknown_;
  std::vector<Coupling> couplings_;
  std::vector<Held> held_;

  /// Internal force of the last evaluation.
  NodalVector force_;
  /// Tangent of the last assembly, rows and columns of held unknowns replaced by the identity.
  std::vector<double> values_;
  Eigen::MatrixXd k_ia_;
  Eigen::MatrixXd k_aa_;
  /// The factor is that of a linear scene with the present constraint: good for every u.
  bool factor_for_good_ = false;
  Clock::time_point start_{};
};

void EquilibriumSolver::Impl::hold(const Constraint& constraint) {
  const auto& unknown_of_point = assembly_.unknown_of_point();
  std::vector<Index> parameters(assembly_.pattern().size, -1);
  if (constraint.points.empty()) {
    throw InputError("No active node was given. Name a point that is not fixed.");
  }
  const auto& sites = constraint.site_of_point;
  if (sites.size() != constraint.points.size() ||
      std::any_of(sites.begin(), sites.end(),
                  [&](Index site) { return site < 0 || site >= constraint.num_sites; })) {
    throw InputError("A constraint needs one site of 0 … num_sites − 1 for each of its points.");
  }
  for (std::size_t i = 0; i < constraint.points.size(); ++i) {
    const Index point = constraint.points[i];
    if (point < 0 || point >= assembly_.num_points()) {
      throw InputError("Active node " + std::to_string(point) + " does not exist: the body has " +
                       std::to_string(assembly_.num_points()) + " points, counted from 0.");
    }
    const Index unknown = unknown_of_point[point];
    if (unknown < 0) {
      throw InputError("Active node " + std::to_string(point) + " at " + describe(points_[point]) +
                       " is fixed or belongs to no cell, so it cannot be moved. Choose another.");
    }
    if (parameters[unknown] >= 0) {
      throw InputError("Active node " + std::to_string(point) + " is named twice.");
    }
    for (int c = 0; c < 3; ++c) parameters[unknown + c] = 3 * constraint.site_of_point[i] + c;
  }
  constraint_ = constraint;
  parameter_of_unknown_ = std::move(parameters);
  couplings_.clear();
  held_.clear();
  factor_for_good_ = false;
  at_start_.u.resize(0);
  work_.u.resize(0);
  const SymmetricPattern& pattern = assembly_.pattern();
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      const Index row = pattern.row[i];
      const Index of_row = parameter_of_unknown_[row];
      const Index of_column = parameter_of_unknown_[c];
      if (of_row >= 0 && of_column >= 0) {
        held_.push_back({i, of_row, of_column, row == c});
      } else if (of_row >= 0) {
        couplings_.push_back({i, c, of_row});
      } else if (of_column >= 0) {
        couplings_.push_back({i, row, of_column});
      }
    }
  }
}

Assembly::Result EquilibriumSolver::Impl::evaluate(const NodalVector& u) {
  const Timer timer(spent_.residual_seconds);
  ++spent_.residuals;
  return assembly_.residual(u, force_);
}

void EquilibriumSolver::Impl::assemble(const NodalVector& u) {
  const Timer timer(spent_.assembly_seconds);
  ++spent_.assemblies;
  assembly_.tangent(u, force_, values_);
}

FactorStatus EquilibriumSolver::Impl::factorise(const NodalVector& u, Factor& factor) {
  if (factor_for_good_) return FactorStatus::ok;
  factor.u.resize(0);
  assemble(u);
  const Index d = 3 * constraint_.num_sites;
  k_ia_.setZero(assembly_.pattern().size, d);
  k_aa_.setZero(d, d);
  for (const Coupling& c : couplings_) {
    k_ia_(c.unknown, c.parameter) += std::exchange(values_[c.position], 0.0);
  }
  for (const Held& h : held_) {
    const double value = std::exchange(values_[h.position], h.diagonal ? mean_diagonal_ : 0.0);
    k_aa_(h.parameter_a, h.parameter_b) += value;
    if (!h.diagonal) k_aa_(h.parameter_b, h.parameter_a) += value;
  }
  const Timer timer(spent_.factorisation_seconds);
  ++spent_.factorisations;
  const FactorStatus status = factor.solver->factorise(values_);
  if (status == FactorStatus::ok) factor.u = u;
  factor_for_good_ = status == FactorStatus::ok && assembly_.is_linear();
  return status;
}

EquilibriumSolver::Impl::Factor* EquilibriumSolver::Impl::factor_at_start(
    const Equilibrium& start) {
  if (assembly_.is_linear()) {
    return factorise(start.u, work_) == FactorStatus::ok ? &work_ : nullptr;
  }
  if (at_start_.is_of(start.u)) return &at_start_;
  // Often a step starts where the last one ended.
  std::swap(at_start_, work_);
  if (work_.solver == nullptr) {
    work_.solver = make_linear_solver(at_start_.solver->name());
    const Timer timer(spent_.analysis_seconds);
    ++spent_.analyses;
    work_.solver->analyse(assembly_.pattern());
  }
  if (at_start_.is_of(start.u)) return &at_start_;
  return factorise(start.u, at_start_) == FactorStatus::ok ? &at_start_ : nullptr;
}

void EquilibriumSolver::Impl::solve_linear(Factor& factor, Eigen::Ref<Eigen::MatrixXd> columns) {
  const Timer timer(spent_.solve_seconds);
  spent_.right_hand_sides += columns.cols();
  factor.solver->solve(columns);
}

void EquilibriumSolver::Impl::gather_residual(Eigen::VectorXd& r) const {
  r.setZero(assembly_.pattern().size);
  const auto& unknown_of_point = assembly_.unknown_of_point();
  for (Index p = 0; p < assembly_.num_points(); ++p) {
    const Index unknown = unknown_of_point[p];
    if (unknown >= 0 && parameter_of_unknown_[unknown] < 0) {
      r.segment<3>(unknown) = force_.segment<3>(3 * p);
    }
  }
}

void EquilibriumSolver::Impl::place_sites(const Eigen::VectorXd& t, NodalVector& u) const {
  for (std::size_t i = 0; i < constraint_.points.size(); ++i) {
    u.segment<3>(3 * constraint_.points[i]) = t.segment<3>(3 * constraint_.site_of_point[i]);
  }
}

double EquilibriumSolver::Impl::force_scale(const Eigen::VectorXd& t) const {
  return mean_diagonal_ * std::max(t.lpNorm<Eigen::Infinity>(),
                                   kLeastDisplacement * assembly_.mean_edge());
}

Outcome EquilibriumSolver::Impl::interruption() const {
  if (options_.abort_requested && options_.abort_requested()) return Outcome::aborted;
  if (options_.max_seconds > 0 && seconds_since(start_) > options_.max_seconds) {
    return Outcome::budget_used_up;
  }
  return Outcome::converged;
}

EquilibriumSolver::Impl::Search EquilibriumSolver::Impl::search(const Eigen::VectorXd& step,
                                                                double slope, NodalVector& u,
                                                                Eigen::VectorXd& r,
                                                                double& energy, double& length) {
  const auto& unknown_of_point = assembly_.unknown_of_point();
  const double old_norm = r.lpNorm<Eigen::Infinity>();
  NodalVector direction = NodalVector::Zero(u.size());
  for (Index p = 0; p < assembly_.num_points(); ++p) {
    if (unknown_of_point[p] >= 0) {
      direction.segment<3>(3 * p) = step.segment<3>(unknown_of_point[p]);
    }
  }
  NodalVector trial;
  Eigen::VectorXd trial_r;
  length = 1;
  for (int i = 0; i < kMaxBacktracks; ++i) {
    trial = u + length * direction;
    const double trial_energy = evaluate(trial).energy;
    if (!std::isfinite(trial_energy)) {
      length *= 0.25;
      continue;
    }
    gather_residual(trial_r);
    const double change = trial_energy - energy;
    const bool decreases = change <= kSufficientDecrease * length * slope;
    const bool level =
        std::abs(change) <= kEnergyRounding * (std::abs(energy) + std::abs(trial_energy));
    if (decreases || (level && trial_r.lpNorm<Eigen::Infinity>() < old_norm)) {
      u.swap(trial);
      r.swap(trial_r);
      energy = trial_energy;
      return i == 0 ? Search::full_step : Search::shortened;
    }
    // Minimum of the parabola through the energy, its slope and the trial energy.
    const double best = -slope * length * length / (2 * (change - slope * length));
    length = std::clamp(best, 0.1 * length, 0.5 * length);
  }
  return Search::failed;
}

Outcome EquilibriumSolver::Impl::correct(const Equilibrium& start, Equilibrium& state) {
  const double scale = force_scale(state.t);
  Eigen::VectorXd r;
  double energy = evaluate(state.u).energy;
  gather_residual(r);
  if (!std::isfinite(energy)) return Outcome::not_converged;  // the predictor inverts a cell
  Factor* factor = nullptr;
  QuasiNewton quasi_newton;
  bool fresh = false;        // the factor is of the tangent at state.u
  bool refactorise = false;  // the factor does not serve any more
  double norm_at_factor = 0;
  int since_factor = 0;
  for (int iteration = 0;; ++iteration) {
    const double norm = r.lpNorm<Eigen::Infinity>();
    state.residual = norm / scale;
    state.energy = energy;
    if (!std::isfinite(norm)) return Outcome::not_converged;
    if (norm <= options_.tolerance * scale) return Outcome::converged;
    if (iteration == options_.max_iterations) return Outcome::not_converged;
    const Outcome interrupted = interruption();
    if (interrupted != Outcome::converged) return interrupted;

    if (factor == nullptr) {
      factor = factor_at_start(start);
      refactorise = factor == nullptr;
      norm_at_factor = norm;
    }
    if (refactorise) {
      if (factorise(state.u, work_) != FactorStatus::ok) return Outcome::tangent_not_factorised;
      factor = &work_;
      quasi_newton.clear();
      fresh = true;
      refactorise = false;
      norm_at_factor = norm;
      since_factor = 0;
    }
    ++state.iterations;
    ++since_factor;
    Eigen::VectorXd step =
        quasi_newton.direction(r, [&](auto columns) { solve_linear(*factor, columns); });
    double slope = step.dot(r);
    if (slope > 0) {
      // The tangent is indefinite: along the opposite direction the energy falls.
      step = -step;
      slope = -slope;
    }
    const Eigen::VectorXd old_r = r;
    double length = 0;
    const Search result = search(step, slope, state.u, r, energy, length);
    if (result == Search::failed) {
      if (fresh) return Outcome::not_converged;
      refactorise = true;
    } else {
      quasi_newton.update(length * step, r - old_r);
      const double mean_contraction =
          std::pow(r.lpNorm<Eigen::Infinity>() / norm_at_factor, 1.0 / since_factor);
      refactorise = since_factor >= kIterationsBeforeJudging &&
                    mean_contraction > options_.contraction;
    }
    fresh = false;
  }
}

Outcome EquilibriumSolver::Impl::complete(Equilibrium& state) {
  if (factorise(state.u, work_) != FactorStatus::ok) return Outcome::tangent_not_factorised;
  Eigen::MatrixXd v_i = -k_ia_;
  solve_linear(work_, v_i);
  state.stiffness = k_aa_ + k_ia_.transpose() * v_i;
  state.stiffness = 0.5 * (state.stiffness + state.stiffness.transpose()).eval();

  const Index d = 3 * constraint_.num_sites;
  const auto& unknown_of_point = assembly_.unknown_of_point();
  state.v.setZero(3 * assembly_.num_points(), d);
  for (Index p = 0; p < assembly_.num_points(); ++p) {
    if (unknown_of_point[p] >= 0) {
      state.v.middleRows<3>(3 * p) = v_i.middleRows<3>(unknown_of_point[p]);
    }
  }
  state.reaction.setZero(d);
  state.energy = evaluate(state.u).energy;
  for (std::size_t i = 0; i < constraint_.points.size(); ++i) {
    const Index point = constraint_.points[i];
    const Index site = constraint_.site_of_point[i];
    state.v.block<3, 3>(3 * point, 3 * site).setIdentity();
    state.reaction.segment<3>(3 * site) += force_.segment<3>(3 * point);
  }
  if (!state.v.allFinite() || !state.stiffness.allFinite()) return Outcome::tangent_not_factorised;

  state.negative_pivots = work_.solver->negative_pivots();
  const Assembly::Determinant least = assembly_.minimum_det_f(state.u);
  state.minimum_det_f = least.value;
  state.minimum_det_f_cell = least.cell;
  state.num_inverted_cells = least.num_inverted_cells;
  state.flags = 0;
  if (least.value <= 0) state.flags |= flags::inverted;
  if (state.negative_pivots > 0) state.flags |= flags::unstable;
  return Outcome::converged;
}

Equilibrium EquilibriumSolver::Impl::rest() {
  start_ = Clock::now();
  if (constraint_.num_sites == 0) throw InputError("No active node was chosen.");
  Equilibrium state;
  state.t.setZero(3 * constraint_.num_sites);
  state.u.setZero(3 * assembly_.num_points());
  state.v.setZero(state.u.size(), state.t.size());
  state.reaction.setZero(state.t.size());
  state.stiffness.setZero(state.t.size(), state.t.size());
  state.outcome = complete(state);
  state.seconds = seconds_since(start_);
  if (state.outcome != Outcome::converged) {
    state.message = "The tangent of the body at rest is singular: a part of it is not held. Fix "
                    "points of every connected piece.";
  }
  return state;
}

Equilibrium EquilibriumSolver::Impl::solve(const Eigen::VectorXd& t, const Equilibrium& start) {
  start_ = Clock::now();
  if (t.size() != 3 * constraint_.num_sites) {
    throw InputError("A displacement of " + std::to_string(3 * constraint_.num_sites) +
                     " components is needed, three for each active node; " +
                     std::to_string(t.size()) + " were given.");
  }
  if (!t.allFinite()) throw InputError("The displacement is not finite.");
  if (start.outcome != Outcome::converged) return start;
  Equilibrium state = start;
  state.iterations = state.steps = 0;

  double way = 0;  // from start.t to t
  double stride = 1;
  Outcome failure = Outcome::converged;
  const double least_stride = std::ldexp(1.0, -options_.max_halvings);
  while (way < 1) {
    if (state.steps == options_.max_steps) {
      failure = Outcome::budget_used_up;
      break;
    }
    const double next_way = std::min(1.0, way + stride);
    Equilibrium next = state;
    next.t = next_way < 1 ? Eigen::VectorXd(start.t + next_way * (t - start.t)) : t;
    next.u += state.v * (next.t - state.t);
    place_sites(next.t, next.u);
    ++next.steps;
    Outcome outcome = correct(state, next);
    if (outcome == Outcome::converged) outcome = complete(next);
    if (outcome == Outcome::converged) {
      state = std::move(next);
      way = next_way;
      stride = std::min(2 * stride, 1.0);
      continue;
    }
    state.iterations = next.iterations;
    state.steps = next.steps;
    failure = outcome;
    const bool hopeless = outcome == Outcome::aborted || outcome == Outcome::budget_used_up;
    stride = 0.5 * (next_way - way);
    if (hopeless || stride < least_stride) break;
  }
  state.outcome = way < 1 ? failure : Outcome::converged;
  state.seconds = seconds_since(start_);
  explain(state, t, way);
  return state;
}

void EquilibriumSolver::Impl::explain(Equilibrium& state, const Eigen::VectorXd& target,
                                      double way) const {
  std::ostringstream text;
  if (state.outcome != Outcome::converged) {
    text << "Stopped at " << std::lround(100 * way) << " % of the way to a displacement of "
         << target.norm() << " m (" << to_string(state.outcome) << ", " << state.iterations
         << " iterations in " << state.steps << " steps). ";
  }
  if ((state.flags & flags::inverted) != 0) {
    const Index corner = state.minimum_det_f_cell;
    text << state.num_inverted_cells << " cells are inverted, the worst is cell " << corner
         << " with det F = " << state.minimum_det_f
         << ". Displace less or refine the mesh there. ";
  } else if (state.outcome == Outcome::not_converged && way > 0) {
    text << "The least det F is " << state.minimum_det_f << " in cell "
         << state.minimum_det_f_cell << ". Displace less or refine the mesh there. ";
  }
  if ((state.flags & flags::unstable) != 0) {
    text << "The equilibrium is not stable (" << state.negative_pivots << " negative pivots). ";
  }
  state.message = text.str();
  if (!state.message.empty()) state.message.pop_back();
}

EquilibriumSolver::EquilibriumSolver(const Scene& scene, EquilibriumOptions options,
                                     std::unique_ptr<LinearSolver> linear_solver)
    : impl_(std::make_unique<Impl>(scene, std::move(options), std::move(linear_solver))) {}
EquilibriumSolver::~EquilibriumSolver() = default;
EquilibriumSolver::EquilibriumSolver(EquilibriumSolver&&) noexcept = default;
EquilibriumSolver& EquilibriumSolver::operator=(EquilibriumSolver&&) noexcept = default;

const Assembly& EquilibriumSolver::assembly() const { return impl_->assembly(); }
const Work& EquilibriumSolver::work() const { return impl_->work(); }
void EquilibriumSolver::hold(const Constraint& constraint) { impl_->hold(constraint); }
Equilibrium EquilibriumSolver::rest() { return impl_->rest(); }
Equilibrium EquilibriumSolver::solve(const Eigen::VectorXd& t, const Equilibrium& start) {
  return impl_->solve(t, start);
}

}  // namespace palpate
