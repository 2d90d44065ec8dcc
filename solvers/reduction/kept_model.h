// SPDX-License-Identifier: BSD-3-Clause
// A reduced model with its errors, kept in a state-space file (storage/state_space_file.h). A
// complete model in the file is read; an unfinished training is resumed.
//
// Besides the arrays of reduced/model_arrays.h, a model has in the file
//
//   Basis        (Φ, L) [3 num_points × coordinates]
//   Rest         u_r [3 num_points × 1], m; only under gravity
//   ActiveNodes  [tools × 1]
//   Fit          [1 × 2]   BuiltModel::residual, and 1 if it is within the tolerance
//   Errors       [cases × 11]   MeasuredError: the number of its kind among kErrorKinds, then
//                mean, rms, max, largest force (N), largest trust, compared, failed, median,
//                longest and whole step (s)
//
// If the tools attach anywhere (tool_places.h), the result of the training at the places is an
// entry of its own in the file, which serves all models whose tools are attached later:
//
//   PlaceModes   [3 num_points × modes]   TrainedPlaces::modes
//   PlaceStates  [modes × states]         TrainedPlaces::states
//   PlaceTools   [tool coordinates × states]
//   PlaceRest    u_r [3 num_points × 1], m; only under gravity
//   PlaceReach   [1 × 2]   m, and the number of states that were left out
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reduction/build_reduced_model.h"
#include "reduction/measure_model.h"
#include "reduction/tool_places.h"

namespace palpate {

/// The tools that a model is built for.
struct ReductionTools {
  std::vector<BondedPatch> patches;
  /// The node that each patch is around.
  std::vector<Index> nodes;
  /// The tools at each place of training; empty: they are trained at their own places.
  std::vector<std::vector<BondedPatch>> places;
};

/// The result of a training at places.
struct KeptPlaces {
  /// See key_of_places(); empty: there is no result.
  std::string key;
  TrainedPlaces trained;
};

struct KeptModel {
  ReducedModel model;
  /// See BuiltModel.
  Eigen::MatrixXd basis;
  NodalVector rest;
  double residual = 0;
  bool within_tolerance = false;
  std::vector<MeasuredError> errors;
  /// The file had the complete model, so that the whole body was not solved for.
  bool was_there = false;
  /// The file had the result of the training at ReductionTools::places: the tools were only
  /// attached and measured.
  bool were_places_there = false;
  /// There is no model, or not all of its errors. What was found in training is kept.
  bool aborted = false;
  /// Why the file does not keep the model or its errors, if nothing had to be trained: it cannot be
  /// written. Empty: it keeps them.
  std::string not_kept;
  /// Damaged parts of the file, see StateSpaceFile::left_out(), which were computed again.
  std::vector<std::string> damaged;
};

/// The key of a model in a file: a checksum of the scene, rheologies, tools and options.
[[nodiscard]] std::string key_of_model(const Scene& scene, const std::vector<Rheology>& rheologies,
                                       const ReductionTools& tools,
                                       const ReductionOptions& options);

/// The key of a training at places in a file: a checksum of the scene, rheologies, places and those
/// options on which the training depends.
[[nodiscard]] std::string key_of_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                                        const std::vector<std::vector<BondedPatch>>& places,
                                        const ReductionOptions& options);

/// Reads the result of a training at places from the file, or trains and stores it there.
/// @param file Only rank 0 has it; null: `kept` is taken if it has the same key.
/// @param kept On rank 0 the result; on the others only whether it was aborted.
/// @returns Whether the result was there already, on every rank.
/// @throws InputError as train_places(); an array in the file that is missing.
/// @throws BackendError the file cannot be written.
/// @note Collective
bool keep_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                 const std::vector<std::vector<BondedPatch>>& places,
                 const ReductionOptions& options, StateSpaceFile* file, Communicator& communicator,
                 KeptPlaces& kept);

/// Reads the model, or builds and measures it. Errors that were measured on another number of paths
/// are measured again.
/// @param file It is created if it does not exist; empty: nothing is kept. It is written only if
///   something is added, and needs to be writable only if something is to be trained. The solver
///   tolerance of its scene is that of `options.equilibrium`.
/// @param places On rank 0, without a file: a result of a training at places is taken from here,
///   and left here; may be null.
/// @returns On rank 0 all of it, on the others only whether it was aborted.
/// @throws InputError as build_reduced_model(), or as train_places() and PlacedTools::attach(); a
///   file of another scene or tolerance.
/// @throws BackendError the file cannot be read, or not be written for what is to be trained.
/// @note Collective
[[nodiscard]] KeptModel build_kept_model(
    const Scene& scene, const std::vector<Rheology>& rheologies, const ReductionTools& tools,
    const ReductionOptions& options, const MeasureOptions& measure,
    const std::filesystem::path& file, Communicator& communicator, KeptPlaces* places = nullptr);

}  // namespace palpate
