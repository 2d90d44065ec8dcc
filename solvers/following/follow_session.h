// SPDX-License-Identifier: BSD-3-Clause
// Explores the space of a rigid tool around a hand with explorers (explorer.h) that come and go.
// The session has the strategy and the record: it gives each explorer that is free the transition
// that is needed first, keeps what it finds, and gives it out in chunks. It waits for nobody.
//
// What was found is in the file, if there is one, before the strategy goes on from it. So an
// exploration of the whole space may go on with that file later, and this one with a file that has
// a part of the space.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "exploration/exploration_session.h"
#include "exploration/precompute_options.h"
#include "following/explorer.h"
#include "following/follow_tool.h"

namespace palpate {

class FollowSession {
 public:
  /// @param options They have a rigid tool. Those of ranks and of active nodes have no effect.
  /// @throws InputError as precompute() does.
  FollowSession(std::shared_ptr<const Scene> scene, const PrecomputeOptions& options);
  ~FollowSession();
  FollowSession(const FollowSession&) = delete;
  FollowSession& operator=(const FollowSession&) = delete;

  /// What each explorer is to know.
  [[nodiscard]] const ExplorerJob& job() const;
  [[nodiscard]] const SpaceBody& body() const;
  /// The space without any configuration, which takes the chunks.
  [[nodiscard]] TouchSpace empty_space() const;

  /// A tool that touches the body near the place where the exploration is to begin
  /// (ShellOptions::begin_at).
  [[nodiscard]] const HandMotion& first_hand() const;
  /// Whether there is a configuration that is usable.
  [[nodiscard]] bool has_found() const;

  /// Says where the hand may be from now on.
  void follow(const HandPrediction& hand);
  /// The task that is needed first. It is under way until accept() or lose().
  /// @returns nothing: all that is left is under way, or there is nothing left.
  [[nodiscard]] std::optional<ExplorerTask> next();
  /// Takes in the result of a task that is under way; any other number is ignored, as that of an
  /// explorer which was given up too early.
  /// @returns False: it is not what was asked for. The task goes to another explorer.
  /// @throws InputError the body or the tool cannot be solved for at all.
  /// @throws BackendError it cannot be kept.
  [[nodiscard]] bool accept(const ExplorerResult& result);
  /// Says that a task has no result, since its explorer is lost. It is given to another one.
  void lose(std::int64_t task);

  /// What was found since the last chunk, and at first what the file has.
  [[nodiscard]] std::optional<SpaceChunk> take_chunk();
  /// A configuration that was found, with its fields.
  [[nodiscard]] Configuration load(const ConfigurationSummary& summary) const;
  /// The part of the fields that load() gives; less than all if an earlier run has reduced them.
  [[nodiscard]] Keep kept(const ConfigurationSummary& summary) const;

  struct Figures {
    FollowTool::Coverage coverage;
    std::int64_t num_solved = 0;
    std::int64_t num_under_way = 0;
    /// Nothing is under way, and there is nothing left to be done.
    bool is_complete = false;
    /// The sum of the times of all solves, s.
    double seconds = 0;
  };
  [[nodiscard]] Figures figures() const;

  /// Ends the session. The file may be read by others from now on.
  /// @returns The space.
  [[nodiscard]] TouchSpace finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
