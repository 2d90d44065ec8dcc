// SPDX-License-Identifier: BSD-3-Clause
// The discrete body together with a tool, condensed to the unknowns that are free: the residuals
// and linear systems on the way to an equilibrium. With i the free unknowns and a those of the
// points that the tool prescribes, K_ii is kept on the pattern of the whole body, the rows and
// columns of a replaced by a multiple of the identity, so that one symbolic analysis serves every
// tool; and so does one factor of the tangent at rest, where a solve for each unknown that is held
// costs less than a factorisation (rest_factor.h).
#pragma once

#include <cmath>
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
#include "equilibrium/work.h"
#include "interaction/interaction.h"
#include "linear/linear_solver.h"

namespace palpate {

/// Energies are sums over the body: those that differ by less than this share are equal but for
/// rounding.
inline constexpr double kEnergyRounding = 1e-11;

/// The energy of a body and a tool at a state, and its first derivatives.
struct Evaluation {
  /// Π, J; not finite where it is not defined, as in a cell that is turned inside out.
  double energy = 0;
  /// ∂Π/∂x of every component of the state, N.
  NodalVector force;
  /// ∂Φ/∂q of the tool's potential [num_coordinates], N where q is a length.
  Eigen::VectorXd of_coordinates;

  [[nodiscard]] bool is_finite() const { return std::isfinite(energy); }
};

class CondensedSystem {
 public:
  /// @param scene It was checked, see check().
  /// @param solver Null: there is no factor, and tangents are solved for by iteration.
  /// @param kept_factors At least 2: the factors at the start of a step and where it has come to.
  /// @throws InputError a body that the linear solver cannot factorise.
  /// @param precision That of factors. They have full precision in any case for a saddle, and for a
  ///   body whose tangent at rest is too near to singular for others.
  CondensedSystem(const Scene& scene, std::unique_ptr<LinearSolver> solver, int kept_factors,
                  Precision precision);

  /// Chooses the tool.
  /// @throws InputError it has no coordinates, or prescribes a point that does not exist, is in no
  ///   cell, is fixed or held along a direction, or is named twice.
  void set_interaction(const Interaction& interaction);

  /// Gives the body energies besides that of its materials, and forgets all factors. Call this
  /// again when a term has changed by more than what a factor of before still approximates: it
  /// finds anew how stiff each unknown is.
  /// @param terms They must outlive this object, or the next call.
  void set_terms(std::vector<const EnergyTerm*> terms);

  /// The state from which the coordinates of tools count that prescribe points; the undeformed one
  /// until this is called.
  void set_rest(const NodalVector& state) { rest_ = state; }

  [[nodiscard]] const Assembly& assembly() const { return assembly_; }
  /// To change the materials with, see Assembly::scale_energy(); call set_terms() afterwards.
  [[nodiscard]] Assembly& assembly() { return assembly_; }
  /// The tool. Call set_interaction() before.
  [[nodiscard]] const Interaction& interaction() const { return *interaction_; }
  [[nodiscard]] const std::vector<PrescribedPoint>& prescribed_points() const {
    return prescribed_points_;
  }
  [[nodiscard]] const Work& work() const { return work_; }
  [[nodiscard]] const TetMesh& mesh() const { return mesh_; }
  /// See supports.h.
  [[nodiscard]] const std::vector<char>& holding_points() const { return holding_points_; }
  /// d; 0 without a tool.
  [[nodiscard]] Index num_coordinates() const {
    return interaction_ == nullptr ? 0 : interaction_->num_coordinates();
  }
  /// Whether the tool at q is in the body, through its surface.
  [[nodiscard]] bool tool_is_inside(const Eigen::VectorXd& q, const NodalVector& state) const;
  /// Whether the body is at rest and the tool away from it, so that nothing is felt.
  [[nodiscard]] bool feels_nothing(const Eigen::VectorXd& q, const NodalVector& state) const;
  /// Tangents have no factor, so that nothing may be asked for that needs one.
  [[nodiscard]] bool is_iterative() const { return krylov_ != nullptr; }
  /// The tangent is the same at all states.
  [[nodiscard]] bool is_linear() const {
    return assembly_.is_linear() && !has_potential() && terms_.empty();
  }
  /// The equilibrium is a saddle of the energy: there are pressures.
  [[nodiscard]] bool is_saddle() const { return assembly_.num_pressures() > 0; }

  /// A displacement that matters when the tool is at q: that of the tool, or a thousandth of an
  /// edge, m.
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& q) const;
  /// Largest component of a residual, each over the norm of its row of the tangent at rest, m: so
  /// the residual of a soft part counts as much as that of a stiff one.
  [[nodiscard]] double norm(const Eigen::VectorXd& r) const;
  /// Root of the sum of squares of the same, m.
  [[nodiscard]] double euclidean_norm(const Eigen::VectorXd& r) const;

