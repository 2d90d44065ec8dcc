// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/exploration_estimate.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "exploration/plan_spaces.h"
#include "exploration/start_graph.h"

namespace palpate {
namespace {

/// The factor by which a tolerance multiplies the configurations of the first round, as measured on
/// the liver with 0.1 %.
constexpr double kMoreByTolerance = 3;
/// The time of an intermediate state, as a share of that of a configuration.
constexpr double kIntermediateState = 0.6;
/// The mean work of a configuration of a bonded node and of a rigid tool, as measured on the liver
/// (tests/benchmark/README.md).
constexpr WorkCount kBonded = {0.4, 24, 20, 0.8};
constexpr WorkCount kContact = {0.8, 29, 35, 1.5, 9.5};
/// The size of a configuration without fields in a file, bytes.
constexpr double kSummaryBytes = 512;
/// Fields of a configuration: u, v, p and ∂p/∂t.
constexpr double kNumbersOfState = 4;

struct Count {
  double configurations = 0;
  double free = 0;
};

Count count(const PrecomputeOptions& options, const std::vector<PlannedSpace>& spaces) {
  Count count;
  for (const PlannedSpace& space : spaces) {
    if (const auto* graph = dynamic_cast<const StartGraph*>(space.plan.get())) {
      for (const StartGraph::Target& target : graph->targets()) {
        ++(target.is_free ? count.free : count.configurations);
      }
    } else {
      count.configurations += std::pow(space.setup.grid.coarsest_resolution(), 3);
    }
  }
  const double more = options.tolerance > 0 ? kMoreByTolerance : 1;
  return {more * count.configurations, more * count.free};
}

/// The size of a configuration's fields in a file, bytes. Those of a rigid tool are in single
/// precision.
double field_bytes(const PrecomputeOptions& options, const SolveCost& cost) {
  const std::size_t number = options.contact ? sizeof(float) : sizeof(double);
  return kNumbersOfState * static_cast<double>(cost.state_size * number);
}

}  // namespace

ExplorationEstimate followed_by(ExplorationEstimate first, const ExplorationEstimate& next) {
  const Index num_unknowns = std::max(first.num_unknowns, next.num_unknowns);
  const double bytes = std::max(first.bytes_per_rank, next.bytes_per_rank);
  first = first + next;
  first.num_unknowns = num_unknowns;
  first.bytes_per_rank = bytes;
  return first;
}

ExplorationEstimate estimate_exploration(const PrecomputeOptions& options,
                                         const std::vector<PlannedSpace>& spaces,
                                         const SolveCost& cost, int num_ranks) {
  const auto [configurations, free] = count(options, spaces);
  ExplorationEstimate estimate;
  estimate.num_unknowns = cost.num_unknowns;
  estimate.num_configurations = std::llround(configurations);
  estimate.num_free = std::llround(free);
  const bool single = options.equilibrium.single_precision;
  // Ranks that share a solve are assumed to be as quick as ranks that solve apart.
  estimate.seconds = configurations * (1 + kIntermediateState * options.intermediate_states) *
                     seconds_of(work_of_configuration(options.contact.has_value()), cost, single) /
                     num_ranks;
  estimate.file_bytes =
      configurations * (field_bytes(options, cost) + kSummaryBytes) + free * kSummaryBytes;
  const double states = options.file.empty()
                            ? configurations * kNumbersOfState *
                                  static_cast<double>(cost.state_size) * sizeof(double) / num_ranks
                            : 0;
  const int layers = options.contact ? kShellLayers : (options.resolution - 1) / 2;
  estimate.bytes_per_rank = states + (configurations + free) * sizeof(ConfigurationSummary) +
                            solver_bytes(cost, num_kept_factors(layers), single);
  return estimate;
}

ExplorationEstimate estimate_exploration(const Scene& scene, const PrecomputeOptions& options,
                                         const SolveCost& cost, int num_ranks) {
  validate(options);
  // The mesh stands for the body at rest.
  const SpaceBody body{
      kFirstBody, std::shared_ptr<const Scene>(std::shared_ptr<void>(), &scene), {}, {}};
  InteractionFactory tools(scene.body, {});
  std::vector<PlannedSpace> spaces = plan_spaces(body, options, tools);
  require_few_enough(options, spaces);
  ExplorationEstimate all = estimate_exploration(options, spaces, cost, num_ranks);
  if (options.contact && !options.active_nodes.empty()) {
    PrecomputeOptions bonded = options;
    bonded.contact.reset();
    const ExplorationEstimate nodes =
        estimate_exploration(bonded, plan_grids(body, bonded), cost, num_ranks);
    all = followed_by(all, nodes);
  }
  return all;
}

WorkCount work_of_configuration(bool is_rigid) { return is_rigid ? kContact : kBonded; }

void require_few_enough(const PrecomputeOptions& options, const std::vector<PlannedSpace>& spaces) {
  if (!options.contact) return;
  const double configurations = count(options, spaces).configurations;
  if (configurations > static_cast<double>(options.contact->most_configurations)) {
    throw InputError("The space would have about " + std::to_string(std::llround(configurations)) +
                     " configurations; at most " +
                     std::to_string(options.contact->most_configurations) +
                     " are allowed. Take a larger spacing, less depth or a smaller region, or "
                     "allow more.");
  }
}

}  // namespace palpate
