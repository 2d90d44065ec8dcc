// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/tool_places.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/external_energy.h"
#include "assembly/mass.h"
#include "assembly/piece_support.h"
#include "assembly/supports.h"
#include "base/error.h"
#include "base/quantity.h"
#include "dynamics/dynamic_solver.h"
#include "equilibrium/direction_constraints.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction_list.h"
#include "linear/linear_solver.h"
#include "reduction/hyper_reduction.h"
#include "reduction/random_path.h"
#include "reduction/reduced_basis.h"
#include "reduction/training.h"

namespace palpate {
namespace {

/// The share of the training modes for equilibria, if there is motion too.
constexpr double kStillShare = 0.3;
/// The largest shares of a model's modes: for the terms of higher order at rest without motion, and
/// with motion; for the linear response to motion; and for the terms of higher order in motion. The
/// remaining modes come from training.
constexpr double kTermsShare = 0.4;
constexpr double kTermsShareInMotion = 0.12;
constexpr double kLinearShare = 0.2;
constexpr double kMotionShare = 0.25;
/// The number of displacements in motion for which terms of higher order are computed.
constexpr Eigen::Index kMovingTerms = 300;
/// ε of expand(): what is left out is a share ε² of a term, and rounding a share of 1e-4.
constexpr double kExpansion = 0.02;
/// The number of terms of the response to motion, for each coordinate of a tool.
constexpr int kInertialOrders = 6;
/// The largest number of modes for the states of one place and group.
constexpr Eigen::Index kModesOfPlace = 150;
/// Relative bounds below which the displacement of a tool, and the square of all modes, are
/// rounding.
constexpr double kMoves = 1e-12;
/// The number of training states by which the points of a model are chosen.
constexpr Eigen::Index kMostStates = 150;

InteractionList as_list(const std::vector<BondedPatch>& tools) {
  InteractionList list;
  for (const BondedPatch& tool : tools) list.add(tool);
  return list;
}

/// The root of the sum of c cᵀ over the columns c of a matrix. Its own columns have the same sum.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& columns) {
  // A body of the linear law has no modes at rest, and Eigen has no eigenvalues of an empty matrix.
  if (columns.rows() == 0) return columns.leftCols(0);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> energies(columns * columns.transpose());
  return energies.eigenvectors() * energies.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
         energies.eigenvectors().transpose();
}

/// @throws InputError the training is of a body with another rest.
void require_same_rest(const Scene& scene, const TrainedPlaces& trained,
                       const ReductionOptions& options) {
  const bool has_load = scene.has_load() || !options.gravity.isZero(0);
  if (has_load == (trained.rest.size() > 0)) return;
  throw InputError(std::string("The training at places is of a body ") +
                   (trained.rest.size() == 0 ? "without" : "with") +
                   " a BodyForce, and the tools are to be attached to one " +
                   (trained.rest.size() == 0 ? "with" : "without") +
                   " it. Train at the places with the BodyForce of the model.");
}

/// The states of one group at all places. The states of each place are stored in modes of their
/// own, so that not all states are in memory, and the eigenvalue problem does not grow with their
/// number.
class GroupOfPlaces {
 public:
  /// @param rest u_r; empty: there is no gravity.
  /// @param states They are empty afterwards.
  /// @param responses L of the place.
  void add(const RestStiffness& stiffness, const NodalVector& rest, TrainingStates& states,
           const Eigen::MatrixXd& responses) {
    num_left_out_ += states.num_left_out;
    if (states.tools.cols() == 0) return;
    states.u -= responses * states.tools;
    if (rest.size() > 0) states.u.colwise() -= rest;
    ModeBuilder of_place(stiffness, states.u.rows());
    of_place.add(states.u, kModesOfPlace);
    parts_.push_back({of_place.modes(), of_place.coordinates(states.u), states.tools});
    states = {};
  }

  [[nodiscard]] bool empty() const { return parts_.empty(); }
  [[nodiscard]] int num_left_out() const { return num_left_out_; }