  /// The energy and the forces at a state with the tool at q.
  [[nodiscard]] Evaluation evaluate(const Eigen::VectorXd& q, const NodalVector& state);
  /// The components of the force that must vanish, by unknown; zero for those that are held.
  [[nodiscard]] Eigen::VectorXd residual(const Evaluation& at) const;
  /// h, the force that holds the tool [num_coordinates], N.
  [[nodiscard]] Eigen::VectorXd reaction(const Evaluation& at) const;

  /// Puts the points that the tool prescribes to where it is at q: u = u_rest + q.
  void prescribe(const Eigen::VectorXd& q, NodalVector& state) const;
  /// Makes the change of the points that the tool prescribes that of q.
  void prescribe_change(const Eigen::VectorXd& of_q, NodalVector& of_state) const;
  /// s of each pressure, Pa/m.
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> pressure_scale() const;
  /// The vector x = (u, p̂) of a state.
  [[nodiscard]] NodalVector vector_of(const LinearisedState& state) const;
  /// ∂x/∂t [state_size × d].
  [[nodiscard]] Eigen::MatrixXd sensitivity_of(const LinearisedState& state) const;
  /// A change of the state as a change of the unknowns; those that are held are 0.
  [[nodiscard]] Eigen::VectorXd as_unknowns(const NodalVector& state) const;
  /// Takes out of a state what points that are held along directions cannot do.
  void hold_directions(NodalVector& state) const { constraints_.project_state(state); }
  /// A change of the unknowns as a change of the state.
  [[nodiscard]] NodalVector as_state(const Eigen::VectorXd& unknowns) const;

  /// Call this before each solve, so that its result does not depend on the solves before.
  void begin_solve();

  /// The factor of the tangent at a state with the tool at q; null unless it is kept.
  [[nodiscard]] TangentFactor* find_factor(const Eigen::VectorXd& q, const NodalVector& state);
  /// Makes the factor at a state, if it is kept, the next to be replaced.
  void forget(const Eigen::VectorXd& q, const NodalVector& state);
  /// Assembles the tangent at a state for mixed(), of_coordinates() and times_tangent().
  void assemble_tangent(const Eigen::VectorXd& q, const NodalVector& state);
  /// Assembles and factorises the tangent at a state, in place of the factor not used for longest;
  /// null where it is singular. A linear body has one factor for all states, and where it can be,
  /// the one at rest is that of all tools. A factor follows from the scene, the tool and the state
  /// alone: one that is made again is the same.
  [[nodiscard]] TangentFactor* factorise(const Eigen::VectorXd& q, const NodalVector& state);
  /// Does the same for this state and this tool alone and in full precision, so that the factor
  /// is not rough. It is valid until the next one is made.
  [[nodiscard]] TangentFactor* factorise_accurately(const Eigen::VectorXd& q,
                                                    const NodalVector& state);
  void solve(TangentFactor& factor, Eigen::Ref<Eigen::MatrixXd> columns);
  /// By iteration, for the last tangent, see KrylovTangent::solve().
  [[nodiscard]] SolveSummary solve(Eigen::Ref<Eigen::MatrixXd> columns, double tolerance);
  /// The same of its inertia.
  [[nodiscard]] Inertia find_inertia();
  /// The number of negative pivots beyond the one that belongs to each pressure.
  [[nodiscard]] int negative_pivots(const TangentFactor& factor) const;
  /// K_ii x of the last tangent for each column x.
  [[nodiscard]] Eigen::MatrixXd times_tangent(const Eigen::MatrixXd& columns) const;
  /// ∂²Π/∂x_i∂q [unknowns × num_coordinates] and ∂²Π/∂q² of the last tangent.
  [[nodiscard]] const Eigen::MatrixXd& mixed() const { return mixed_; }
  [[nodiscard]] const Eigen::MatrixXd& of_coordinates() const { return of_coordinates_; }

  /// An estimate of the 1-norm condition number of the last tangent. It costs a few solves.
  [[nodiscard]] double condition(TangentFactor& factor) const;

 private:
  /// A value of the pattern that couples an unknown that is held with one that is not.
  struct Coupling {
    Index position;
    Index unknown;
    Index coordinate;
  };
  /// A value of the pattern between two unknowns that are held.
  struct Held {
    Index position;
    Index coordinate_a;
    Index coordinate_b;
    bool diagonal;
  };

