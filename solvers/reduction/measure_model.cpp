// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/measure_model.h"

#include <algorithm>

#include "base/own_seconds.h"
#include "dynamics/dynamic_solver.h"
#include "interaction/interaction_list.h"
#include "reduction/random_path.h"
#include "reduction/training.h"

namespace palpate {
namespace {

/// An offset to the seed; those of training are below it.
constexpr std::uint64_t kUnseen = 100'000;
/// Tolerance of the solves for the whole body: no reduced model is more accurate.
constexpr double kTolerance = 1e-6;

void time_steps(const ReducedModel& model, const ToolPath& path, const ReducedBodyOptions& options,
                MeasuredError& row) {
  ReducedBody body(model, options);
  std::vector<double> times;
  for (int i = 1; i * options.time_step <= path.end(); ++i) {
    const Eigen::VectorXd place = path.at(i * options.time_step);
    const double start = own_seconds();
    (void)body.step(place.data());
    times.push_back(own_seconds() - start);
  }
  if (times.empty()) return;
  std::sort(times.begin(), times.end());
  row.median_step = times[times.size() / 2];
  row.longest_step = times.back();
}

}  // namespace

std::vector<MeasuredError> measure_model(const Scene& scene,
                                         const std::vector<Rheology>& rheologies,
                                         const std::vector<BondedPatch>& tools,
                                         const ReductionOptions& options, const ReducedModel& model,
                                         const MeasureOptions& measure) {
  std::vector<MeasuredError> rows;
  const auto ends = [&] { return measure.abort_requested && measure.abort_requested(); };
  InteractionList list;
  for (const BondedPatch& tool : tools) list.add(tool);
  const int num_tools = static_cast<int>(tools.size());
  const std::uint64_t seed = options.seed + kUnseen;

  EquilibriumSolver still(with_gravity(scene, rheologies, options.gravity), options.equilibrium);
  require_rest(still);
  still.set_interaction(list);
  Eigen::MatrixXd places = random_places(num_tools, options.reach, measure.equilibria, seed);
  if (num_tools > 1) {
    Eigen::MatrixXd one = places;
    one.bottomRows(one.rows() - 3).setZero();
    rows.push_back({"One tool at rest", measure_equilibria(model, still, one)});
  }
  if (ends()) return rows;
  rows.push_back({num_tools > 1 ? "All tools at rest" : "One tool at rest",
                  measure_equilibria(model, still, places)});
  if (!model.has_inertia()) return rows;

  const RandomPathOptions path = path_options(options, num_tools);
  ReducedBodyOptions steps;
  steps.time_step = options.time_step;
  DynamicsOptions dynamics;
  dynamics.time_step = options.time_step;
  dynamics.gravity = options.gravity;
  dynamics.equilibrium = options.equilibrium;
  dynamics.equilibrium.tolerance = kTolerance;
  DynamicSolver whole(scene, rheologies, list, dynamics);
  for (int i = 0; i < measure.paths && !ends(); ++i) {
    const ToolPath unseen = random_path(path, seed + 1 + static_cast<std::uint64_t>(i));
    const double start = own_seconds();
    MeasuredError row{"Motion", measure_motion(model, whole, unseen, path.duration, steps)};
    row.whole_step = (own_seconds() - start) * options.time_step / path.duration;
    time_steps(model, unseen, steps, row);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace palpate
