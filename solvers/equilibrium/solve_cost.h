// SPDX-License-Identifier: BSD-3-Clause
// What the solves of a body will take, told before the first of them: a person who waits an hour
// wants to know it before, and one whose machine has too little memory too.
//
// Residual and tangent are timed, and the body is ordered, so that the size of its factor is known.
// A factor of all of it may take minutes, so that it is timed on a part of the body, whose other
// points are held, and the time is scaled by
//
//   t ~ b^1.28 for a factorisation, t ~ b for a solve, b the bytes of the factor
//
// which is what cubes of 6 000 to 300 000 unknowns take (tests/benchmark/growth.cpp); the count of
// operations grows with b^1.5, and large factors are made more efficiently than small ones.
//
// Where the body is solved for without a factor (tangent_solver.h), three columns are solved for at
// rest: an equilibrium takes a multiple of that.
#pragma once

#include <string>

#include "assembly/scene.h"

namespace palpate {

/// The parts of a solve, of which factors are in full precision.
struct SolveCost {
  Index num_unknowns = 0;
  /// The length of a state, see Assembly::state_size().
  Index state_size = 0;
  /// Time of one, s; a solve is with one right-hand side.
  double residual_seconds = 0;
  double assembly_seconds = 0;
  double factorisation_seconds = 0;
  double solve_seconds = 0;
  /// Without a factor: a preconditioner and three columns. Then the two above are 0.
  double iteration_seconds = 0;
  [[nodiscard]] bool has_factor() const { return iteration_seconds == 0; }
  /// What a factor takes in memory with the indices and the work space of its library, bytes.
  double factor_bytes = 0;
  /// The same of all else that a solver has of the body.
  double body_bytes = 0;
};

/// It takes about a second for 100 000 unknowns, and next to nothing for 10 000.
/// @param scene It was checked, see check().
/// @param linear_solver One of tangent_solver_names(); empty: the one that suits the body.
/// @param threads As in EquilibriumOptions.
/// @throws InputError as Assembly, or no solver of that name; BackendError the body cannot be
///   ordered.
[[nodiscard]] SolveCost measure_solve_cost(const Scene& scene,
                                           const std::string& linear_solver = {}, int threads = 0);

/// How often a part is done.
struct WorkCount {
  double factorisations = 0;
  double right_hand_sides = 0;
  double residuals = 0;
  double assemblies = 0;
};

/// @param work With a factor. Without one an equilibrium takes the same however it is reached.
/// @param single_precision Of the factors.
[[nodiscard]] double seconds_of(const WorkCount& work, const SolveCost& cost,
                                bool single_precision);

/// An equilibrium that is one step away from rest, with its sensitivity, in full precision.
[[nodiscard]] WorkCount work_of_equilibrium();

/// @param kept_factors How many factors are in memory at the same time.
[[nodiscard]] double solver_bytes(const SolveCost& cost, double kept_factors,
                                  bool single_precision);

}  // namespace palpate
