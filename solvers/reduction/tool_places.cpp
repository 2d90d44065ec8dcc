// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/tool_places.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "assembly/assembly.h"
#include "assembly/mass.h"
#include "base/error.h"
#include "dynamics/dynamic_solver.h"
#include "equilibrium/equilibrium.h"
#include "interaction/interaction_list.h"
#include "linear/linear_solver.h"
#include "reduction/hyper_reduction.h"
#include "reduction/random_path.h"
#include "reduction/reduced_basis.h"
#include "reduction/training.h"

namespace palpate {
namespace {

/// The share of the modes that is of equilibria, where there is motion too.
constexpr double kStillShare = 0.3;
/// The share of the modes that is of the terms of higher order, at the most.
constexpr double kTermsShare = 0.4;
/// The same, of the terms of the response to motion.
constexpr double kInertialShare = 0.2;
/// ε of higher_terms(): what is left out is ε² of a term, and rounding a part in ten thousand.
constexpr double kExpansion = 0.02;
/// Terms of the response to motion, for each coordinate of a tool.
constexpr int kInertialOrders = 4;
/// States of training that choose the points of a model.
constexpr Eigen::Index kMostStates = 500;

Eigen::MatrixXd side_by_side(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  Eigen::MatrixXd both(a.rows(), a.cols() + b.cols());
  both << a, b;
  return both;
}

InteractionList as_list(const std::vector<BondedPatch>& tools) {
  InteractionList list;
  for (const BondedPatch& tool : tools) list.add(tool);
  return list;
}

void refuse_gravity(const ReductionOptions& options) {
  if (options.gravity.isZero(0)) return;
  throw InputError(
      "A reduced model whose tools attach anywhere has no gravity. Leave BodyForce at 0 0 0.");
}

/// The states of all places, and what they have beside the linear responses.
struct StatesOfPlaces {
  TrainingStates states;
  Eigen::MatrixXd beside;

  void append(const TrainingStates& more, const Eigen::MatrixXd& responses) {
    states.append(more);
    const Eigen::MatrixXd of_more = more.u - responses * more.tools;
    beside = beside.cols() == 0 ? of_more : side_by_side(beside, of_more);
  }
};

}  // namespace

TrainedPlaces train_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                           const std::vector<std::vector<BondedPatch>>& places,
                           const ReductionOptions& options) {
  check_reduction(scene, rheologies, options);
  refuse_gravity(options);
  if (places.empty()) {
    throw InputError("A reduced model needs a place of training. Give at least one.");
  }
  Scene checked = scene;
  check(checked);
  const auto report = [&](const std::string& what) {
    if (options.report) options.report(what);
  };
  EquilibriumSolver solver(checked, options.equilibrium);
  StatesOfPlaces still;
  StatesOfPlaces moving;
  int number = 0;
  for (const std::vector<BondedPatch>& tools : places) {
    if (tools.empty() || tools.size() != places.front().size()) {
      throw InputError("Place " + std::to_string(number) + " of training has " +
                       std::to_string(tools.size()) + " tools, and place 0 has " +
                       std::to_string(places.front().size()) +
                       ". Give each place as many, at least one.");
    }
    report("Place " + std::to_string(number + 1) + " of " + std::to_string(places.size()));
    const int num_tools = static_cast<int>(tools.size());
    const InteractionList list = as_list(tools);
    solver.set_interaction(list);
    const Eigen::MatrixXd of_place = solver.rest().v;
    still.append(find_equilibria(solver, one_tool_places(num_tools, options.reach)), of_place);
    if (num_tools > 1) {
      const auto seed = options.seed + static_cast<std::uint64_t>(number);
      still.append(find_equilibria(solver, random_places(num_tools, options.reach,
                                                         options.all_tools_states, seed)),
                   of_place);
    }
    if (has_density(rheologies)) {
      const int first_path = number * options.training_paths;
      moving.append(move_in_training(checked, rheologies, list,
                                     training_paths(options, num_tools, first_path), options),
                    of_place);
    }
    ++number;
  }

  report("Modes");
  const RestStiffness stiffness(solver.assembly());
  ModeBuilder builder(stiffness, still.beside.rows());
  const bool moves = moving.beside.cols() > 0;
  const auto of_still =
      static_cast<Eigen::Index>(std::lround(options.modes * (moves ? kStillShare : 1)));
  builder.add(still.beside, of_still);
  if (moves) builder.add(moving.beside, options.modes - builder.modes().cols());
  TrainedPlaces trained;
  trained.modes = builder.modes();
  trained.reach = options.reach;
  trained.states = builder.coordinates(still.beside);
  trained.tools = still.states.tools;
  if (moves) {
    trained.states = side_by_side(trained.states, builder.coordinates(moving.beside));
    trained.tools = side_by_side(trained.tools, moving.states.tools);
  }
  trained.num_left_out = still.states.num_left_out + moving.states.num_left_out;
  return trained;
}

