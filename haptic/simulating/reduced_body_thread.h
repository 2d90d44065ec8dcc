// SPDX-License-Identifier: BSD-3-Clause
// A reduced body on a thread of its own. Servo loops on theirs move its tools, one each:
//
//   ReducedBodyThread body(model, {{place_of_first_tool}, {place_of_second_tool}}, clock);
//   servo.set_tool(body.tool(0));
//   other_servo.set_tool(body.tool(1));
//   body.start();
//
// The thread has real-time priority where the system permits, below that of the servo loops, and
// what it computes with stays in memory; signals go elsewhere. Where it stops or hangs, the servo
// loops let go of its tools.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "haptic/simulating/reduced_body_loop.h"

namespace palpate {

struct ReducedBodyThreadOptions {
  ReducedBodyLoopOptions loop;
  /// Real-time priority of the thread, 1 to 99; 0: none is asked for.
  int priority = 70;
};

/// @throws InputError a value is out of range.
void validate(const ReducedBodyThreadOptions& options);

struct ReducedBodyStatistics : ReducedBodyCounters {
  /// How late steps began, and what they took.
  Percentiles lateness;
  Percentiles step_time;
  /// Whether the thread has real-time priority, and whether its stack, the body and its model are
  /// locked in memory.
  bool realtime_priority = false;
  bool memory_locked = false;

  /// Steps a second.
  [[nodiscard]] double rate() const {
    return steps > 1 ? static_cast<double>(steps - 1) / seconds(running) : 0;
  }
};

/// All calls come from one thread.
class ReducedBodyThread {
 public:
  /// Makes the body, at rest, but does not start it.
  /// @param tools Those of the model in turn.
  /// @throws InputError an invalid model or option, or another number of tools than the model has.
  ReducedBodyThread(std::shared_ptr<const ReducedModel> model,
                    const std::vector<SimulatedToolOptions>& tools, std::shared_ptr<Clock> clock,
                    const ReducedBodyThreadOptions& options = {});
  /// Stops the body.
  ~ReducedBodyThread();
  ReducedBodyThread(const ReducedBodyThread&) = delete;
  ReducedBodyThread& operator=(const ReducedBodyThread&) = delete;

  /// Returns when the first step is made, or has been waited for for a second.
  /// @throws BackendError the thread cannot be started, or was started before.
  void start();
  /// Ends the thread, within a step. The servo loops let go of the tools.
  void stop() noexcept;

  [[nodiscard]] Index num_tools() const;
  /// What a servo loop moves a tool by (Servo::set_tool()).
  /// @param number From 0.
  [[nodiscard]] const std::shared_ptr<SimulatedTool>& tool(Index number) const;
  /// The end of the newest step; valid until the next call of this object.
  [[nodiscard]] const ReducedBodyOutbox::Newest& latest();
  [[nodiscard]] ReducedBodyStatistics statistics();
  /// What is wrong with the thread's priority, its time or the model, in words; empty: nothing.
  [[nodiscard]] std::string problem();

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace palpate
