// SPDX-License-Identifier: BSD-3-Clause
// The discrete body with its sites held: the linear systems that are solved on the way to an
// equilibrium. With i the free unknowns and a those of the sites, K_ii is kept on the pattern of the
// whole body, the rows and columns of a replaced by a multiple of the identity, so that one symbolic
// analysis serves every choice of sites.
#pragma once

#include <memory>
#include <vector>

#include "assembly/assembly.h"
#include "equilibrium/constraint.h"
#include "equilibrium/work.h"
#include "linear/linear_solver.h"

namespace palpate {

/// A factor of K_ii, and the state whose tangent it is of; empty: none.
struct TangentFactor {
  std::unique_ptr<LinearSolver> solver;
  NodalVector state;
  /// When it was made, and last asked for.
  long made = 0;
  long last_use = 0;
};

class HeldBody {
 public:
  /// @param scene Checked.
  /// @param kept_factors At least 2: that of the start of a step and that of where it is.
  /// @throws InputError a body that the linear solver cannot factorise.
  /// @param precision Of factors; a saddle has those of full precision in any case.
  HeldBody(const Scene& scene, std::unique_ptr<LinearSolver> solver, int kept_factors,
           Precision precision);

  /// @throws InputError a point that does not exist, is in no cell, is fixed, or is named twice.
  void hold(const Constraint& constraint);

  [[nodiscard]] const Assembly& assembly() const { return assembly_; }
  [[nodiscard]] const Constraint& constraint() const { return constraint_; }
  [[nodiscard]] const Work& work() const { return work_; }
  [[nodiscard]] const TetMesh& mesh() const { return mesh_; }
  [[nodiscard]] const std::vector<char>& fixed() const { return fixed_; }
  /// 3 num_sites.
  [[nodiscard]] Index num_parameters() const { return 3 * constraint_.num_sites; }
  /// The equilibrium is a saddle of the energy: there are pressures.
  [[nodiscard]] bool is_saddle() const { return assembly_.num_pressures() > 0; }

  /// A displacement that matters when the sites are at t: |t|, or a thousandth of an edge, m.
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& t) const;
  /// Largest component of a residual, each over the norm of its row of the tangent at rest, m: of a
  /// soft part beside a stiff one the residual counts as much.
  [[nodiscard]] double norm(const Eigen::VectorXd& r) const;
  /// Root of the sum of squares of the same, m.
  [[nodiscard]] double euclidean_norm(const Eigen::VectorXd& r) const;

  /// Energy at a state, J; the force stays for residual() and reaction().
  double evaluate(const NodalVector& state);
  /// Of the last evaluation: the components that must vanish, by unknown; zero for those of sites.
  void residual(Eigen::VectorXd& r) const;
  /// Of the last evaluation: the force that holds each site [num_parameters], N.
  [[nodiscard]] Eigen::VectorXd reaction() const;

  /// Puts the points of the sites at t.
  void place_sites(const Eigen::VectorXd& t, NodalVector& state) const;
  /// The free unknowns of a change of the state, those of sites 0.
  [[nodiscard]] Eigen::VectorXd as_unknowns(const NodalVector& state) const;
  /// A change of the unknowns as a change of the state.
  [[nodiscard]] NodalVector as_state(const Eigen::VectorXd& unknowns) const;

  /// The factor of the tangent at a state, if it is kept; else null.
  [[nodiscard]] TangentFactor* find_factor(const NodalVector& state);
  /// The factors that are kept now are of states that others may start from: those that are made
  /// from now on are replaced first.
  void begin_solve() { uses_before_solve_ = uses_; }
  /// Gives the place of the factor at a state free.
  void forget(const NodalVector& state);
  /// The tangent at a state, for k_ia(), k_aa() and times_tangent().
  void assemble_tangent(const NodalVector& state);
  /// Assembles and factorises the tangent at a state, in place of the factor not used for longest;
  /// null where it is singular. A linear body has one factor for all states.
  [[nodiscard]] TangentFactor* factorise(const NodalVector& state) {
    return factorise(state, precision_);
  }
  /// The same, with the given precision.
  [[nodiscard]] TangentFactor* factorise(const NodalVector& state, Precision precision);
  void solve(TangentFactor& factor, Eigen::Ref<Eigen::MatrixXd> columns);
  /// Negative pivots beyond the one that each pressure has by right.
  [[nodiscard]] int negative_pivots(const TangentFactor& factor) const;
  /// K_ii x of the last tangent, column by column.
  [[nodiscard]] Eigen::MatrixXd times_tangent(const Eigen::MatrixXd& columns) const;
  /// K_ia [unknowns × num_parameters] and K_aa of the last tangent.
  [[nodiscard]] const Eigen::MatrixXd& k_ia() const { return k_ia_; }
  [[nodiscard]] const Eigen::MatrixXd& k_aa() const { return k_aa_; }

  /// 1-norm condition number of the last tangent, estimated. Costs a few solves.
  [[nodiscard]] double condition(TangentFactor& factor) const;

 private:
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

  void analyse(LinearSolver& solver);
  void assemble(const NodalVector& state);
  TangentFactor& factor_to_replace();
  [[nodiscard]] std::vector<char> find_idle_multipliers() const;

  TetMesh mesh_;
  std::vector<char> fixed_;
  Assembly assembly_;
  std::size_t kept_factors_;
  Precision precision_;
  std::vector<TangentFactor> factors_;
  long uses_ = 0;
  long uses_before_solve_ = 0;
  Work work_;
  /// Mean diagonal of the tangent at rest, N/m, and one over the norm of each of its rows, m/N.
  double mean_diagonal_ = 0;
  Eigen::VectorXd inverse_row_norm_;

  Constraint constraint_;
  /// Parameter of each unknown, −1 for those that are not held.
  std::vector<Index> parameter_of_unknown_;
  std::vector<Coupling> couplings_;
  std::vector<Held> held_;
  /// Values of multipliers that no free unknown feels, off the diagonal and on it.
  std::vector<Index> idle_;
  std::vector<Index> idle_diagonal_;

  /// ∂Π/∂x of the last evaluation.
  NodalVector force_;
  std::vector<double> values_;
  /// values_ is the tangent at rest, as assembled.
  bool has_rest_tangent_ = false;
  Eigen::MatrixXd k_ia_;
  Eigen::MatrixXd k_aa_;
};

}  // namespace palpate
