// SPDX-License-Identifier: BSD-3-Clause
// The discrete body together with a tool, condensed to the free unknowns: the residuals and linear
// systems that an equilibrium takes. Let i be the free unknowns and a those of the points that the
// tool prescribes. K_ii is stored on the pattern of the whole system, with the rows and columns of
// a replaced by a multiple of the identity. So one symbolic analysis serves every tool; another is
// made only if a term or a tool couples points for which the pattern has no room
// (system_pattern.h). One factor of the tangent at rest serves every tool too, as long as a solve
// for each unknown that is held costs less than a factorisation (rest_factor.h).
#pragma once

#include <cmath>
#include <limits>
#include <list>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/energy_term.h"
#include "equilibrium/direction_constraints.h"
#include "equilibrium/krylov_tangent.h"
#include "equilibrium/rest_factor.h"
#include "equilibrium/state.h"
#include "equilibrium/system_pattern.h"
#include "equilibrium/work.h"
#include "interaction/interaction.h"
#include "linear/linear_solver.h"

namespace palpate {

/// The rounding of an energy, as a share of it: an energy is a sum over the body, and two that
/// differ by less are equal.
inline constexpr double kEnergyRounding = 1e-11;

/// The energy of a body and a tool at a state, and its first derivatives.
struct Evaluation {
  /// Π, J; not finite where it is not defined, as in an inverted cell.
  double energy = 0;
  /// ∂Π/∂x of every component of the state, N.
  NodalVector force;
  /// ∂Φ/∂q of the tool's potential [num_coordinates], N where q is a length.
  Eigen::VectorXd of_coordinates;

  [[nodiscard]] bool is_finite() const { return std::isfinite(energy); }
};

/// The second derivatives of that energy, condensed to the free unknowns.
struct CondensedTangent {
  /// The tool and the state at which the derivatives were computed. In a linear body the
  /// derivatives are the same everywhere.
  Eigen::VectorXd q;
  NodalVector state;
  /// K_ii on CondensedSystem::pattern(), N/m.
  std::vector<double> values;
  /// ∂²Π/∂x_i∂q [unknowns × num_coordinates] and ∂²Π/∂q².
  Eigen::MatrixXd mixed;
  Eigen::MatrixXd of_coordinates;
};

/// What is known about the stability of a body at rest without a tool.
struct RestStability {
  int negative_pivots = 0;
  double lowest_eigenvalue = std::numeric_limits<double>::quiet_NaN();
  /// The error of the displacement, see LinearisedState::displacement_error.
  double displacement_error = 0;
  /// flags::unstable and flags::inertia_not_computed.
  Flags flags = 0;
};

class CondensedSystem {
 public:
  /// @param scene A scene that check() accepts.
  /// @param solver Null: nothing is factorised, and tangents are solved for by iteration.
  /// @param kept_factors At least 2: the factors at the start of a step and at its present state.
  /// @param precision The precision of factors. A saddle, and a body whose tangent at rest is too
  ///   near to singular for single precision, has full precision in any case.
  /// @param terms Terms that set_terms() will give later: the pairs that they couple are analysed
  ///   together with the body.
  /// @throws InputError the linear solver cannot factorise the body.
  CondensedSystem(const Scene& scene, std::unique_ptr<LinearSolver> solver, int kept_factors,
                  Precision precision, const std::vector<const EnergyTerm*>& terms = {});

  /// Chooses the tool.
  /// @throws InputError it has no coordinates, or prescribes a point that does not exist, is in no
  ///   cell, is fixed or held along a direction, or is named twice.
  void set_interaction(const Interaction& interaction);

  /// Gives the body further energies, besides that of its materials, and forgets all factors. It
  /// measures anew how stiff each unknown is. Call it again when a term has changed by more than an
  /// old factor can approximate, and set_rest() once the body has found its rest with them.
  /// @param terms They must outlive this object, or stay until the next call.
  void set_terms(std::vector<const EnergyTerm*> terms);