class PlacedTools::Impl {
 public:
  Impl(const Scene& scene, const std::vector<Rheology>& rheologies, const TrainedPlaces& trained)
      : scene_(scene),
        rheologies_(rheologies),
        trained_(trained),
        assembly_(scene),
        points_(scene),
        stiffness_(assembly_) {
    const Eigen::Index rows = 3 * Eigen::Index{scene.mesh.num_points()};
    if (trained.modes.rows() != rows || trained.states.rows() != trained.modes.cols() ||
        trained.tools.cols() != trained.states.cols()) {
      throw InputError(
          "The places of training are of another body: their modes have " +
          std::to_string(trained.modes.rows()) + " rows in place of " + std::to_string(rows) +
          ", or their arrays do not belong together. Train with the scene that is given.");
    }
    NodalVector force;
    std::vector<double> values;
    (void)assembly_.tangent(NodalVector::Zero(assembly_.state_size()), force, values);
    if (has_density(rheologies)) {
      std::vector<double> densities;
      for (const Rheology& rheology : rheologies) densities.push_back(rheology.density);
      mass_.emplace(scene, densities, assembly_);
    }
    solver_ = make_linear_solver();
    solver_->analyse(assembly_.pattern());
    if (solver_->factorise(values) != FactorStatus::ok) {
      throw InputError(
          "The body is not held: its stiffness at rest is singular. Fix more of its points.");
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> energies(trained.states *
                                                                  trained.states.transpose());
    root_of_states_ = energies.eigenvectors() *
                      energies.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() *
                      energies.eigenvectors().transpose();
  }

  BuiltModel attach(const std::vector<BondedPatch>& tools, const ReductionOptions& options) const {
    validate(options);
    refuse_gravity(options);
    if (tools.empty()) throw InputError("No tool is to be attached. Give at least one.");
    const int num_tools = static_cast<int>(tools.size());
    if (3 * num_tools != trained_.tools.rows()) {
      throw InputError("The places of training have " + std::to_string(trained_.tools.rows() / 3) +
                       " tools each, and " + std::to_string(num_tools) +
                       " are to be attached. Attach as many.");
    }
    const Held held = hold(tools);
    ModeBuilder builder(stiffness_, trained_.modes.rows());
    const Eigen::MatrixXd terms = higher_terms(held, num_tools);
    if (!terms.allFinite()) {
      throw InputError("The body is inverted as soon as its tools move by " +
                       std::to_string(kExpansion * trained_.reach) +
                       " m. Train with a shorter Reach.");
    }
    const auto at_most = [&](double share) { return std::lround(share * options.modes); };
    BuiltModel placed;
    builder.add(terms, at_most(kTermsShare));
    placed.one_tool_modes = static_cast<Index>(builder.modes().cols());
    if (mass_) builder.add(inertial_terms(held), at_most(kInertialShare));
    const Eigen::MatrixXd left = held.vanishing(trained_.modes);
    builder.add(left * root_of_states_, options.modes - builder.modes().cols());
    const Eigen::Index n = builder.modes().cols();
    const Eigen::Index d = held.rigid.cols();
    placed.motion_modes = static_cast<Index>(n) - placed.one_tool_modes;
    placed.basis.resize(trained_.modes.rows(), n + d);
    placed.basis << builder.modes(), held.responses;
    // What rounding has left at the tools.
    for (Eigen::Index i = 0; i < held.rigid.rows(); ++i) {
      placed.basis.row(held.rows[i]) << Eigen::RowVectorXd::Zero(n), held.rigid.row(i);
    }
    // Equilibria by the expansion, at reach and at half of it, and the states of training.
    const Eigen::Index count = terms.cols() / 2;
    const Eigen::MatrixXd places = directions(num_tools);
    const Eigen::MatrixXd second = builder.coordinates(terms.leftCols(count));
    const Eigen::MatrixXd third = builder.coordinates(terms.rightCols(count));
    const Eigen::Index stride = std::max<Eigen::Index>(1, trained_.states.cols() / kMostStates);
    const Eigen::Index of_training = (trained_.states.cols() + stride - 1) / stride;
    Eigen::MatrixXd states(n + d, 2 * count + of_training);
    states.leftCols(count) << second + third, places;
    states.middleCols(count, count) << 0.25 * second + 0.125 * third, 0.5 * places;
    const Eigen::MatrixXd to_modes = builder.coordinates(left);
    for (Eigen::Index c = 0; c < of_training; ++c) {
      states.col(2 * count + c) << to_modes * trained_.states.col(c * stride),
          trained_.tools.col(c * stride);
    }
    const Eigen::MatrixXd stiffness = held.rigid.transpose() * held.factor.solve(held.rigid);
    choose_model_points(scene_, rheologies_, points_, stiffness, states, options, placed);
    placed.num_states = static_cast<int>(states.cols());
    return placed;
  }

 private:
  /// The body with tools, see the head of the header.
  struct Held {
    /// Those that C takes, and R.
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
    std::vector<char> taken(scene_.mesh.points.size(), 0);
    for (const PrescribedPoint& at : points) {
      const bool exists = at.point >= 0 && at.point < scene_.mesh.num_points();
      if (!exists || assembly_.unknown_of_point()[at.point] < 0) {
        throw InputError("A tool cannot be attached to point " + std::to_string(at.point) +
                         ": it does not exist, is in no cell or is fixed. Choose another place.");
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

  /// The terms of second and third order of the equilibrium's expansion in the displacement of the
  /// tools, u(ε d) = ε L d + ε² u₂ + ε³ u₃ + …, in many directions d as long as the reach. From the
  /// internal forces f:
  ///
  ///   K₀ u₂ = −½ (f(ε L d) + f(−ε L d))/ε²
  ///   K₀ u₃ = −½ (f(ε² u₂ + ε L d) − f(ε² u₂ − ε L d))/ε³     with u₂ = u₃ = 0 at the tools
  [[nodiscard]] Eigen::MatrixXd higher_terms(const Held& held, int num_tools) const {
    const Eigen::MatrixXd first = kExpansion * held.responses * directions(num_tools);
    const Eigen::Index count = first.cols();
    const Eigen::MatrixXd even = 0.5 * (forces_at(first) + forces_at(-first));
    const Eigen::MatrixXd second = -held.vanishing(inverse_times(even));
    const Eigen::MatrixXd odd = 0.5 * (forces_at(second + first) - forces_at(second - first));
    const Eigen::MatrixXd third = -held.vanishing(inverse_times(odd));
    Eigen::MatrixXd terms(first.rows(), 2 * count);
    terms << second / std::pow(kExpansion, 2), third / std::pow(kExpansion, 3);
    return terms;
  }

  /// The terms of the linear body's response to motion of the tools in powers of the frequency:
  /// K₀ v₁ = M L, K₀ v₂ = M v₁, …, 0 at the tools.
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

  /// Random displacements of the tools: as many as there are terms of third order, and some.
  [[nodiscard]] Eigen::MatrixXd directions(int num_tools) const {
    const int d = 3 * num_tools;
    return random_places(num_tools, trained_.reach, d * (d + 1) * (d + 2) / 6 + d, /*seed=*/1);
  }

  /// f of each column.
  [[nodiscard]] Eigen::MatrixXd forces_at(const Eigen::MatrixXd& u) const {
    Eigen::MatrixXd forces(u.rows(), u.cols());
    NodalVector force;
    for (Eigen::Index c = 0; c < u.cols(); ++c) {
      (void)assembly_.residual(u.col(c), force);
      forces.col(c) = force;
    }
    return forces;
  }

  /// K₀⁻¹ f of each column; zero at fixed points.
  [[nodiscard]] Eigen::MatrixXd inverse_times(const Eigen::MatrixXd& f) const {
    const std::vector<Index>& state_of_unknown = assembly_.state_of_unknown();
    Eigen::MatrixXd unknowns(static_cast<Eigen::Index>(state_of_unknown.size()), f.cols());
    for (Eigen::Index i = 0; i < unknowns.rows(); ++i) unknowns.row(i) = f.row(state_of_unknown[i]);
    solver_->solve(unknowns);
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(f.rows(), f.cols());
    for (Eigen::Index i = 0; i < unknowns.rows(); ++i)
      all.row(state_of_unknown[i]) = unknowns.row(i);
    return all;
  }

  const Scene& scene_;
  const std::vector<Rheology>& rheologies_;
  const TrainedPlaces& trained_;
  Assembly assembly_;
  BodyPoints points_;
  RestStiffness stiffness_;
  std::unique_ptr<LinearSolver> solver_;
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
