// SPDX-License-Identifier: BSD-3-Clause
// A reduced model with its errors, kept in a state-space file (state_space/state_space_file.h): one
// that is complete there is read, the training of one that is not goes on from what it has found.
//
// Beside the arrays of reduced/model_arrays.h a model has in the file
//
//   Basis        (Φ, L) [3 num_points × coordinates]
//   Rest         u_r [3 num_points × 1], m; only under gravity
//   ActiveNodes  [tools × 1]
//   Fit          [1 × 2]   BuiltModel::residual, and 1 where it is within the tolerance
//   Errors       [cases × 11]   MeasuredError: the number of its kind among kErrorKinds, then
//                mean, rms, max, largest force (N), largest trust, compared, failed, median,
//                longest and whole step (s)
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reduction/build_reduced_model.h"
#include "reduction/measure_model.h"

namespace palpate {

/// What a model is built from.
struct ReductionTools {
  std::vector<BondedPatch> patches;
  /// Of each, the node that it is around.
  std::vector<Index> nodes;
};

struct KeptModel {
  ReducedModel model;
  /// See BuiltModel.
  Eigen::MatrixXd basis;
  NodalVector rest;
  double residual = 0;
  bool within_tolerance = false;
  std::vector<MeasuredError> errors;
  /// It was complete in the file: the whole body was not solved for.
  bool was_there = false;
  /// There is no model, or not all errors. What was found in training is kept.
  bool aborted = false;
  /// What was damaged in the file, as StateSpaceFile::left_out(), and was computed again.
  std::vector<std::string> damaged;
};

/// The key of a model in a file: a checksum of the scene, rheologies, tools and options.
[[nodiscard]] std::string key_of_model(const Scene& scene, const std::vector<Rheology>& rheologies,
                                       const ReductionTools& tools,
                                       const ReductionOptions& options);

/// Reads the model, or builds and measures it.
/// @param file Is made where it is not there; empty: nothing is kept. The solver tolerance of its
///   scene is that of `options.equilibrium`. Errors that were measured on another number of paths
///   are measured again.
/// @returns On rank 0 all of it, on the others only whether it was aborted.
/// @throws InputError as build_reduced_model(); a file of another scene or tolerance.
/// @throws BackendError the file cannot be written.
/// @note Collective
[[nodiscard]] KeptModel build_kept_model(
    const Scene& scene, const std::vector<Rheology>& rheologies, const ReductionTools& tools,
    const ReductionOptions& options, const MeasureOptions& measure,
    const std::filesystem::path& file, Communicator& communicator);

}  // namespace palpate