  /// Sets the rest of the body with its terms. The coordinates of tools that prescribe points count
  /// from it. Until this is called, it is the undeformed state.
  void set_rest(const NodalVector& state);
  /// The sizes of the energies at rest that cancel out, J: their rounding is part of each energy.
  [[nodiscard]] double energies_at_rest() const { return energies_at_rest_; }
  void set_energies_at_rest(double energies) { energies_at_rest_ = energies; }

  [[nodiscard]] const Assembly& assembly() const { return assembly_; }
  /// The assembly, to change the materials: see Assembly::scale_energy(). Call set_terms()
  /// afterwards.
  [[nodiscard]] Assembly& assembly() { return assembly_; }
  /// The mean of the diagonal of the tangent of the undeformed body, N/m.
  [[nodiscard]] double mean_stiffness() const { return mean_diagonal_; }
  /// The pattern of the tangents.
  [[nodiscard]] const SymmetricPattern& pattern() const { return pattern_.whole(); }
  /// The tool. Call set_interaction() before.
  [[nodiscard]] const Interaction& interaction() const { return *interaction_; }
  [[nodiscard]] const std::vector<PrescribedPoint>& prescribed_points() const {
    return prescribed_points_;
  }
  [[nodiscard]] const Work& work() const { return work_; }
  [[nodiscard]] const TetMesh& mesh() const { return mesh_; }
  /// See supports.h.
  [[nodiscard]] const std::vector<char>& holding_points() const { return holding_points_; }
  /// d; 0 if there is no tool.
  [[nodiscard]] Index num_coordinates() const {
    return interaction_ == nullptr ? 0 : interaction_->num_coordinates();
  }
  /// Whether the tool at q is inside the body, having passed through its surface.
  [[nodiscard]] bool tool_is_inside(const Eigen::VectorXd& q, const NodalVector& state) const;
  /// Whether the body is at rest and the tool away from it, so that the tool feels no force.
  [[nodiscard]] bool feels_nothing(const Eigen::VectorXd& q, const NodalVector& state) const;
  /// The stability of the rest. A body without terms is undeformed at rest, and stable. It is empty
  /// if the body has terms and set_rest_stability() was not called since the terms or the rest were
  /// set.
  [[nodiscard]] const std::optional<RestStability>& rest_stability() const {
    return rest_stability_;
  }
  void set_rest_stability(const RestStability& stability) { rest_stability_ = stability; }
  /// How far the tool, or a point of the body, may move in one step of a solve, m.
  [[nodiscard]] double longest_step() const;
  /// The largest share of a step of the body, at most 1, in which no term misses anything.
  [[nodiscard]] double longest_share(const NodalVector& state, const NodalVector& step) const;
  /// Whether tangents are solved for by iteration. Functions that need a factor must not be called
  /// then.
  [[nodiscard]] bool is_iterative() const { return krylov_ != nullptr; }
  /// Whether the tangent is the same at all states.
  [[nodiscard]] bool is_linear() const {
    return assembly_.is_linear() && !has_potential() && terms_.empty();
  }
  /// Whether the equilibrium is a saddle of the energy, because there are pressures.
  [[nodiscard]] bool is_saddle() const { return assembly_.num_pressures() > 0; }

  /// The scale of displacements with the tool at q, m: the displacement of the tool, but at least a
  /// thousandth of a mean edge.
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& q) const;
  /// The largest component of a residual, m. Each component is divided by the norm of its row of
  /// the tangent at rest, so that the residual of a soft part counts as much as that of a stiff
  /// one.
  [[nodiscard]] double norm(const Eigen::VectorXd& r) const;
  /// The root of the sum of squares of the same quotients, m.
  [[nodiscard]] double euclidean_norm(const Eigen::VectorXd& r) const;

