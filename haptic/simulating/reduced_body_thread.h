// SPDX-License-Identifier: BSD-3-Clause
// A reduced body on a thread of its own. Servo loops, on threads of theirs, move its tools, one
// each:
//
//   ReducedBodyThread body(model, {{place_of_first_tool}, {place_of_second_tool}}, clock);
//   servo.set_touch(std::make_unique<CoupledTool>(body.tool(0)));
//   other_servo.set_touch(std::make_unique<CoupledTool>(body.tool(1)));
//   body.start();
//
// The thread has real-time priority where the system permits it, below that of the servo loops. Its
// stack, the body and the model stay in memory, and signals go to other threads. When it stops or
// hangs, the servo loops let go of its tools.
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
  /// How late steps began, and how long they took.
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
  /// @param tools The tools of the model in their order.
  /// @throws InputError an invalid model or option, or another number of tools than the model has.
  ReducedBodyThread(std::shared_ptr<const ReducedModel> model,
                    const std::vector<SimulatedToolOptions>& tools, std::shared_ptr<Clock> clock,
                    const ReducedBodyThreadOptions& options = {});
  /// Stops the body.
  ~ReducedBodyThread();
  ReducedBodyThread(const ReducedBodyThread&) = delete;
  ReducedBodyThread& operator=(const ReducedBodyThread&) = delete;

  /// Starts the thread. Returns when the first step is made, or after a second.
  /// @throws BackendError the thread cannot be started, or was started before.
  void start();
  /// Ends the thread after the step that it is making. The servo loops let go of the tools.
  void stop() noexcept;

  [[nodiscard]] Index num_tools() const;
  /// The tool, for the CoupledTool of the servo loop that moves it.
  /// @param number From 0.
  [[nodiscard]] const std::shared_ptr<SimulatedTool>& tool(Index number) const;
  /// The state at the end of the newest step. It is valid until the next call of this object.
  [[nodiscard]] const ReducedBodyOutbox::Newest& latest();
  [[nodiscard]] ReducedBodyStatistics statistics();
  /// What is wrong with the thread's priority, its time or the model, in words; empty: nothing.
  [[nodiscard]] std::string problem();

 private:
  struct Shared;
  std::unique_ptr<Shared> shared_;
};

}  // namespace palpate
