// SPDX-License-Identifier: BSD-3-Clause
// Options of the search for an equilibrium.
#pragma once

#include <functional>

namespace palpate {

struct EquilibriumOptions {
  /// A solve has converged if no component of the residual exceeds this share of the force that
  /// displaces its node as far as the tool: the norm of its row of the tangent at rest times the
  /// larger of |t| and a thousandth of the mean edge. 1e-10 leaves the reaction with a relative
  /// error far below 1e-8.
  double tolerance = 1e-10;
  /// In addition, the next Newton step must not move the body by more than this share of the larger
  /// of |t| and a thousandth of the mean edge. If rounding allows no better than 1e-6, as with
  /// stiffnesses that differ by 1e9, the solve counts as converged too, and flags::inaccurate is
  /// set.
  [[nodiscard]] double displacement_error() const { return 100 * tolerance; }
  /// The largest number of iterations of one step.
  int max_iterations = 60;
  /// A step may be halved this often, here to 1/256 of the distance.
  int max_halvings = 8;
  /// The largest number of steps of one solve, failed ones included.
  int max_steps = 600;
  /// The longest time of one solve, s; 0: there is no bound. A factorisation is not interrupted.
  double max_seconds = 0;
  /// A factor is used as long as, in the mean since it was made, each step is at most this share of
  /// the one before. A factorisation costs about as much as twenty-five iterations.
  double contraction = 0.7;
  /// If steps fail however short they are, as at a fold, the equilibrium path is followed around
  /// the folds to where it reaches t. If that fails, or without this option, the body jumps to the
  /// equilibrium to which the energy falls, if there is one; without the option it does so at once
  /// if that state is inverted.
  bool follow_folds = true;
  /// The number of factors of tangents that are kept, at least 2: those of the states that were
  /// used last. Solves that start from such a state save its factorisation. With 3 or more, one of
  /// them can be the factor at rest, which all tools share.
  int kept_factors = 2;
  /// Factors are in single precision if the tangent is far from singular. They take two thirds of
  /// the time, with as many iterations, and leave v with a relative error of 1e-8. Energies and
  /// residuals are always in double precision.
  bool single_precision = false;
  /// Whether an equilibrium of a tool with three coordinates gets its third derivative, which takes
  /// about a tenth of the time of a solve.
  bool third_derivatives = false;
  /// The number of threads for a body that is solved for without a factor; the result is the same
  /// to the bit for any number. 0: as automatic_threads() says (threads/thread_team.h). With a
  /// factor it has no effect.
  int threads = 0;
  /// Called before each iteration; true ends the solve with Outcome::aborted.
  std::function<bool()> abort_requested;
};

/// @throws InputError a field is out of its range; the message names it.
void validate(const EquilibriumOptions& options);

}  // namespace palpate