  /// The energy and the forces at a state with the tool at q.
  [[nodiscard]] Evaluation evaluate(const Eigen::VectorXd& q, const NodalVector& state);
  /// The residual in the order of the unknowns, N; zero for unknowns that are held.
  [[nodiscard]] Eigen::VectorXd residual(const Evaluation& at) const;
  /// h, the force that holds the tool [num_coordinates], N.
  [[nodiscard]] Eigen::VectorXd reaction(const Evaluation& at) const;

  /// Moves the points that the tool prescribes to their place at q: u = u_rest + q.
  void prescribe(const Eigen::VectorXd& q, NodalVector& state) const;
  /// Sets the change of the points that the tool prescribes to that of q.
  void prescribe_change(const Eigen::VectorXd& of_q, NodalVector& of_state) const;
  /// The scale s of each pressure, Pa/m.
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> pressure_scale() const;
  /// The vector x = (u, p̂) of a state.
  [[nodiscard]] NodalVector vector_of(const LinearisedState& state) const;
  /// ∂x/∂t [state_size × d].
  [[nodiscard]] Eigen::MatrixXd sensitivity_of(const LinearisedState& state) const;
  /// Converts a change of the state to a change of the unknowns; those that are held are 0.
  [[nodiscard]] Eigen::VectorXd as_unknowns(const NodalVector& state) const;
  /// Removes from a state the displacements of points along directions in which they are held.
  void hold_directions(NodalVector& state) const { constraints_.project_state(state); }
  /// Converts a change of the unknowns to a change of the state.
  [[nodiscard]] NodalVector as_state(const Eigen::VectorXd& unknowns) const;

  /// Call this before each solve, so that its result does not depend on the solves before.
  void begin_solve();

  /// The factor of the tangent at a state with the tool at q; null: it is not kept.
  [[nodiscard]] TangentFactor* find_factor(const Eigen::VectorXd& q, const NodalVector& state);
  /// If a factor at this state is kept, it is the next to be replaced.
  void forget(const Eigen::VectorXd& q, const NodalVector& state);
  /// The tangent at a state with the tool at q. Its memory is reused for a later tangent once no
  /// caller holds it any more.
  [[nodiscard]] std::shared_ptr<const CondensedTangent> tangent(const Eigen::VectorXd& q,
                                                                const NodalVector& state);
  /// Factorises a tangent, and returns null if it is singular. The new factor replaces the one that
  /// was not used for the longest time. A linear body has one factor for all states, and if
  /// possible all tools share the factor at rest. A factor depends on the scene, the tool and the
  /// state alone, so that the same factor is made again.
  [[nodiscard]] TangentFactor* factorise(const CondensedTangent& tangent);
  /// Factorises the tangent at a state, as above.
  [[nodiscard]] TangentFactor* factorise(const Eigen::VectorXd& q, const NodalVector& state) {
    return factorise(*tangent(q, state));
  }
  /// Factorises the tangent for its state and this tool alone, in full precision, so that the
  /// factor is not rough. It is valid until the next factorisation.
  [[nodiscard]] TangentFactor* factorise_accurately(const CondensedTangent& tangent);
  void solve(TangentFactor& factor, Eigen::Ref<Eigen::MatrixXd> columns);
  /// Solves by iteration, see KrylovTangent::solve().
  [[nodiscard]] SolveSummary solve(const CondensedTangent& tangent,
                                   Eigen::Ref<Eigen::MatrixXd> columns, double tolerance);
  /// A direction in which the energy falls, see KrylovTangent::descend().
  [[nodiscard]] SolveSummary descend(const CondensedTangent& tangent,
                                     Eigen::Ref<Eigen::MatrixXd> column, double tolerance);
  /// Estimates the inertia by iteration.
  [[nodiscard]] Inertia find_inertia(const CondensedTangent& tangent);
  /// The number of negative pivots besides the one that each pressure has.
  [[nodiscard]] int negative_pivots(const TangentFactor& factor) const;
  /// K_ii x for each column x.
  [[nodiscard]] Eigen::MatrixXd times(const CondensedTangent& tangent,
                                      const Eigen::MatrixXd& columns) const;
  /// An estimate of the 1-norm condition number of a tangent. It takes a few solves.
  [[nodiscard]] double condition(const CondensedTangent& tangent, TangentFactor& factor) const;

