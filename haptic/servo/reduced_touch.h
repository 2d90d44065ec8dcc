// SPDX-License-Identifier: BSD-3-Clause
// A reduced body that devices touch: the thread that steps it, and a servo loop for each tool that
// a device moves. They begin together, and however they end, every device gets zero force:
//
//   ReducedTouch touch(std::move(body), std::move(servos));
//   touch.start();
//   while (touch.lost().empty()) { … }
//   touch.stop();
//
// A tool that no device moves is let go: it moves with the body.
#pragma once

#include <memory>
#include <vector>

#include "haptic/servo/servo.h"
#include "haptic/simulating/reduced_body_thread.h"

namespace palpate {

/// All calls come from one thread.
class ReducedTouch {
 public:
  /// Gives the tools to the servo loops, but starts nothing.
  /// @param servos The servo loops of the tools in their order, with their settings. No device
  ///   moves a tool whose servo loop is nullptr or missing at the end.
  /// @throws InputError there are more servo loops than tools.
  ReducedTouch(std::unique_ptr<ReducedBodyThread> body, std::vector<std::unique_ptr<Servo>> servos);
  /// Stops all.
  ~ReducedTouch();
  ReducedTouch(const ReducedTouch&) = delete;
  ReducedTouch& operator=(const ReducedTouch&) = delete;

  /// @throws BackendError a thread cannot be started, or was started before; then all are stopped.
  void start();
  /// Calls Servo::host_lives() of all loops.
  void host_lives() noexcept;
  /// The tools whose device is gone, or whose servo loop has ended by itself, from 0. The others go
  /// on until stop().
  [[nodiscard]] std::vector<Index> lost();
  /// Sends zero force to all devices at once, and then ends their loops and the body.
  /// @return The tools whose loop has not ended, because the driver of their device hangs.
  std::vector<Index> stop() noexcept;

  [[nodiscard]] ReducedBodyThread& body() { return *body_; }
  /// The servo loop of a tool, counted from 0; nullptr: no device moves the tool.
  [[nodiscard]] Servo* servo(Index tool);

 private:
  std::unique_ptr<ReducedBodyThread> body_;
  std::vector<std::unique_ptr<Servo>> servos_;
};

}  // namespace palpate
