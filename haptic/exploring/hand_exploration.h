// SPDX-License-Identifier: BSD-3-Clause
// Explores the space of a rigid tool while a hand touches it. A thread has the session
// (follow_session.h) and the explorers that come to it. It asks where the hand is a hundred times a
// second, and gives out the body each time something was found, so that nobody who touches or
// shows it waits for a solve.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "exploration/precompute_options.h"
#include "following/follow_session.h"
#include "following/live_space.h"
#include "haptic/touching/touchable.h"

namespace palpate {

struct HandExplorationOptions {
  /// They have a rigid tool.
  PrecomputeOptions space;
  TouchableOptions touch;
  /// Explorers on this machine; 0: one less than there are cores, but at least one.
  int num_explorers = 0;
  /// Where explorers come to, and where explorers listen, see ExplorerHub.
  std::string endpoint = "tcp://127.0.0.1:*";
  /// The folder of the keys; empty: new ones, which are removed at the end.
  std::filesystem::path keys;
};

class HandExploration final : public LiveSpace {
 public:
  /// Tells where the hand is; nothing: that is not known yet. It is called on the thread of the
  /// exploration.
  using Where = std::function<std::optional<HandMotion>()>;
  /// Takes the body when its space has grown. It is called on the thread of the exploration, first
  /// with what the file has, if there is something.
  using TakeBody = std::function<void(std::shared_ptr<const Touchable>)>;

  /// Opens the session, and starts the thread and the explorers of this machine.
  /// @throws InputError as FollowSession and ExplorerHub do.
  /// @throws BackendError palpate-explore is missing or cannot be started.
  HandExploration(std::shared_ptr<const Scene> scene, const HandExplorationOptions& options,
                  Where where, TakeBody take_body);
  /// Ends the exploration; see end().
  ~HandExploration() override;
  HandExploration(const HandExploration&) = delete;
  HandExploration& operator=(const HandExploration&) = delete;

  /// Ends the thread and the explorers, once. The file, if there is one, has what was found, and
  /// others may have it.
  /// @throws InputError, BackendError it cannot be kept.
  void end() override;

  struct Figures {
    FollowSession::Figures session;
    int num_explorers = 0;
    int num_busy = 0;
    /// Explorers that were lost while they had a task.
    std::int64_t num_lost = 0;
    /// Why nothing more is found, or what the last explorer that could not go on has said; empty:
    /// nothing is wrong.
    std::string problem;
  };
  [[nodiscard]] Figures figures() const;

  [[nodiscard]] State newest() override;
  [[nodiscard]] const SpaceBody& body() const override;
  [[nodiscard]] FieldSource& fields() override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