 private:
  /// Solves by iteration in one of the ways of KrylovTangent.
  [[nodiscard]] SolveSummary iterate(const CondensedTangent& tangent,
                                     Eigen::Ref<Eigen::MatrixXd> columns, double tolerance,
                                     SolveSummary (KrylovTangent::*way)(Eigen::Ref<Eigen::MatrixXd>,
                                                                        double));
  /// Entries of coordinate_of_unknown_ that do not stand for a coordinate.
  static constexpr Index kFree = -1;
  static constexpr Index kIdle = -2;

  /// A value of the pattern that couples a held unknown with a free one.
  struct Coupling {
    Index position;
    Index unknown;
    Index coordinate;
  };
  /// A value of the pattern between two held unknowns.
  struct Held {
    Index position;
    Index coordinate_a;
    Index coordinate_b;
    bool diagonal;
  };

  /// A factor for the present tool, with the place of the tool and the state to which it belongs.
  /// If the state is empty, there is no factor.
  struct KeptFactor final : TangentFactor {
    KeptFactor(std::unique_ptr<LinearSolver> with, long age)
        : solver(std::move(with)), pattern_age(age) {}
    void solve(Eigen::Ref<Eigen::MatrixXd> columns) override { solver->solve(columns); }
    [[nodiscard]] int negative_pivots() const override { return solver->negative_pivots(); }
    [[nodiscard]] bool is_rough() const override { return solver->is_single(); }

    std::unique_ptr<LinearSolver> solver;
    /// The age of the pattern that the solver has analysed.
    long pattern_age = 0;
    Eigen::VectorXd q;
    NodalVector state;
    /// Whether single precision was not tried, since it had failed before in the same solve.
    /// Another solve would try it, and so does not use this factor.
    bool is_provisional = false;
    /// The use count at which it was last made or asked for.
    long last_use = 0;
  };

  [[nodiscard]] bool has_potential() const {
    return interaction_ != nullptr && interaction_->has_potential();
  }
  /// Takes the solver and lets it analyse the pattern.
  void take_solver(std::unique_ptr<LinearSolver> solver);
  /// The blocks of each term at a state. Makes room for them on the pattern, and finds their
  /// places.
  [[nodiscard]] std::vector<PairBlocks> blocks_of_terms(const NodalVector& state);
  /// Gives the values of the undeformed body their places in a pattern that has grown.
  void spread_undeformed(const SymmetricPattern& before);
  /// Prepares for a pattern that has grown. What comes from now on is on the new pattern; factors
  /// that are kept stay valid.
  void analyse_anew();
  void make_room_for_tool();
  /// Finds the values of the pattern that belong to unknowns which the tool holds.
  void place_tool();
  void assemble(const NodalVector& state, std::vector<double>& values);
  /// Adds the forces of the terms and, unless it is null, their second derivatives to `values`, on
  /// the pattern of the materials.
  /// @returns Their energy, J.
  double add_terms(const NodalVector& state, NodalVector& force, std::vector<double>* values) const;
  /// Measures how stiff each unknown is in the undeformed body.
  void measure_stiffness();
  /// Adds the second derivatives of the tool's potential.
  void add_potential(CondensedTangent& tangent) const;
  /// Whether the tangent at a state equals that at rest.
  [[nodiscard]] bool is_as_at_rest(const Eigen::VectorXd& q, const NodalVector& state) const;
  /// Prepares the rest factor for the present tool if possible, and tells whether it serves it.
  /// @param at_rest The tangent at rest.
  [[nodiscard]] bool shares_rest_factor(const CondensedTangent& at_rest);
  /// Makes the rest factor; it stays null if the body floats.
  void make_rest_factor();
  /// Forgets the rest factor. Its solver becomes the spare one if there is none.
  void drop_rest_factor();
  /// An estimate of the relative error of solutions by the rest factor for the tangent at rest.
  [[nodiscard]] double error_of_rest_factor(const CondensedTangent& at_rest);
  /// The precision of factors that are allowed to be rough.
  [[nodiscard]] Precision usual_precision();
  [[nodiscard]] KeptFactor* factorise_alone(const CondensedTangent& tangent, Precision precision);
  [[nodiscard]] KeptFactor* find_kept_factor(const Eigen::VectorXd& q, const NodalVector& state);
  KeptFactor& factor_to_replace();
  /// One of the solvers; there is always one.
  [[nodiscard]] LinearSolver& any_solver();
  /// A solver that has analysed the present pattern; null: there is none.
  [[nodiscard]] LinearSolver* analysed_solver();
  /// Returns spare_solver_, and creates it if there is none.
  LinearSolver& spare_solver();
  [[nodiscard]] std::vector<char> find_idle_multipliers() const;

