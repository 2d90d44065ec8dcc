// SPDX-License-Identifier: BSD-3-Clause
// Where the explorers of a session meet. The hub has a socket to which they come, and no thread:
// whoever has the session calls exchange() again and again. An explorer that says nothing for a
// while is lost, and its task goes to another one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "following/follow_session.h"

namespace palpate {

class ExplorerHub {
 public:
  /// @param keys The folder of the keys, see keys.h.
  /// @param endpoint Where explorers come to, as "tcp://127.0.0.1:*", which takes a free port of
  ///   this machine; nothing listens elsewhere. ">tcp://host:port" goes to an explorer that
  ///   listens; there may be several, with commas between them.
  /// @throws InputError the keys cannot be read, or nothing can listen there.
  /// @throws BackendError there is a hub in this program.
  ExplorerHub(const std::filesystem::path& keys, const std::string& endpoint);
  ~ExplorerHub();
  ExplorerHub(const ExplorerHub&) = delete;
  ExplorerHub& operator=(const ExplorerHub&) = delete;

  /// Where explorers may come to, with the port that was taken.
  [[nodiscard]] const std::string& endpoint() const;

  /// Has the explorers explore for a session from now on; what they make for another one is lost.
  /// @param session It must outlive its use here; null: they wait.
  /// @throws InputError the body is too large.
  void explore_for(FollowSession* session);

  /// Takes in what has come, and gives tasks to those that have none. Call this often, and after
  /// each change of the hand.
  /// @param wait The longest time to wait for a message if none is there, s.
  /// @returns Whether a configuration was found.
  /// @throws InputError the body or the tool cannot be solved for at all.
  bool exchange(double wait = 0);

  struct Figures {
    int num_explorers = 0;
    int num_busy = 0;
    /// Explorers that were lost while they had a task.
    std::int64_t num_lost = 0;
    /// Messages that were no messages of an explorer, and connections with a wrong key.
    std::int64_t num_refused = 0;
    /// What the last explorer that could not go on has said.
    std::string last_failure;
  };
  [[nodiscard]] Figures figures() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