  /// A factor for the present tool, where the tool was, and the state at which it was made; empty:
  /// there is none.
  struct KeptFactor final : TangentFactor {
    explicit KeptFactor(std::unique_ptr<LinearSolver> with) : solver(std::move(with)) {}
    void solve(Eigen::Ref<Eigen::MatrixXd> columns) override { solver->solve(columns); }
    [[nodiscard]] int negative_pivots() const override { return solver->negative_pivots(); }
    [[nodiscard]] bool is_rough() const override { return solver->is_single(); }

    std::unique_ptr<LinearSolver> solver;
    Eigen::VectorXd q;
    NodalVector state;
    /// Single precision was not tried, as it had failed before in the same solve. Another solve
    /// would try it, and so does not take this factor.
    bool is_provisional = false;
    /// When it was made or last asked for.
    long last_use = 0;
  };

  [[nodiscard]] bool has_potential() const {
    return interaction_ != nullptr && interaction_->has_potential();
  }
  /// Orders the body.
  void take_solver(std::unique_ptr<LinearSolver> solver);
  void assemble(const NodalVector& state, std::vector<double>& values);
  /// Adds the derivatives of the terms. @returns Their energy, J.
  double add_terms(const NodalVector& state, NodalVector& force, std::vector<double>* values);
  /// Finds how stiff each unknown is at rest.
  void measure_rest();
  /// Adds the second derivatives of the tool's potential to the last tangent.
  void add_potential(const Eigen::VectorXd& q, const NodalVector& state);
  /// The place of a value of the pattern.
  [[nodiscard]] Index position(Index row, Index column) const;
  /// Whether the tangent at a state is that at rest.
  [[nodiscard]] bool is_as_at_rest(const Eigen::VectorXd& q, const NodalVector& state) const;
  /// Makes the rest factor serve the present tool if that can be, and tells whether it does. The
  /// last tangent must be that at rest.
  [[nodiscard]] bool shares_rest_factor();
  /// The relative error of the rest factor's solutions for the last tangent, roughly.
  [[nodiscard]] double error_of_rest_factor();
  /// The precision of factors that may be rough.
  [[nodiscard]] Precision usual_precision();
  [[nodiscard]] KeptFactor* factorise_alone(const Eigen::VectorXd& q, const NodalVector& state,
                                            Precision precision);
  [[nodiscard]] KeptFactor* find_kept_factor(const Eigen::VectorXd& q, const NodalVector& state);
  KeptFactor& factor_to_replace();
  /// Gives spare_solver_, and makes it if there is none.
  LinearSolver& spare_solver();
  [[nodiscard]] std::vector<char> find_idle_multipliers() const;

  TetMesh mesh_;
  std::vector<char> fixed_;
  std::vector<char> holding_points_;
  Assembly assembly_;
  DirectionConstraints constraints_;
  std::vector<const EnergyTerm*> terms_;
  NodalVector rest_;
  std::size_t kept_factors_;
  /// The precision that was asked for, and whether the tangent at rest with nothing held is safe in
  /// single precision; empty: that is not known yet.
  Precision precision_;
  std::optional<bool> rest_is_safe_;
  /// In this solve a tangent was not safe in single precision. The next ones on the way will hardly
  /// be, and are not tried.
  bool single_fails_ = false;
  std::vector<KeptFactor> factors_;
  /// A solver that is analysed and has no factor that is needed; null: all have one.
  std::unique_ptr<LinearSolver> spare_solver_;
  /// The factor at rest; null until it is asked for, and where there is none.
  std::unique_ptr<RestFactor> rest_factor_;
  /// The number of unknowns that are held up to which the factor at rest serves.
  Index most_shared_ = 0;
  /// Whether it serves the present tool; empty: that is not known yet.
  std::optional<bool> is_shared_;
  long uses_ = 0;
  Work work_;
  /// Mean diagonal of the tangent at rest, N/m, and one over the norm of each of its rows, m/N.
  double mean_diagonal_ = 0;
  Eigen::VectorXd inverse_row_norm_;

  std::unique_ptr<Interaction> interaction_;
  std::vector<PrescribedPoint> prescribed_points_;
  /// The coordinate of each unknown, −1 for those that are not held.
  std::vector<Index> coordinate_of_unknown_;
  std::vector<Coupling> couplings_;
  std::vector<Held> held_;
  /// For tangents without a factor; else null.
  std::unique_ptr<KrylovTangent> krylov_;
  /// Positions of the values of multipliers that no free unknown feels, off the diagonal and on it.
  std::vector<Index> idle_;
  std::vector<Index> idle_diagonal_;

  /// The tangent at rest with nothing held, and the last one, condensed.
  std::vector<double> rest_values_;
  std::vector<double> values_;
  /// For a linear body: the last tangent is that of the present tool.
  bool has_tangent_ = false;
  Eigen::MatrixXd mixed_;
  Eigen::MatrixXd of_coordinates_;
};

}  // namespace palpate