  TetMesh mesh_;
  std::vector<char> holding_points_;
  Assembly assembly_;
  SystemPattern pattern_;
  DirectionConstraints constraints_;
  std::vector<const EnergyTerm*> terms_;
  /// The places of the blocks of each term.
  std::vector<PairPlaces> places_of_terms_;
  /// Room for values on the pattern of the materials, if that of the system is larger.
  std::vector<double> of_materials_;
  NodalVector rest_;
  /// Whether rest_ is the rest with these terms.
  bool is_settled_ = true;
  double energies_at_rest_ = 0;
  std::optional<RestStability> rest_stability_{RestStability{}};
  std::size_t kept_factors_;
  /// The precision that was asked for, and whether the tangent at rest with nothing held is safe in
  /// single precision; empty: not known yet.
  Precision precision_;
  std::optional<bool> rest_is_safe_;
  /// Whether a tangent of this solve was not safe in single precision. Later ones are unlikely to
  /// be safe, so single precision is not tried for them.
  bool single_fails_ = false;
  std::list<KeptFactor> factors_;
  /// How often the pattern has grown.
  long pattern_age_ = 0;
  /// A solver that has analysed the pattern and whose factor, if any, is not needed; null: there is
  /// none.
  std::unique_ptr<LinearSolver> spare_solver_;
  /// The factor at rest; null until it is needed, or if it cannot be made.
  std::unique_ptr<RestFactor> rest_factor_;
  long pattern_age_of_rest_factor_ = 0;
  /// The largest number of held unknowns for which the factor at rest is used.
  Index most_shared_ = 0;
  /// Whether the tangent at rest is singular when nothing is held.
  bool body_floats_ = false;
  /// Whether the factor at rest serves the present tool; empty: not known yet.
  std::optional<bool> is_shared_;
  long uses_ = 0;
  Work work_;
  /// The mean diagonal of the tangent of the undeformed body, N/m, and the reciprocal norms of its
  /// rows, m/N.
  double mean_diagonal_ = 0;
  Eigen::VectorXd inverse_row_norm_;

  std::unique_ptr<Interaction> interaction_;
  std::vector<PrescribedPoint> prescribed_points_;
  /// The coordinate of each unknown; below zero: it is not held by the tool.
  std::vector<Index> coordinate_of_unknown_;
  std::vector<Coupling> couplings_;
  std::vector<Held> held_;
  /// Solves by iteration; null if there are factors.
  std::unique_ptr<KrylovTangent> krylov_;
  /// Positions of the values of multipliers that no free unknown is coupled with, off the diagonal
  /// and on it.
  std::vector<Index> idle_;
  std::vector<Index> idle_diagonal_;

  /// The tangent of the undeformed body with nothing held.
  std::vector<double> undeformed_;
  /// The memory of the last tangent; null before the first.
  std::shared_ptr<CondensedTangent> last_tangent_;
  /// Whether the last tangent belongs to the present tool, so that a linear body can use it again.
  bool has_tangent_ = false;
};

}  // namespace palpate
