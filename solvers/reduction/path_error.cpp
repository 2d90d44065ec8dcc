// SPDX-License-Identifier: BSD-3-Clause
#include "reduction/path_error.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace palpate {
namespace {

class Comparison {
 public:
  void add(const Eigen::VectorXd& whole, const ReducedBody& reduced) {
    for (Eigen::Index tool = 0; tool < whole.size(); tool += 3) {
      largest_force_ = std::max(largest_force_, whole.segment<3>(tool).norm());
      errors_.push_back((reduced.force() - whole).segment<3>(tool).norm());
    }
    ++error_.num_compared;
    error_.num_failed += reduced.state().outcome == ReducedOutcome::converged ? 0 : 1;
    error_.largest_trust = std::max(error_.largest_trust, reduced.state().trust);
  }

  [[nodiscard]] PathError finish() {
    error_.largest_force = largest_force_;
    if (!(largest_force_ > 0)) return error_;
    const auto count = static_cast<double>(errors_.size());
    for (const double e : errors_) {
      const double share = e / largest_force_;
      error_.mean += share / count;
      error_.rms += share * share / count;
      error_.max = std::max(error_.max, share);
    }
    error_.rms = std::sqrt(error_.rms);
    return error_;
  }

 private:
  PathError error_;
  double largest_force_ = 0;
  std::vector<double> errors_;
};

}  // namespace

PathError measure_equilibria(const ReducedModel& model, EquilibriumSolver& whole,
                             const Eigen::MatrixXd& places) {
  ReducedModel still = model;
  still.mass.setZero();
  still.rheologies.assign(model.rheologies.size(), Rheology());
  ReducedBody reduced(still, {});
  Comparison comparison;
  const Equilibrium rest = whole.rest();
  for (Eigen::Index c = 0; c < places.cols(); ++c) {
    const Equilibrium state = whole.solve(places.col(c), rest, Tangent::rough);
    if (state.outcome != Outcome::converged) continue;
    reduced.rest();
    const Eigen::VectorXd place = places.col(c);
    (void)reduced.step(place.data());
    comparison.add(state.reaction, reduced);
  }
  return comparison.finish();
}

PathError measure_motion(const ReducedModel& model, DynamicSolver& whole, const ToolPath& path,
                         double until, const ReducedBodyOptions& options) {
  ReducedBody reduced(model, options);
  Comparison comparison;
  int num_steps = 0;
  const DynamicState end = whole.run(path, until, [&](const DynamicState& state) {
    const double steps = state.motion.time / options.time_step;
    const double whole_steps = std::round(steps);
    if (whole_steps < 1 || std::abs(steps - whole_steps) > 1e-6) return true;
    while (num_steps < static_cast<int>(whole_steps)) {
      ++num_steps;
      const Eigen::VectorXd place = path.at(num_steps * options.time_step);
      (void)reduced.step(place.data());
    }
    comparison.add(state.force, reduced);
    return true;
  });
  if (end.outcome != Outcome::converged) {
    throw BackendError("The whole body does not reach the end of a path. " + end.message);
  }
  return comparison.finish();
}

}  // namespace palpate