  /// Fields whose POD modes are those of the states.
  [[nodiscard]] Eigen::MatrixXd fields() const {
    Eigen::MatrixXd all(parts_.front().modes.rows(), 0);
    for (const Part& part : parts_) {
      all = side_by_side(all, part.modes * root_of(part.coordinates));
    }
    return all;
  }
  /// Appends the coordinates of the states in the modes of a builder, and those of the tools.
  void append_to(TrainedPlaces& trained, const ModeBuilder& builder) const {
    for (const Part& part : parts_) {
      trained.states =
          side_by_side(trained.states, builder.coordinates(part.modes) * part.coordinates);
      trained.tools = side_by_side(trained.tools, part.tools);
    }
  }

 private:
  struct Part {
    Eigen::MatrixXd modes;
    Eigen::MatrixXd coordinates;
    Eigen::MatrixXd tools;
  };

  std::vector<Part> parts_;
  int num_left_out_ = 0;
};

void check_places(const std::vector<std::vector<BondedPatch>>& places) {
  if (places.empty()) {
    throw InputError("A reduced model needs a place of training. Give at least one.");
  }
  for (std::size_t place = 0; place < places.size(); ++place) {
    if (!places[place].empty() && places[place].size() == places.front().size()) continue;
    throw InputError("Place " + std::to_string(place) + " of training has " +
                     std::to_string(places[place].size()) + " tools, and place 0 has " +
                     std::to_string(places.front().size()) +
                     ". Give each place as many, at least one.");
  }
}

/// Makes Ψ from the states of all places, and expresses the states in it.
TrainedPlaces modes_of_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                              const std::vector<std::vector<BondedPatch>>& places,
                              const ReductionOptions& options,
                              std::vector<TrainingGroups>& groups) {
  // This takes one factorisation, and a few under gravity, so nobody needs to abort it.
  EquilibriumOptions of_rest = options.equilibrium;
  of_rest.abort_requested = nullptr;
  EquilibriumSolver solver(with_gravity(scene, rheologies, options.gravity), of_rest);
  require_rest(solver);
  const NodalVector rest = solver.settled().u;
  const std::optional<PointMatrix> springs = springs_of(scene.body, solver.assembly());
  const RestStiffness stiffness(solver.assembly(), rest, springs ? &*springs : nullptr);
  GroupOfPlaces still;
  GroupOfPlaces moving;
  for (std::size_t place = 0; place < places.size(); ++place) {
    solver.set_interaction(as_list(places[place]));
    const Eigen::MatrixXd responses = solver.rest().v;
    TrainingGroups& of_place = groups[place];
    of_place.one_tool.append(of_place.all_tools);
    still.add(stiffness, rest, of_place.one_tool, responses);
    moving.add(stiffness, rest, of_place.moving, responses);
    of_place = {};
  }
  if (still.empty() && moving.empty()) {
    throw InputError("At none of the " + std::to_string(places.size()) +
                     " places of training does the body follow the tools. Let them go less far "
                     "(Reach).");
  }
  const Eigen::Index rows = 3 * Eigen::Index{scene.body.mesh.num_points()};
  const auto most = Eigen::Index{options.place_modes} * static_cast<Eigen::Index>(places.size());
  ModeBuilder builder(stiffness, rows);
  const double share = moving.empty() ? 1 : kStillShare;
  if (!still.empty()) {
    builder.add(still.fields(), std::lround(share * static_cast<double>(most)));
  }
  if (!moving.empty()) builder.add(moving.fields(), most - builder.modes().cols());
  TrainedPlaces trained;
  trained.modes = builder.modes();
  trained.rest = rest;
  trained.reach = options.reach;
  trained.states.resize(builder.modes().cols(), 0);
  trained.tools.resize(3 * static_cast<Eigen::Index>(places.front().size()), 0);
  still.append_to(trained, builder);
  moving.append_to(trained, builder);
  trained.num_left_out = still.num_left_out() + moving.num_left_out();
  return trained;
}

