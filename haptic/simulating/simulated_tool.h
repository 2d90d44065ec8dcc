// SPDX-License-Identifier: BSD-3-Clause
// A tool of a reduced body, between the servo loop that moves it and the thread that steps the
// body. Each side tells the other its newest state whole, and neither waits for the other.
//
// The hand at p and the tool at d, displacements from the tool's place at rest, are held together
// by a spring and a damper, the virtual coupling [CB]:
//
//   h = c (p − d) + b (ṗ − ḋ)
//
// The body is moved by h, the hand feels −h. On the side of the body d is an unknown of the step,
// by the implicit rule of which spring and damper make no energy whatever their size is
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
  /// A hand takes hold of the tool from no farther than this, m.
  double reach = 0.01;
  /// c, N/m in the scene. It is felt where the body is stiffer, and has to be below what the device
  /// displays stably.
  double coupling_stiffness = 300;
  /// b, N·s/m in the scene.
  double coupling_damping = 0;
  /// When the body was not stepped for so long the tool lets go, and there is no force until it was
  /// outside.
  Duration release_after = std::chrono::milliseconds(20);
};

/// @throws InputError a value is out of range.
void validate(const SimulatedToolOptions& options);

/// What the servo loop tells the body.
struct ToolCommand {
  /// When it was told.
  Time time{0};
  /// The tool is grasped.
  bool is_held = false;
  /// p, m.
  Vec3 hand = Vec3::Zero();
};

/// What the body answers with the end of a step.
struct ToolAnswer {
  /// When the step ended; 0: there was none.
  Time time{0};
  /// The length of the step.
  Duration step{0};
  /// d, m, and ḋ, m/s.
  Vec3 displacement = Vec3::Zero();
  Vec3 velocity = Vec3::Zero();
  /// h, N; 0 while the tool is let go.
  Vec3 force = Vec3::Zero();
  /// Of h on the body since its beginning, J.
  double work = 0;
  /// How the step ended, and how far it was from what the model was trained for, see ReducedState.
  ReducedOutcome outcome = ReducedOutcome::converged;
  double trust = 0;
};

/// Above this ReducedState::trust forces are not to be trusted.
inline constexpr double kLargestTrusted = 2;

/// One servo loop and one thread of a body share it.
class SimulatedTool {
 public:
  /// @throws InputError an option is out of range.
  explicit SimulatedTool(const SimulatedToolOptions& its_options) : options(its_options) {
    validate(options);
  }

  const SimulatedToolOptions options;
  /// Written by the servo loop.
  TripleBuffer<ToolCommand> command;
  /// Written by the body.
  TripleBuffer<ToolAnswer> answer;
};

}  // namespace palpate
