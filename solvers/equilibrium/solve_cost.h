// SPDX-License-Identifier: BSD-3-Clause
// The expected cost of the solves of a body, told before the first of them: a user who would wait
// an hour, or whose machine has too little memory, wants to know it before.
//
// Residual and tangent are timed, and the body is ordered, so that the size of its factor is known.
// To factorise all of it may take minutes. So a part of the body, with the other points held, is
// factorised, and the time is scaled by
//
//   t ~ b^1.28 for a factorisation, t ~ b for a solve, where b is the size of the factor in bytes
//
// as was measured on cubes of 6 000 to 300 000 unknowns (tests/benchmark/growth.cpp). The count of
// operations grows with b^1.5, but large factors are made more efficiently than small ones.
//
// If the body is solved for without a factor (tangent_solver.h), three columns are solved for at
// rest; an equilibrium takes a multiple of that time.
#pragma once

#include <string>

#include "assembly/scene.h"

namespace palpate {

/// The times of the parts of a solve, with factors in full precision.
struct SolveCost {
  Index num_unknowns = 0;
  /// The length of a state, see Assembly::state_size().
  Index state_size = 0;
  /// Time of one operation, s; a solve has one right-hand side.
  double residual_seconds = 0;
  double assembly_seconds = 0;
  double factorisation_seconds = 0;
  double solve_seconds = 0;
  /// Time of a preconditioner and three columns, if there is no factor; the two above are 0 then.
  double iteration_seconds = 0;
  [[nodiscard]] bool has_factor() const { return iteration_seconds == 0; }
  /// Memory of a factor with the indices and the work space of its library, bytes.
  double factor_bytes = 0;
  /// Memory of everything else that a solver has of the body, bytes.
  double body_bytes = 0;
};

/// Measures the cost. This takes about a second for 100 000 unknowns, and hardly any time for
/// 10 000.
/// @param scene A scene that check() accepts.
/// @param linear_solver One of tangent_solver_names(); empty: the one that suits the body.
/// @param threads As in EquilibriumOptions.
/// @throws InputError as Assembly, or there is no solver of that name.
/// @throws BackendError the body cannot be ordered.
[[nodiscard]] SolveCost measure_solve_cost(const Scene& scene,
                                           const std::string& linear_solver = {}, int threads = 0);

/// How often each operation is done.
struct WorkCount {
  double factorisations = 0;
  double right_hand_sides = 0;
  double residuals = 0;
  double assemblies = 0;
  /// Without a factor, the time of all of it in times of three columns at rest, as measured for an
  /// equilibrium on cubes of 20 000 to 300 000 unknowns (tests/benchmark/large.cpp).
  double columns_at_rest = 3.5;
};

/// The time of some work, s.
/// @param single_precision The precision of the factors.
[[nodiscard]] double seconds_of(const WorkCount& work, const SolveCost& cost,
                                bool single_precision);

/// The work of an equilibrium one step away from rest, with its sensitivity, in full precision.
[[nodiscard]] WorkCount work_of_equilibrium();

/// The memory of a solver, bytes.
/// @param kept_factors The number of factors that are in memory at the same time.
[[nodiscard]] double solver_bytes(const SolveCost& cost, double kept_factors,
                                  bool single_precision);

}  // namespace palpate
