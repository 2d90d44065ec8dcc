// SPDX-License-Identifier: BSD-3-Clause
// Reduced models of one body whose tools attach anywhere: the body is trained with tools at some
// places, and what it learns there serves tools at others.
//
// The training leaves modes Ψ of the whole body, orthonormal in its stiffness K₀ at rest: of what
// equilibria and motion with the tools at each of the places have beside the linear response to
// them. Rest is where the body settles under its weight, where there is gravity, and displacements
// count from there. Tools are then bonded to any patches. With C the rows of u at all points of
// them, and R the rigid displacement of each tool, C L = R,
//
//   Z = K₀⁻¹Cᵀ,  S = C Z,  L = Z S⁻¹R,  LᵀK₀L = RᵀS⁻¹R
//
// are the linear responses and their stiffness. They are those of the body itself, however far away
// the places of training are, and a patch is held at each of its points. Φ, which vanishes there,
// is made of three groups, each of what those before it leave:
//
//   1. The terms of second and third order of the equilibrium's expansion in d.
//   2. The motion of the linear body with the tools along the paths of training, and its terms of
//      second and third order, whose own inertia is left out.
//   3. The modes of training that have most energy in its states, brought to vanish at the patches
//      by the least change in K₀: PΨ, P = 1 − Z S⁻¹C.
//
// The first two are those of the place itself, for some hundred solves with one factor, which is
// kept; what is taken from other places is the rest. (On a liver, 90 modes of the places alone
// leave 14 % of the motion with the tool at another one, and with the terms of that place 3 %, in
// the norm of K₀.) Points and their weights (hyper_reduction.h) are chosen for the place, by
// equilibria and motion of the expansion and states of training as Φ has them, as the forces of all
// points at them are exact, wherever they are. It takes most of the time that tools take to attach,
// and no equilibrium or motion of the whole body. measure_model() tells the error with the tools
// where they are.
#pragma once

#include <memory>
#include <vector>

#include "reduction/build_reduced_model.h"

namespace palpate {

/// What the training leaves.
struct TrainedPlaces {
  /// Ψ [3 num_points × modes], m/√J.
  Eigen::MatrixXd modes;
  /// ΨᵀK₀u of what the training states have beside the linear response [modes × states], √J.
  Eigen::MatrixXd states;
  /// d of these states [tool coordinates × states], m.
  Eigen::MatrixXd tools;
  /// u_r [3 num_points], m, from which the states count; empty: there is no gravity.
  NodalVector rest;
  /// How far each coordinate of a tool went, m.
  double reach = 0;
  /// States that were left out: there was no equilibrium.
  int num_left_out = 0;
  /// Training was ended by EquilibriumOptions::abort_requested; there is nothing else.
  bool aborted = false;
};

/// @param places The tools that are held at a time: one at each place, or several.
/// @param options Its place modes and training paths are those of each place.
/// @throws InputError as build_reduced_model(); no place, or places with different numbers of
///   tools.
[[nodiscard]] TrainedPlaces train_places(const Scene& scene,
                                         const std::vector<Rheology>& rheologies,
                                         const std::vector<std::vector<BondedPatch>>& places,
                                         const ReductionOptions& options);

/// The same on ranks, whose training is kept while it is under way. What it leaves is the same to
/// the bit for any number of ranks, and where the training was taken up again.
/// @returns On rank 0 all of it, on the others only whether it was aborted.
/// @note Collective. All is the same on every rank but callbacks and the file.
[[nodiscard]] TrainedPlaces train_places(const Scene& scene,
                                         const std::vector<Rheology>& rheologies,
                                         const std::vector<std::vector<BondedPatch>>& places,
                                         const ReductionOptions& options, const TrainingRun& run);

class PlacedTools {
 public:
  /// Factorises the body's stiffness at rest.
  /// @param scene, rheologies As those of the training. All must outlive this object.
  /// @throws InputError an invalid scene; sizes that do not belong to it.
  PlacedTools(const Scene& scene, const std::vector<Rheology>& rheologies,
              const TrainedPlaces& trained);
  ~PlacedTools();
  PlacedTools(PlacedTools&&) noexcept;
  PlacedTools& operator=(PlacedTools&&) noexcept;

  /// The body with these tools, as many as at each place of training.
  /// @param options Its modes, points, tolerance and seed count; its gravity is that of the
  /// training.
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