/// @throws InputError the sizes in the training do not fit the scene.
const TrainedPlaces& of_scene(const TrainedPlaces& trained, const Scene& scene) {
  const Eigen::Index rows = 3 * Eigen::Index{scene.body.mesh.num_points()};
  if (trained.modes.rows() != rows || trained.states.rows() != trained.modes.cols() ||
      trained.tools.cols() != trained.states.cols() ||
      (trained.rest.size() > 0 && trained.rest.size() != rows)) {
    throw InputError(
        "The places of training are of another body: their modes have " +
        std::to_string(trained.modes.rows()) + " rows in place of " + std::to_string(rows) +
        ", or their arrays do not belong together. Train with the scene that is given.");
  }
  return trained;
}

}  // namespace

TrainedPlaces train_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                           const std::vector<std::vector<BondedPatch>>& places,
                           const ReductionOptions& options) {
  const auto alone = make_serial_communicator();
  return train_places(scene, rheologies, places, options, {*alone, nullptr, {}});
}

TrainedPlaces train_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                           const std::vector<std::vector<BondedPatch>>& places,
                           const ReductionOptions& options, const TrainingRun& run) {
  TrainedPlaces trained;
  agree(run.communicator, [&] {
    check_reduction(scene, rheologies, options);
    check_places(places);
    Scene checked = scene;
    check(checked);
    std::vector<TrainingGroups> groups;
    trained.aborted = !train_with_tools(checked, rheologies, places, options, run, groups);
    if (trained.aborted || run.communicator.rank() != 0) return;
    if (options.report) options.report("Modes");
    trained = modes_of_places(checked, rheologies, places, options, groups);
  });
  return trained;
}

class PlacedTools::Impl {
 public:
  Impl(const Scene& scene, const std::vector<Rheology>& rheologies, const TrainedPlaces& trained)
      : scene_(scene),
        rheologies_(rheologies),
        trained_(of_scene(trained, scene)),
        assembly_(scene),
        constraints_(scene.body, assembly_),
        springs_(springs_of(scene.body, assembly_)),
        points_(scene, trained.rest),
        stiffness_(assembly_, trained.rest, springs_ ? &*springs_ : nullptr) {
    rest_state_.setZero(assembly_.state_size());
    if (trained.rest.size() > 0) rest_state_.head(trained.rest.size()) = trained.rest;
    PieceSupport(scene).require_held({});
    std::vector<double> values;
    (void)assembly_.tangent(rest_state_, rest_force_, values);
    if (springs_) springs_->add_to(1, values);
    constraints_.measure(values);
    constraints_.constrain(values);
    if (has_density(rheologies)) {
      std::vector<double> densities;
      for (const Rheology& rheology : rheologies) densities.push_back(rheology.density);
      mass_.emplace(scene.body, densities, assembly_);
    }
    solver_ = make_linear_solver();
    solver_->analyse(assembly_.pattern());
    if (solver_->factorise(values) != FactorStatus::ok) {
      throw InputError(
          "The body is not held: its stiffness at rest is singular. Fix more of its points.");
    }
    root_of_states_ = root_of(trained.states);
  }

