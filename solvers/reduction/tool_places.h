// SPDX-License-Identifier: BSD-3-Clause
// Reduced models of one body whose tools attach anywhere: the body is trained with tools at some
// places, and the result serves tools at other places.
//
// The training gives modes Ψ of the whole body, orthonormal in its stiffness K₀ at rest: modes of
// equilibria and of motion with the tools at each of the places, without the linear response to the
// tools. With gravity, rest is the equilibrium under the weight of the body, and displacements
// count from there. Tools are then bonded to any patches. Let C select the rows of u at all points
// of the patches, and R be the rigid displacement of each tool, C L = R. Then
//
//   Z = K₀⁻¹Cᵀ,  S = C Z,  L = Z S⁻¹R,  LᵀK₀L = RᵀS⁻¹R
//
// are the linear responses and their stiffness. They are those of the body itself, however far away
// the places of training are, and a patch is held at each of its points. Φ, which vanishes there,
// is made of three groups, each of what the earlier groups leave:
//
//   1. The terms of second and third order of the expansion of the equilibrium in d.
//   2. The motion of the linear body with the tools along the paths of training, and its terms of
//      second and third order, without inertia of their own.
//   3. The modes of training with the most energy in its states, changed by the least amount in K₀
//      such that they vanish at the patches: PΨ, P = 1 − Z S⁻¹C.
//
// The first two groups are computed for the tools' own places, by some hundred solves with one
// factor, which is kept; only the third comes from other places. (On a liver, 90 modes of the
// places alone leave 14 % of the motion with the tool at another place, and 3 % together with the
// terms of that place, in the norm of K₀.) Points and their weights (hyper_reduction.h) are chosen
// for the tools' places, by equilibria and motion of the expansion and by states of training
// expressed in Φ: the forces of all points are exact at any state. This choice takes most of the
// time of attaching tools, and no equilibrium or motion of the whole body is computed.
// measure_model() gives the error with the tools at their places.
#pragma once

#include <memory>
#include <vector>

#include "reduction/build_reduced_model.h"

namespace palpate {

/// The result of a training at places.
struct TrainedPlaces {
  /// Ψ [3 num_points × modes], m/√J.
  Eigen::MatrixXd modes;
  /// Modal coordinates ΨᵀK₀u of the training states without their linear response [modes × states],
  /// √J.
  Eigen::MatrixXd states;
  /// Tool coordinates d of these states [tool coordinates × states], m.
  Eigen::MatrixXd tools;
  /// u_r [3 num_points], m, from which the states count; empty: there is no gravity.
  NodalVector rest;
  /// The largest displacement of each coordinate of a tool, m.
  double reach = 0;
  /// States that were left out because there was no equilibrium.
  int num_left_out = 0;
  /// EquilibriumOptions::abort_requested has ended the training; there is no result.
  bool aborted = false;
};

/// @param places For each place, the tools that are held together, one or several.
/// @param options The place modes and training paths are for each place.
/// @throws InputError as build_reduced_model(); no place, or places with different numbers of
///   tools.
[[nodiscard]] TrainedPlaces train_places(const Scene& scene,
                                         const std::vector<Rheology>& rheologies,
                                         const std::vector<std::vector<BondedPatch>>& places,
                                         const ReductionOptions& options);

/// Trains on several ranks, and keeps parts of the training during the run. The result is the same
/// to the bit for any number of ranks, and after the training was resumed.
/// @returns On rank 0 the result, on the others only whether it was aborted.
/// @note Collective. All arguments but callbacks and the file are the same on every rank.
[[nodiscard]] TrainedPlaces train_places(const Scene& scene,
                                         const std::vector<Rheology>& rheologies,
                                         const std::vector<std::vector<BondedPatch>>& places,
                                         const ReductionOptions& options, const TrainingRun& run);

class PlacedTools {
 public:
  /// Factorises the stiffness of the body at rest.
  /// @param scene, rheologies As in the training. All arguments must outlive this object.
  /// @throws InputError an invalid scene, or a training of another body.
  PlacedTools(const Scene& scene, const std::vector<Rheology>& rheologies,
              const TrainedPlaces& trained);
  ~PlacedTools();
  PlacedTools(PlacedTools&&) noexcept;
  PlacedTools& operator=(PlacedTools&&) noexcept;

  /// Builds the model with these tools, as many as at each place of training.
  /// @param options Its modes, points, tolerance and seed are used. Its gravity must be that of the
  ///   training.
  /// @throws InputError no tool, or another number of them; tools that share a point, or have one
  ///   that does not exist, is in no cell, is fixed, or is on a part of the body without a place;
  ///   an option out of its range; gravity, and a training without it, or the reverse.
  [[nodiscard]] BuiltModel attach(const std::vector<BondedPatch>& tools,
                                  const ReductionOptions& options) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
