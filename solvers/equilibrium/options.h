// SPDX-License-Identifier: BSD-3-Clause
// How an equilibrium is searched for.
#pragma once

#include <functional>

namespace palpate {

struct EquilibriumOptions {
  /// A solve has converged when no component of the residual exceeds this share of what the node
  /// would take to be displaced by the tool: the norm of its row of the tangent at rest times the
  /// larger of |t| and a thousandth of the mean edge. 1e-10 leaves the reaction with a relative
  /// error far below 1e-8.
  double tolerance = 1e-10;
  /// Besides, Newton's method must not move the body by more than this share of the larger of |t|
  /// and a thousandth of the mean edge. Where rounding allows no better than 1e-6, as with
  /// stiffnesses that differ by 1e9, the solve has converged too and flags::inaccurate is set.
  [[nodiscard]] double displacement_error() const { return 100 * tolerance; }
  /// The largest number of iterations of one step.
  int max_iterations = 60;
  /// A step may be halved this often: 1/256 of the way.
  int max_halvings = 8;
  /// The largest number of steps of one solve, failed ones included.
  int max_steps = 600;
  /// The longest time for one solve, s; 0: there is no bound. A factorisation is not interrupted.
  double max_seconds = 0;
  /// A factor serves as long as the steps shrink from one to the next to at most this share, in the
  /// mean since the factor was made. A factorisation costs about as much as twenty-five iterations.
  double contraction = 0.7;
  /// Where a step fails however small it is, as at a fold, the equilibrium path is followed round
  /// the folds to where it reaches t. If that fails, or without this option, the body jumps to the
  /// equilibrium that the energy falls to, if there is one; without it, at once where that is
  /// inverted.
  bool follow_folds = true;
  /// The number of factors of tangents that are kept, at least 2: those of the states that were
  /// used last. Solves that start from such a state save its factorisation. From 3 on, one of them
  /// can be that at rest, which all tools share.
  int kept_factors = 2;
  /// Factors are in single precision where the tangent is far from singular. They take two thirds
  /// of the time, with as many iterations; v has a relative error of 1e-8 then. Energies and
  /// residuals are always in double precision.
  bool single_precision = false;
  /// Whether an equilibrium of a tool with three coordinates has its third derivative, for about a
  /// tenth of the time of a solve.
  bool third_derivatives = false;
  /// How many threads solve for a large body that is solved for without a factor, which is the same
  /// to the bit for any number of them; 0: as many as automatic_threads() says
  /// (threads/thread_team.h). With a factor it is without effect.
  int threads = 0;
  /// It is called before each iteration; true ends the solve with Outcome::aborted.
  std::function<bool()> abort_requested;
};

/// @throws InputError a field out of its range, by name.
void validate(const EquilibriumOptions& options);

}  // namespace palpate