  BuiltModel attach(const std::vector<BondedPatch>& tools, const ReductionOptions& options) const {
    validate(options);
    require_same_rest(scene_, trained_, options);
    if (tools.empty()) throw InputError("No tool is to be attached. Give at least one.");
    const int num_tools = static_cast<int>(tools.size());
    if (3 * num_tools != trained_.tools.rows()) {
      throw InputError("The places of training have " + std::to_string(trained_.tools.rows() / 3) +
                       " tools each, and " + std::to_string(num_tools) +
                       " are to be attached. Attach as many.");
    }
    const Held held = hold(tools);
    ModeBuilder builder(stiffness_, trained_.modes.rows());
    const Eigen::MatrixXd places = directions(num_tools);
    const Expansion still = expand(held, held.responses * places, places);
    const auto until = [&](double share) {
      return std::lround(share * options.modes) - builder.modes().cols();
    };
    BuiltModel placed;
    const double terms_share = mass_ ? kTermsShareInMotion : kTermsShare;
    builder.add(still.higher(), until(terms_share));
    placed.one_tool_modes = static_cast<Index>(builder.modes().cols());
    std::optional<Expansion> moving;
    if (mass_) {
      moving = move_linear_body(held, num_tools, options);
      builder.add(moving->first - held.responses * moving->tools,
                  until(terms_share + kLinearShare));
      builder.add(moving->higher(), until(terms_share + kLinearShare + kMotionShare));
    }
    check_trained_around(held, tools);
    const Eigen::MatrixXd left = held.vanishing(trained_.modes);
    builder.add(left * root_of_states_, until(1));
    const Eigen::Index n = builder.modes().cols();
    const Eigen::Index d = held.rigid.cols();
    placed.motion_modes = static_cast<Index>(n) - placed.one_tool_modes;
    placed.basis.resize(trained_.modes.rows(), n + d);
    placed.basis << builder.modes(), held.responses;
    hold_directions(scene_.body, placed.basis);
    placed.rest = trained_.rest;
    // Remove rounding at the points of the tools.
    for (Eigen::Index i = 0; i < held.rigid.rows(); ++i) {
      placed.basis.row(held.rows[i]) << Eigen::RowVectorXd::Zero(n), held.rigid.row(i);
    }
    // The states are equilibria by the expansion, at the reach and at half of it, motion by the
    // expansion, and states of training.
    const Eigen::Index stride = std::max<Eigen::Index>(1, trained_.states.cols() / kMostStates);
    const Eigen::Index of_training = (trained_.states.cols() + stride - 1) / stride;
    const Eigen::MatrixXd to_modes = builder.coordinates(left);
    Eigen::MatrixXd states(n + d, of_training);
    for (Eigen::Index c = 0; c < of_training; ++c) {
      states.col(c) << to_modes * trained_.states.col(c * stride), trained_.tools.col(c * stride);
    }
    for (const double size : {1.0, 0.5}) {
      states = side_by_side(states, still.coordinates(builder, size));
    }
    if (moving) states = side_by_side(states, moving->coordinates(builder, 1));
    const Eigen::MatrixXd stiffness = held.rigid.transpose() * held.factor.solve(held.rigid);
    choose_model_points(scene_, rheologies_, points_, stiffness, states, options, placed);
    placed.num_states = static_cast<int>(states.cols());
    return placed;
  }

 private:
  /// The body with tools held; for the notation see the header.
  struct Held {
    /// The rows that C selects, and R.
    std::vector<Eigen::Index> rows;
    Eigen::MatrixXd rigid;
    Eigen::MatrixXd z;
    Eigen::LLT<Eigen::MatrixXd> factor;
    /// L.
    Eigen::MatrixXd responses;

    /// P x.
    [[nodiscard]] Eigen::MatrixXd vanishing(const Eigen::MatrixXd& x) const {
      return x - z * factor.solve(at_tools(x));
    }
    /// C x.
    [[nodiscard]] Eigen::MatrixXd at_tools(const Eigen::MatrixXd& x) const {
      Eigen::MatrixXd values(static_cast<Eigen::Index>(rows.size()), x.cols());
      for (Eigen::Index i = 0; i < values.rows(); ++i) values.row(i) = x.row(rows[i]);
      return values;
    }
  };

