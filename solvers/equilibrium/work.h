// SPDX-License-Identifier: BSD-3-Clause
// The work that a solver has done: the number of operations of each kind, and their times, s.
#pragma once

#include "base/clock.h"

namespace palpate {

/// The work so far.
struct Work {
  long residuals = 0, assemblies = 0, analyses = 0, factorisations = 0, right_hand_sides = 0;
  /// Iterations of conjugate gradients, if there is no factor; those of three columns together
  /// count once.
  long krylov_iterations = 0;
  double residual_seconds = 0, assembly_seconds = 0, analysis_seconds = 0,
         factorisation_seconds = 0, solve_seconds = 0;

  /// The mean time of one assembly, one factorisation and three solves, s; 0 before any was done. A
  /// configuration cannot cost less, unless it does without a tangent of its own.
  [[nodiscard]] double floor_seconds() const;
  Work& operator+=(const Work& other);
};

/// Adds the time of its scope to a sum.
class Timer {
 public:
  explicit Timer(double& sum) : sum_(sum), start_(SteadyClock::now()) {}
  ~Timer() { sum_ += seconds_since(start_); }
  Timer(const Timer&) = delete;
  Timer& operator=(const Timer&) = delete;

 private:
  double& sum_;
  SteadyClock::time_point start_;
};

}  // namespace palpate
