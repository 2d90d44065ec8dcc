// SPDX-License-Identifier: BSD-3-Clause
// The errors of a reduced model compared with the whole body, at places and on paths that it was
// not made from, and the times of its steps.
#pragma once

#include <string>
#include <vector>

#include "reduction/build_reduced_model.h"
#include "reduction/path_error.h"

namespace palpate {

struct MeasureOptions {
  /// The number of equilibria of each kind.
  int equilibria = 20;
  /// The number of random paths in motion, of the same kind as in training; without inertia there
  /// are none.
  int paths = 1;
  /// Called between two of them; true ends the measurement with the results so far. May be empty.
  std::function<bool()> abort_requested;
};

/// A row of the report.
struct MeasuredError {
  /// "One tool at rest", "All tools at rest", "Motion".
  std::string kind;
  PathError error;
  /// The processor time of a step of the reduced body, median and longest, and of the whole body,
  /// mean, s.
  double median_step = 0;
  double longest_step = 0;
  double whole_step = 0;
};

/// @param tools, options As those that the model was built with.
[[nodiscard]] std::vector<MeasuredError> measure_model(const Scene& scene,
                                                       const std::vector<Rheology>& rheologies,
                                                       const std::vector<BondedPatch>& tools,
                                                       const ReductionOptions& options,
                                                       const ReducedModel& model,
                                                       const MeasureOptions& measure);

}  // namespace palpate
