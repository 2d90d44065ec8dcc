// SPDX-License-Identifier: BSD-3-Clause
// A reduced body that is stepped in real time while hands move its tools. Each period it makes one
// step of that length, at whose end the tools are where the newest commands lead them.
//
// A damper of a coupling (simulated_tool.h) is taken into a step of length τ by
//
//   h = c e + b (e − e₀)/τ = (c + b/τ) (p' − d),   p' = p − (b/τ)/(c + b/τ) e₀,   e = p − d
//
// with e₀ from the step before: the body sees a spring of another stiffness, to another place.
//
// Where a step is late by a period or more, the body has lost that time and does not catch up.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "haptic/realtime/clock.h"
#include "haptic/realtime/histogram.h"
#include "haptic/realtime/triple_buffer.h"
#include "haptic/simulating/simulated_tool.h"
#include "reduced/reduced_body.h"

namespace palpate {

struct ReducedBodyLoopOptions {
  /// The time from step to step, which is also the length of a step: ReducedBodyOptions::time_step
  /// is without effect.
  Duration period = std::chrono::milliseconds(2);
  /// The body lets go of a tool whose servo loop has not said for this long where the hand is.
  Duration release_after = std::chrono::milliseconds(20);
  ReducedBodyOptions body;
};

/// @throws InputError a value is out of range.
void validate(const ReducedBodyLoopOptions& options);

/// What is counted from step to step.
struct ReducedBodyCounters {
  std::uint64_t steps = 0;
  /// Time from the beginning of the first step to that of the last.
  Duration running{0};
  /// Steps that were missed, as the loop was late by a period or more.
  std::uint64_t missed = 0;
  /// Steps that took longer than the period.
  std::uint64_t too_long = 0;
  /// Steps that have not converged, by their outcome.
  std::uint64_t not_converged = 0;
  std::uint64_t beyond_training = 0;
  std::uint64_t tools_ahead = 0;
  /// Steps whose trust was above kLargestTrusted, and the largest trust.
  std::uint64_t untrusted = 0;
  double largest_trust = 0;
  /// The largest numbers of tangents and iterations that a step has taken.
  int most_tangents = 0;
  int most_iterations = 0;
};

/// The results that the loop passes to one other thread.
struct ReducedBodyOutbox {
  struct Newest {
    /// When the last step ended.
    Time time{0};
    ReducedState state;
    /// y = (q, d), see reduced_model.h.
    Eigen::VectorXd coordinates;
    ReducedBodyCounters counters;
  };
  TripleBuffer<Newest> newest;
  DurationHistogram lateness;
  DurationHistogram step_time;
};

class ReducedBodyLoop {
 public:
  /// Makes the body, at rest, and allocates all memory that the loop needs.
  /// @param model, clock, outbox They must outlive the loop.
  /// @param tools The tools of the model in their order; nullptr: the tool is let go.
  /// @throws InputError an invalid model or option, or another number of tools than the model has.
  ReducedBodyLoop(const ReducedModel& model, std::vector<std::shared_ptr<SimulatedTool>> tools,
                  Clock& clock, const ReducedBodyLoopOptions& options, ReducedBodyOutbox& outbox);

  /// Makes one step, now. @note Realtime-safe.
  void step() noexcept;
  /// Sleeps until the next step is due. Where that time is past it sleeps for a tenth of the
  /// period, so that steps that take too long leave time to other threads. After a step that was
  /// late by a period or more the rhythm begins anew.
  void wait() noexcept;

  [[nodiscard]] const ReducedBody& body() const noexcept { return body_; }

 private:
  /// The coupling of a tool.
  struct Coupling {
    bool is_held = false;
    /// e₀ and p, m.
    Vec3 stretch = Vec3::Zero();
    Vec3 hand = Vec3::Zero();
    double work = 0;
    Vec3 force = Vec3::Zero();
  };

  void keep_time(Time begin) noexcept;
  void lead_tools() noexcept;
  void answer() noexcept;
  void count() noexcept;

  Clock& clock_;
  const ReducedBodyLoopOptions options_;
  ReducedBodyOutbox& outbox_;
  const std::vector<std::shared_ptr<SimulatedTool>> tools_;
  std::vector<Coupling> couplings_;
  ReducedBody body_;
  /// Where the tools are led to, and where they were before the step [num_tool_coordinates], m.
  Eigen::VectorXd places_;
  Eigen::VectorXd before_;
  ReducedBodyOutbox::Newest newest_;
  Time begin_{0};
  Time first_begin_{0};
  /// When the step was due.
  Time due_{0};
};

}  // namespace palpate
