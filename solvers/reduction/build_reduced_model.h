// SPDX-License-Identifier: BSD-3-Clause
// Builds a reduced model (reduced/reduced_model.h) of a scene and of the tools that hold it, from
// states of the whole body:
//
//   1. L and LᵀK₀L: the sensitivity and the stiffness of the equilibrium at rest; with gravity, of
//      that under the weight of the body.
//   2. States: equilibria with one tool moved and with all of them moved; with inertia, also motion
//      along random paths with taps. (A basis of equilibria alone is of no use in motion. A basis
//      of the motion of the linear body would take one factorisation and half the time, but has ten
//      times the error.)
//   3. Φ: POD modes of each of these groups in turn, of what the earlier groups leave.
//   4. Points and weights (hyper_reduction.h) for these states. The model with them is then moved
//      along the training paths itself, which is quick, and the points are chosen again for the
//      states of this motion too: the forces of all points are exact at any state.
//
// The result depends on the scene, the tools and the options, which include the seed, alone.
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
  /// The number of modes; there are fewer if the states have fewer directions. For a liver and
  /// errors of some tenths of a percent of the force: 20 for equilibria of one tool, 70 for its
  /// motion, 100 for the motion of two.
  Index modes = 70;
  /// The number of modes that are kept for each place of training, if tools attach anywhere
  /// (tool_places.h).
  Index place_modes = 60;
  /// Tolerance of the forces of the chosen points, as a share of those of the whole body; see
  /// HyperReductionOptions.
  double tolerance = 4e-3;
  /// The largest number of points.
  Index max_points = 400;
  /// The number of random paths along which the body is moved in training.
  int training_paths = 4;
  std::uint64_t seed = 1;
  /// The largest displacement of each coordinate of a tool in training, m.
  double reach = 0.01;
  /// The duration of each training path, s.
  double path_duration = 2;
  /// The largest frequency of the paths' sinusoids, Hz; their taps per second; and the duration of
  /// the shortest tap, s.
  double bandwidth = 3;
  double taps = 3;
  double shortest_tap = 0.03;
  /// The time step of motion in training, s.
  double time_step = 2e-3;
  /// The field of gravity, m/s². Tools count from their places at rest under it.
  Vec3 gravity = Vec3::Zero();
  /// The number of equilibria with all tools moved, if there are several tools; the reduced model
  /// takes ten times as many.
  int all_tools_states = 40;
  EquilibriumOptions equilibrium;
  /// Called with the name of each stage that begins; may be empty.
  std::function<void(const std::string&)> report;
};

/// @throws InputError a field out of its range, by name.
void validate(const ReductionOptions& options);

/// @param names The options that determine the number of steps, for the message.
/// @throws InputError the body would make more steps on these paths than one can wait for.
void check_steps(const ReductionOptions& options, int paths, const char* names);

/// @throws InputError as validate(); a mixed material; an invalid rheology, or not one for each
///   material; gravity, but no density.
void check_reduction(const Scene& scene, const std::vector<Rheology>& rheologies,
                     const ReductionOptions& options);

struct BuiltModel {
  ReducedModel model;
  /// (Φ, L) [3 num_points × coordinates]: the displacement of the body, for its display.
  Eigen::MatrixXd basis;
  /// u_r [3 num_points], m, from which the displacements of the basis count; empty without gravity.
  NodalVector rest;
  /// The quadrature points of the model, see BodyPoints.
  std::vector<Index> points;
  /// The relative residual of the weights on the training states, and whether it is within the
  /// tolerance.
  double residual = 0;
  bool within_tolerance = false;
  /// The numbers of modes from equilibria with one tool moved, with all moved, and from motion.
  Index one_tool_modes = 0;
  Index all_tools_modes = 0;
  Index motion_modes = 0;
  int num_states = 0;
  /// States that were left out, because there was no equilibrium or a law was not defined.
  int num_left_out = 0;
  /// EquilibriumOptions::abort_requested has ended the training; there is no model.
  bool aborted = false;
};

/// @param rheologies One for each material of the scene; without any density the model has no
///   inertia.
/// @param tools Patches that share no point.
/// @throws InputError an invalid scene, rheology, tool or option; a mixed material; a body that
///   finds no rest under its weight.
[[nodiscard]] BuiltModel build_reduced_model(const Scene& scene,
                                             const std::vector<Rheology>& rheologies,
                                             const std::vector<BondedPatch>& tools,
                                             const ReductionOptions& options);

/// Builds the model on several ranks, and keeps parts of the training during the run. The model is
/// the same to the bit for any number of ranks, and after the training was resumed.
/// @returns On rank 0 the model, on the others only whether it was aborted.
/// @note Collective. All arguments but callbacks and the file are the same on every rank.
[[nodiscard]] BuiltModel build_reduced_model(const Scene& scene,
                                             const std::vector<Rheology>& rheologies,
                                             const std::vector<BondedPatch>& tools,
                                             const ReductionOptions& options,
                                             const TrainingRun& run);

/// Makes the model of a basis and of chosen points. Its ranges of training are those of `states`.
/// @param basis (Φ, L) [3 num_points × coordinates].
/// @param states y of each training state [coordinates × states].
/// @param rest As BuiltModel::rest.
[[nodiscard]] ReducedModel make_reduced_model(
    const Scene& scene, const std::vector<Rheology>& rheologies, const Eigen::MatrixXd& basis,
    const Eigen::MatrixXd& tool_stiffness, const std::vector<Index>& points,
    const Eigen::VectorXd& weights, const Eigen::MatrixXd& states, const NodalVector& rest = {});

/// Chooses the points of a model whose basis exists, and makes the model.
/// @param points The quadrature points of the scene.
/// @param states As in make_reduced_model().
void choose_model_points(const Scene& scene, const std::vector<Rheology>& rheologies,
                         const BodyPoints& points, const Eigen::MatrixXd& tool_stiffness,
                         const Eigen::MatrixXd& states, const ReductionOptions& options,
                         BuiltModel& built);

/// Moves the whole body along each of the paths and returns states of this motion.
[[nodiscard]] TrainingStates move_in_training(const Scene& scene,
                                              const std::vector<Rheology>& rheologies,
                                              const Interaction& tools,
                                              const std::vector<ToolPath>& paths,
                                              const ReductionOptions& options);

/// The training states of the whole body, by group.
struct TrainingGroups {
  TrainingStates one_tool;
  TrainingStates all_tools;
  TrainingStates moving;
};

/// Solves for the whole body with the tools at each of some places, on all ranks.
/// @param scene A scene that check() accepts.
/// @param places For each place, the tools that are held together.
/// @param groups On rank 0 the states of each place.
/// @returns False on every rank: the training was aborted.
/// @note Collective
[[nodiscard]] bool train_with_tools(const Scene& scene, const std::vector<Rheology>& rheologies,
                                    const std::vector<std::vector<BondedPatch>>& places,
                                    const ReductionOptions& options, const TrainingRun& run,
                                    std::vector<TrainingGroups>& groups);

/// The options of the random paths of training.
[[nodiscard]] RandomPathOptions path_options(const ReductionOptions& options, int num_tools);

/// The random paths of training, beginning with number `first`.
[[nodiscard]] std::vector<ToolPath> training_paths(const ReductionOptions& options, int num_tools,
                                                   int first = 0);

}  // namespace palpate