  [[nodiscard]] Held hold(const std::vector<BondedPatch>& tools) const {
    const std::vector<PrescribedPoint> points = as_list(tools).prescribed_points();
    Held held;
    held.rigid.setZero(3 * static_cast<Eigen::Index>(points.size()),
                       3 * static_cast<Eigen::Index>(tools.size()));
    std::vector<char> taken(scene_.body.mesh.points.size(), 0);
    for (const PrescribedPoint& at : points) {
      const bool exists = at.point >= 0 && at.point < scene_.body.mesh.num_points();
      if (!exists || assembly_.unknown_of_point()[at.point] < 0 || constraints_.holds(at.point)) {
        throw InputError("A tool cannot be attached to point " + std::to_string(at.point) +
                         ": it does not exist, is in no cell, is fixed or has a HeldDirection. "
                         "Choose another place.");
      }
      if (taken[at.point] != 0) {
        throw InputError("Two tools hold point " + std::to_string(at.point) +
                         ". Attach them farther apart.");
      }
      taken[at.point] = 1;
      for (int i = 0; i < 3; ++i) {
        held.rigid(static_cast<Eigen::Index>(held.rows.size()), at.coordinate + i) = 1;
        held.rows.push_back(3 * Eigen::Index{at.point} + i);
      }
    }
    Eigen::MatrixXd forces =
        Eigen::MatrixXd::Zero(trained_.modes.rows(), static_cast<Eigen::Index>(held.rows.size()));
    for (Eigen::Index c = 0; c < forces.cols(); ++c) forces(held.rows[c], c) = 1;
    held.z = inverse_times(forces);
    const Eigen::MatrixXd s = held.at_tools(held.z);
    held.factor.compute(0.5 * (s + s.transpose()));
    held.responses = held.z * held.factor.solve(held.rigid);
    return held;
  }

  /// Refuses a tool on a part of the body that is connected to no place of training: the training
  /// knows nothing but rest there.
  void check_trained_around(const Held& held, const std::vector<BondedPatch>& tools) const {
    // A body of the linear law without inertia needs no training.
    if (trained_.modes.cols() == 0) return;
    for (std::size_t tool = 0; tool < tools.size(); ++tool) {
      const Eigen::MatrixXd response =
          held.responses.middleCols(3 * static_cast<Eigen::Index>(tool), 3);
      double of_part = 0;
      for (Eigen::Index row = 0; row < response.rows(); ++row) {
        if (response.row(row).norm() > kMoves) of_part += trained_.modes.row(row).squaredNorm();
      }
      if (of_part > kMoves * trained_.modes.squaredNorm()) continue;
      throw InputError("The tool at point " + std::to_string(tools[tool].points().front()) +
                       " is on a part of the body that has no place of training and is joined to "
                       "none that has. Train at a place there too.");
    }
  }

  /// The terms of displacements of the body in powers of those of its tools, at full size.
  struct Expansion {
    /// Terms of first, second and third order [3 num_points × states], m.
    Eigen::MatrixXd first;
    Eigen::MatrixXd second;
    Eigen::MatrixXd third;
    /// Tool displacements [d × states], m.
    Eigen::MatrixXd tools;

    [[nodiscard]] Eigen::MatrixXd higher() const { return side_by_side(second, third); }
    /// y of the displacements when the tools move by a share of theirs.
    [[nodiscard]] Eigen::MatrixXd coordinates(const ModeBuilder& builder, double size) const {
      Eigen::MatrixXd y(builder.modes().cols() + tools.rows(), tools.cols());
      y << builder.coordinates(size * first + std::pow(size, 2) * second +
                               std::pow(size, 3) * third),
          size * tools;
      return y;
    }
  };

  /// Computes the terms of second and third order of u(ε) = ε u₁ + ε² u₂ + ε³ u₃ + …, with the
  /// inertia of u₁ alone, from the internal forces f minus those at rest:
  ///
  ///   K₀ u₂ = −½ (f(ε u₁) + f(−ε u₁))/ε²
  ///   K₀ u₃ = −½ (f(ε² u₂ + ε u₁) − f(ε² u₂ − ε u₁))/ε³ + K₀ u₁/ε²   u₂ = u₃ = 0 at the tools
  ///
  /// @param first u₁ of each state.
  /// @param tools The tool displacements of each state.
  [[nodiscard]] Expansion expand(const Held& held, const Eigen::MatrixXd& first,
                                 const Eigen::MatrixXd& tools) const {
    const Eigen::MatrixXd small = kExpansion * first;
    const Eigen::MatrixXd even = 0.5 * (forces_at(small) + forces_at(-small));
    const Eigen::MatrixXd second = -held.vanishing(inverse_times(even));
    const Eigen::MatrixXd odd =
        0.5 * (forces_at(second + small) - forces_at(second - small)) - stiffness_.times(small);
    const Eigen::MatrixXd third = -held.vanishing(inverse_times(odd));
    if (!second.allFinite() || !third.allFinite()) {
      throw InputError("The body is inverted as soon as its tools move by " +
                       quantity(kExpansion * trained_.reach, "m") +
                       ". Train with a shorter Reach.");
    }
    return {first, second / std::pow(kExpansion, 2), third / std::pow(kExpansion, 3), tools};
  }

