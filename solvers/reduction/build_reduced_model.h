// SPDX-License-Identifier: BSD-3-Clause
// A reduced model (reduced/reduced_model.h) of a scene and the tools that hold it, from states of
// the whole body:
//
//   1. L and LᵀK₀L: the sensitivity and the stiffness of the equilibrium at rest, which is that
//      under the weight of the body where there is gravity.
//   2. States: equilibria with one tool moved and with all of them moved; with inertia, motion
//      along random paths with taps. (A basis of equilibria alone is of no use in motion. One of
//      the motion of the linear body, which would take one factorisation, leaves ten times the
//      error of one of the motion of the body itself, for half the time.)
//   3. Φ: POD modes of each of these groups in turn, of what the groups before leave.
//   4. Points and weights (hyper_reduction.h) for these states. The model that they make then goes
//      along the training paths itself, which takes a moment, and the points are chosen anew for
//      the states that it comes through besides: the forces of all points at them are exact,
//      wherever they are.
//
// Everything follows from the scene, the tools and the options, with the seed.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "assembly/scene.h"
#include "dynamics/tool_path.h"
#include "equilibrium/options.h"
#include "interaction/bonded_patch.h"
#include "materials/rheology.h"
#include "reduced/reduced_model.h"
#include "reduction/body_points.h"
#include "reduction/random_path.h"
#include "reduction/training_run.h"

namespace palpate {

struct ReductionOptions {
  /// The number of modes; there are fewer where the states have no more directions. For a liver and
  /// forces to some tenths of a percent: 20 for equilibria of one tool, 70 for its motion, 100 for
  /// that of two.
  Index modes = 70;
  /// Modes that are kept of the training at each place, of tools that attach anywhere
  /// (tool_places.h).
  Index place_modes = 60;
  /// Of the points' forces, as a share of those of the whole body; see HyperReductionOptions.
  double tolerance = 4e-3;
  /// Points at the most.
  Index max_points = 400;
  /// Random paths on which the body is trained to move.
  int training_paths = 4;
  std::uint64_t seed = 1;
  /// How far each coordinate of a tool goes from rest in training, m.
  double reach = 0.01;
  /// Of each training path, s.
  double path_duration = 2;
  /// Of their sinusoids, Hz, and taps in a second, the shortest one in s.
  double bandwidth = 3;
  double taps = 3;
  double shortest_tap = 0.03;
  /// Of the motion in training, s.
  double time_step = 2e-3;
  /// Under which the body rests, m/s². Tools count from their places there.
  Vec3 gravity = Vec3::Zero();
  /// Equilibria with all tools moved, where there are several; also of the reduced model, ten times
  /// as many.
  int all_tools_states = 40;
  EquilibriumOptions equilibrium;
  /// Is told what begins; may be empty.
  std::function<void(const std::string&)> report;
};

/// @throws InputError a field out of its range, by name.
void validate(const ReductionOptions& options);

/// @param names Of the options that the steps follow from, for the message.
/// @throws InputError the body would make more steps on so many paths than can be waited for.
void check_steps(const ReductionOptions& options, int paths, const char* names);

/// @throws InputError as validate(); a mixed material; an invalid rheology, or not one for each
///   material; gravity, but no density.
void check_reduction(const Scene& scene, const std::vector<Rheology>& rheologies,
                     const ReductionOptions& options);

struct BuiltModel {
  ReducedModel model;
  /// (Φ, L) [3 num_points × coordinates]: the displacement of the body, for its display.
  Eigen::MatrixXd basis;
  /// u_r [3 num_points], m: what the coordinates of the basis count from; empty without gravity.
  NodalVector rest;
  /// The quadrature points that were kept, see BodyPoints.
  std::vector<Index> points;
  /// Of the weights, on the training states, as a share; whether it is within the tolerance.
  double residual = 0;
  bool within_tolerance = false;
  /// Modes of equilibria with one tool moved, with all moved, and of motion.
  Index one_tool_modes = 0;
  Index all_tools_modes = 0;
  Index motion_modes = 0;
  int num_states = 0;
  /// States that were left out: there was no equilibrium, or a law was not defined.
  int num_left_out = 0;
  /// Training was ended by EquilibriumOptions::abort_requested; there is no model.
  bool aborted = false;
};

/// @param rheologies Of each material of the scene; without any density the model has no inertia.
/// @param tools They share no point.
/// @throws InputError an invalid scene, rheology, tool or option; a mixed material; a body that
///   finds no rest under its weight.
[[nodiscard]] BuiltModel build_reduced_model(const Scene& scene,
                                             const std::vector<Rheology>& rheologies,
                                             const std::vector<BondedPatch>& tools,
                                             const ReductionOptions& options);

/// The same on ranks, whose training is kept while it is under way. The model is the same to the
/// bit for any number of ranks, and where the training was taken up again.
/// @returns On rank 0 the model, on the others only whether it was aborted.
/// @note Collective. All is the same on every rank but callbacks and the file.
[[nodiscard]] BuiltModel build_reduced_model(const Scene& scene,
                                             const std::vector<Rheology>& rheologies,
                                             const std::vector<BondedPatch>& tools,
                                             const ReductionOptions& options,
                                             const TrainingRun& run);

/// The model of a basis and of chosen points; its ranges of training are those of `states`.
/// @param basis (Φ, L) [3 num_points × coordinates].
/// @param states y of each training state [coordinates × states].
/// @param rest As BuiltModel::rest.
[[nodiscard]] ReducedModel make_reduced_model(
    const Scene& scene, const std::vector<Rheology>& rheologies, const Eigen::MatrixXd& basis,
    const Eigen::MatrixXd& tool_stiffness, const std::vector<Index>& points,
    const Eigen::VectorXd& weights, const Eigen::MatrixXd& states, const NodalVector& rest = {});

/// Chooses the points of a model whose basis is there already, and makes it.
/// @param points Those of the scene. @param states As those of make_reduced_model().
void choose_model_points(const Scene& scene, const std::vector<Rheology>& rheologies,
                         const BodyPoints& points, const Eigen::MatrixXd& tool_stiffness,
                         const Eigen::MatrixXd& states, const ReductionOptions& options,
                         BuiltModel& built);

/// States of the whole body in motion along each of the paths.
[[nodiscard]] TrainingStates move_in_training(const Scene& scene,
                                              const std::vector<Rheology>& rheologies,
                                              const Interaction& tools,
                                              const std::vector<ToolPath>& paths,
                                              const ReductionOptions& options);

/// The states of the whole body in training, by group.
struct TrainingGroups {
  TrainingStates one_tool;
  TrainingStates all_tools;
  TrainingStates moving;
};

/// Solves for the whole body with the tools at each of some places, on ranks.
/// @param scene It was checked, see check(). @param places The tools that are held at a time.
/// @param groups On rank 0 the states of each place.
/// @returns False on every rank where it was aborted.
/// @note Collective
[[nodiscard]] bool train_with_tools(const Scene& scene, const std::vector<Rheology>& rheologies,
                                    const std::vector<std::vector<BondedPatch>>& places,
                                    const ReductionOptions& options, const TrainingRun& run,
                                    std::vector<TrainingGroups>& groups);

/// What random paths of training are like.
[[nodiscard]] RandomPathOptions path_options(const ReductionOptions& options, int num_tools);

/// The random paths of training, from the number `first` on.
[[nodiscard]] std::vector<ToolPath> training_paths(const ReductionOptions& options, int num_tools,
                                                   int first = 0);

}  // namespace palpate
