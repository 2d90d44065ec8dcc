// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/precompute_options.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/quantity.h"
#include "fields/pod.h"

namespace palpate {
namespace {

/// A step that leads to another branch, as at a ridge, is halved this often before the body jumps.
/// Eight halvings jump to the same state in three times the time.
constexpr int kMostHalvingsOfStep = 3;

}  // namespace

void validate(const PrecomputeOptions& options) {
  if (options.contact) {
    const auto& [tool, spacing, shell, turn_spacing, most_configurations] = *options.contact;
    if (!(std::isfinite(spacing) && spacing >= 0)) {
      throw InputError("The spacing is " + quantity(spacing) +
                       "; it must be a length in m, or 0 for two fifths of the tool's radius.");
    }
    if (!(std::isfinite(shell.depth) && shell.depth >= 0)) {
      throw InputError("The depth is " + quantity(shell.depth) +
                       "; it must be a length in m, or 0 to go as deep as the force limit allows.");
    }
    if (!(turn_spacing >= 0 && turn_spacing <= kLargestTurnSpacing)) {
      throw InputError("The TurnSpacing is " + quantity(turn_spacing * 180 / M_PI, "degrees") +
                       "; it must be at most " +
                       quantity(kLargestTurnSpacing * 180 / M_PI, "degrees") +
                       ", or 0 for the usual one.");
    }
    if (!shell.begin_at.allFinite()) {
      throw InputError("The place where the exploration begins is not finite.");
    }
    if (shell.depth == 0 && options.force_limit == 0) {
      throw InputError(
          "Neither a depth nor a force limit is given: the tool would be pressed "
          "through the body. Set one of them.");
    }
    if (options.intermediate_states > 0) {
      throw InputError(
          "The space of a rigid tool has no intermediate states. Set IntermediateStates to 0.");
    }
  }
  const bool has_boxes = !options.contact || !options.active_nodes.empty();
  if (has_boxes && !(std::isfinite(options.half_width) && options.half_width > 0)) {
    throw InputError("The half-width is " + quantity(options.half_width) +
                     "; it must be a positive length in m.");
  }
  if (options.resolution < 3 || options.resolution % 2 == 0 ||
      options.resolution > kLargestCoarsestResolution) {
    throw InputError(
        "The resolution is " + std::to_string(options.resolution) +
        "; it must be odd, so that the rest position is a check-point, and from 3 to " +
        std::to_string(kLargestCoarsestResolution) + '.');
  }
  if (!(std::isfinite(options.force_limit) && options.force_limit >= 0)) {
    throw InputError("The force limit is " + quantity(options.force_limit) +
                     "; it must be a force in N, or 0 for none.");
  }
  if (!(std::isfinite(options.tolerance) && options.tolerance >= 0)) {
    throw InputError(
        "The tolerance is " + quantity(options.tolerance) +
        "; it must be a force in N or a share of the largest, or 0 for a uniform grid.");
  }
  if (has_boxes && options.history == History::levels && options.tolerance > 0) {
    throw InputError(
        "Levels are explored on a uniform grid. Choose a resolution instead of a "
        "tolerance, or another history.");
  }
  if (options.intermediate_states < 0 || options.intermediate_states > kMostIntermediateStates) {
    throw InputError("The intermediate states are " + std::to_string(options.intermediate_states) +
                     "; they must be from 0 to " + std::to_string(kMostIntermediateStates) + '.');
  }
  if (options.keep < Keep::touch || options.keep > Keep::all) {
    throw InputError("What is kept has the number " +
                     std::to_string(static_cast<int>(options.keep)) +
                     "; it is 0 (touch), 1 (surface) or 2 (all).");
  }
  if (!(options.touch_bound >= kLeastPodBound && options.touch_bound < 1)) {
    throw InputError("The displacement bound is " + quantity(options.touch_bound) +
                     "; it must be a share from 0.00001 to below 1.");
  }
  validate(options.equilibrium);
}

EquilibriumOptions exploring(const PrecomputeOptions& options) {
  EquilibriumOptions result = options.equilibrium;
  // The exploration goes depth first: the starts on the current path keep their factors, beside
  // that of a step.
  result.follow_folds = false;
  if (options.contact) result.max_halvings = std::min(result.max_halvings, kMostHalvingsOfStep);
  result.kept_factors =
      num_kept_factors(options.contact ? kShellLayers : (options.resolution - 1) / 2);
  return result;
}

}  // namespace palpate
