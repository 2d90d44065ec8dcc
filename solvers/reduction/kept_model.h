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
//
// Where the tools attach anywhere (tool_places.h), what was trained at the places is in the file
// for itself, and serves all models whose tools are placed anew:
//
//   PlaceModes   [3 num_points × modes]   TrainedPlaces::modes
//   PlaceStates  [modes × states]         and the others of TrainedPlaces
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

/// What a model is built from.
struct ReductionTools {
  std::vector<BondedPatch> patches;
  /// Of each, the node that it is around.
  std::vector<Index> nodes;
  /// The tools at each place of training; empty: they are trained where they are.
  std::vector<std::vector<BondedPatch>> places;
};

/// What was trained at places.
struct KeptPlaces {
  /// See key_of_places(); empty: there is nothing.
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
  /// It was complete in the file: the whole body was not solved for.
  bool was_there = false;
  /// What it is made from was trained before, at ReductionTools::places: the tools were attached
  /// and measured.
  bool were_places_there = false;
  /// There is no model, or not all errors. What was found in training is kept.
  bool aborted = false;
  /// Why the model, or its errors, are not kept in the file, where nothing had to be trained: it
  /// cannot be written. Empty: they are.
  std::string not_kept;
  /// What was damaged in the file, as StateSpaceFile::left_out(), and was computed again.
  std::vector<std::string> damaged;
};

/// The key of a model in a file: a checksum of the scene, rheologies, tools and options.
[[nodiscard]] std::string key_of_model(const Scene& scene, const std::vector<Rheology>& rheologies,
                                       const ReductionTools& tools,
                                       const ReductionOptions& options);

/// The same of what is trained at the places: of the scene, rheologies, places and the options that
/// training follows from.
[[nodiscard]] std::string key_of_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                                        const std::vector<std::vector<BondedPatch>>& places,
                                        const ReductionOptions& options);

/// Takes what was trained at places from the file, or trains and keeps it there.
/// @param file Only rank 0 has it; null: it is taken from `kept` where that is of the same key.
/// @param kept On rank 0 what was trained; on the others only whether it was aborted.
/// @returns Whether it was there, on every rank.
/// @throws InputError as train_places(); an array in the file that is missing.
/// @throws BackendError the file cannot be written.
/// @note Collective
bool keep_places(const Scene& scene, const std::vector<Rheology>& rheologies,
                 const std::vector<std::vector<BondedPatch>>& places,
                 const ReductionOptions& options, StateSpaceFile* file, Communicator& communicator,
                 KeptPlaces& kept);

/// Reads the model, or builds and measures it.
/// @param file Is made where it is not there; empty: nothing is kept. It is written only where
///   something is to be added, and has to be only where something is to be trained. The solver
///   tolerance of its scene is that of `options.equilibrium`. Errors that were measured on another
///   number of paths are measured again.
/// @param places On rank 0, without a file: what was trained at places is taken from here, and left
///   here; may be null.
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