  /// The motion of the linear body along the paths of training, with its terms of higher order. In
  /// the coordinates of L and of inertial_terms() its equation is
  ///
  ///   M q̈ + τ q̇ + q = −M_L d̈
  ///
  /// with the shortest viscous time τ of a material, in steps of BDF2.
  [[nodiscard]] Expansion move_linear_body(const Held& held, int num_tools,
                                           const ReductionOptions& options) const {
    ModeBuilder linear(stiffness_, held.responses.rows());
    linear.add(inertial_terms(held), kInertialOrders * held.responses.cols());
    const Eigen::Index n = linear.modes().cols();
    const Eigen::Index d = held.responses.cols();
    Eigen::MatrixXd basis(held.responses.rows(), n + d);
    basis << linear.modes(), held.responses;
    Eigen::MatrixXd of_basis(basis.rows(), basis.cols());
    for (Eigen::Index c = 0; c < basis.cols(); ++c) {
      of_basis.col(c) = mass_->times(basis.col(c)).head(basis.rows());
    }
    const Eigen::MatrixXd mass = linear.modes().transpose() * of_basis;
    double viscous_time = rheologies_.front().viscous_time;
    for (const Rheology& rheology : rheologies_) {
      viscous_time = std::min(viscous_time, rheology.viscous_time);
    }
    const double h = options.time_step;
    const double rate = 3 / (2 * h);
    const Eigen::LLT<Eigen::MatrixXd> step_matrix(rate * rate * mass.leftCols(n) +
                                                  (1 + rate * viscous_time) *
                                                      Eigen::MatrixXd::Identity(n, n));
    std::vector<Eigen::VectorXd> states;
    for (const ToolPath& path : training_paths(options, num_tools)) {
      // y and its velocity at the last two times.
      Eigen::VectorXd y = Eigen::VectorXd::Zero(n + d);
      Eigen::VectorXd y_before = y;
      Eigen::VectorXd v = y;
      Eigen::VectorXd v_before = y;
      for (int step = 1; step * h <= path.end(); ++step) {
        Eigen::VectorXd next = Eigen::VectorXd::Zero(n + d);
        next.tail(d) = path.at(step * h);
        // The velocity is rate y plus a part that follows from the past, and so is the
        // acceleration.
        const Eigen::VectorXd v_of_past = (-4 * y + y_before) / (2 * h);
        const Eigen::VectorXd a_of_past = rate * v_of_past + (-4 * v + v_before) / (2 * h);
        const Eigen::VectorXd known = rate * rate * next + a_of_past;
        next.head(n) = step_matrix.solve(-mass * known - viscous_time * v_of_past.head(n));
        y_before = std::exchange(y, next);
        v_before = std::exchange(v, rate * next + v_of_past);
        states.push_back(y);
      }
    }
    const auto num_states = static_cast<Eigen::Index>(states.size());
    const Eigen::Index count = std::min(kMovingTerms, num_states);
    Eigen::MatrixXd chosen(n + d, count);
    for (Eigen::Index c = 0; c < count; ++c) {
      chosen.col(c) = states[static_cast<std::size_t>((c + 1) * num_states / count - 1)];
    }
    return expand(held, basis * chosen, chosen.bottomRows(d));
  }

