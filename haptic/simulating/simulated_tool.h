// SPDX-License-Identifier: BSD-3-Clause
// A tool of a reduced body: the exchange between the servo loop that moves it and the thread that
// steps the body. Each side writes its newest state as a whole, and neither waits for the other.
//
// A spring and a damper, the virtual coupling [CB], hold the hand at p and the tool at d together.
// Both are displacements from the tool's place at rest:
//
//   h = c (p − d) + b (ṗ − ḋ)
//
// h moves the body, and the hand feels −h. On the side of the body, d is an unknown of the step,
// whose implicit rule lets spring and damper make no energy, whatever their size is
// (reduced_body_loop.h). On the side of the hand they are sampled (coupled_tool.h), so that the
// device and the delay bound c and b. A tool that nobody grasps is let go: it moves with the body.
//
// [CB] Colgate, Stanley & Brown, Issues in the Haptic Display of Tool Use, IROS 1995.
#pragma once

#include "base/types.h"
#include "haptic/realtime/clock.h"
#include "haptic/realtime/triple_buffer.h"
#include "reduced/reduced_body.h"

namespace palpate {

struct SimulatedToolOptions {
  /// Where the tool is when the body is at rest [3], m.
  Vec3 place = Vec3::Zero();
  /// The largest distance from which a hand takes hold of the tool, m.
  double reach = 0.01;
  /// c, N/m in the scene. The hand feels no stiffness above it. It has to be below what the device
  /// displays stably.
  double coupling_stiffness = 300;
  /// b, N·s/m in the scene.
  double coupling_damping = 0;
  /// When the body was not stepped for this long the hand lets go, and there is no force until it
  /// was outside.
  Duration release_after = std::chrono::milliseconds(20);
};

/// @throws InputError a value is out of range.
void validate(const SimulatedToolOptions& options);

/// The message from the servo loop to the body.
struct ToolCommand {
  /// When the message was written.
  Time time{0};
  /// Whether the hand holds the tool.
  bool is_held = false;
  /// p, m.
  Vec3 hand = Vec3::Zero();
};

/// The message from the body to the servo loop, at the end of a step.
struct ToolAnswer {
  /// When the step ended; 0: there was no step yet.
  Time time{0};
  /// The length of the step.
  Duration step{0};
  /// d, m, and ḋ, m/s.
  Vec3 displacement = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  /// h, N; 0 while the tool is let go.
  Vec3 force = Vec3::Zero();
  /// The work of h on the body since its beginning, J.
  double work = 0;
  /// How the step ended, and how far it was from what the model was trained for, see ReducedState.
  ReducedOutcome outcome = ReducedOutcome::converged;
  double trust = 0;
};

/// Forces are not to be trusted where ReducedState::trust is above this.
inline constexpr double kLargestTrusted = 2;

/// One servo loop and one thread of a body share this object.
class SimulatedTool {
 public:
  /// @throws InputError an option is out of range.
  explicit SimulatedTool(const SimulatedToolOptions& its_options) : options(its_options) {
    validate(options);
  }

  const SimulatedToolOptions options;
  /// The servo loop writes this.
  TripleBuffer<ToolCommand> command;
  /// The thread of the body writes this.
  TripleBuffer<ToolAnswer> answer;
};

}  // namespace palpate