  /// The terms of the linear body's response to motion of the tools, in powers of the frequency: K₀
  /// v₁ = M L, K₀ v₂ = M v₁, …, with v = 0 at the tools.
  [[nodiscard]] Eigen::MatrixXd inertial_terms(const Held& held) const {
    const Eigen::Index d = held.responses.cols();
    Eigen::MatrixXd terms(held.responses.rows(), kInertialOrders * d);
    Eigen::MatrixXd last = held.responses;
    for (int order = 0; order < kInertialOrders; ++order) {
      for (Eigen::Index c = 0; c < d; ++c) last.col(c) = mass_->times(last.col(c));
      last = held.vanishing(inverse_times(last));
      terms.middleCols(order * d, d) = last;
      for (Eigen::Index c = 0; c < d; ++c) {
        terms.col(order * d + c) /=
            std::sqrt(last.col(c).dot(stiffness_.times(last.col(c)).col(0)));
      }
    }
    return terms;
  }

  /// Random displacements of the tools, somewhat more than there are terms of third order.
  [[nodiscard]] Eigen::MatrixXd directions(int num_tools) const {
    const int d = 3 * num_tools;
    return random_places(num_tools, trained_.reach, d * (d + 1) * (d + 2) / 6 + d, /*seed=*/1);
  }

  /// f of each column, including that of the springs, minus that at rest.
  [[nodiscard]] Eigen::MatrixXd forces_at(const Eigen::MatrixXd& u) const {
    Eigen::MatrixXd forces(u.rows(), u.cols());
    NodalVector force;
    for (Eigen::Index c = 0; c < u.cols(); ++c) {
      (void)assembly_.residual(rest_state_ + u.col(c), force);
      forces.col(c) = force - rest_force_;
      if (springs_) forces.col(c) += springs_->times(u.col(c)).head(u.rows());
    }
    return forces;
  }

  /// K₀⁻¹ f of each column; zero at fixed points.
  [[nodiscard]] Eigen::MatrixXd inverse_times(const Eigen::MatrixXd& f) const {
    const std::vector<Index>& state_of_unknown = assembly_.state_of_unknown();
    Eigen::MatrixXd unknowns(static_cast<Eigen::Index>(state_of_unknown.size()), f.cols());
    for (Eigen::Index i = 0; i < unknowns.rows(); ++i) unknowns.row(i) = f.row(state_of_unknown[i]);
    constraints_.project(unknowns);
    solver_->solve(unknowns);
    constraints_.project(unknowns);
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(f.rows(), f.cols());
    for (Eigen::Index i = 0; i < unknowns.rows(); ++i)
      all.row(state_of_unknown[i]) = unknowns.row(i);
    return all;
  }

  const Scene& scene_;
  const std::vector<Rheology>& rheologies_;
  const TrainedPlaces& trained_;
  Assembly assembly_;
  DirectionConstraints constraints_;
  /// Springs that support the body; empty: there are none.
  std::optional<PointMatrix> springs_;
  BodyPoints points_;
  RestStiffness stiffness_;
  std::unique_ptr<LinearSolver> solver_;
  /// The state at rest, and f there.
  NodalVector rest_state_;
  NodalVector rest_force_;
  std::optional<MassMatrix> mass_;
  /// The root of the sum of a aᵀ over the training states a.
  Eigen::MatrixXd root_of_states_;
};

PlacedTools::PlacedTools(const Scene& scene, const std::vector<Rheology>& rheologies,
                         const TrainedPlaces& trained)
    : impl_(std::make_unique<Impl>(scene, rheologies, trained)) {}
PlacedTools::~PlacedTools() = default;
PlacedTools::PlacedTools(PlacedTools&&) noexcept = default;
PlacedTools& PlacedTools::operator=(PlacedTools&&) noexcept = default;

BuiltModel PlacedTools::attach(const std::vector<BondedPatch>& tools,
                               const ReductionOptions& options) const {
  return impl_->attach(tools, options);
}

}  // namespace palpate
