// SPDX-License-Identifier: BSD-3-Clause
// An exploration that can be paused, steered and watched while it runs. It keeps the solver, the
// plan, the record and the tasks that are left from one run to the next, so that a space may grow
// under the hand without being begun anew. precompute() is a session that is run once.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exploration/precompute_options.h"
#include "exploration/precompute_report.h"
#include "exploration/progress.h"
#include "exploration/steering.h"
#include "fields/space_chunk.h"
#include "linear/linear_solver.h"
#include "schedule/communicator.h"
#include "state_space/touch_space.h"

namespace palpate {

/// A body of a run. All bodies of a run are of one organ.
struct BodyOfRun {
  std::shared_ptr<const Scene> scene;
  /// The points of its mesh that are touched. If all bodies of a run name none, and there is no
  /// rigid tool, every touchable point of each of them. PrecomputeOptions::active_nodes, which are
  /// those of a run of one body, are ignored here.
  std::vector<Index> active_nodes;
  /// What the body is for, of an organ that is divided into regions: where a rigid tool presses it,
  /// or the active node that is named. If some bodies of a run have a region with a band, a rigid
  /// tool presses only these, and all bands are as wide.
  std::optional<MeshRegion> region = {};
};

struct PrecomputeResult {
  /// The space on rank 0; empty elsewhere.
  TouchSpace space;
  /// The bodies of the run at rest under their loads; on rank 0, those of the space, which may have
  /// more.
  std::vector<SpaceBody> bodies;
  /// The report is equal on every rank.
  PrecomputeReport report;
  /// On rank 0: damaged parts of the file, which were removed when the run went on from it, see
  /// StateSpaceFile::left_out().
  std::vector<std::string> damaged;
};

/// Called on rank 0 with each chunk: before and after each run with what is new.
using TakeChunk = std::function<void(const SpaceChunk&)>;

class ExplorationSession {
 public:
  using MakeSolver = std::function<std::unique_ptr<LinearSolver>(const Scene& scene)>;

  /// Opens the record, and plans the tool spaces. Call begin_exploration() instead, which checks
  /// the options.
  /// @param bodies At least one; a tool presses all of them, or their regions. If there is a file
  ///   that has some of them already, they are in the order of the file.
  /// @param communicator The ranks that lead a solve. It must outlive the session.
  /// @param make_solver Makes the solver of a body on this rank; null: a solver without
  ///   factorisation.
  /// @param take_chunk The same on all ranks whether it is empty: then no chunks are made.
  /// @throws InputError as precompute() does.
  /// @note Collective
  ExplorationSession(const std::vector<BodyOfRun>& bodies, const PrecomputeOptions& options,
                     Communicator& communicator, const Progress& progress,
                     const MakeSolver& make_solver, TakeChunk take_chunk = {});
  ~ExplorationSession();
  ExplorationSession(const ExplorationSession&) = delete;
  ExplorationSession& operator=(const ExplorationSession&) = delete;

  enum class State {
    /// There are transitions to be made.
    paused,
    /// Nothing is left but what the steering has withdrawn.
    withdrawn,
    complete,
    /// The progress function has ended the exploration. It cannot be run any further.
    aborted,
  };
  /// Explores until the space is complete, or `until` pauses the run.
  /// @returns The state, the same on every rank.
  /// @note Collective
  State run(const Until& until = {});
  [[nodiscard]] State state() const;

  /// Has all ranks follow a steering from now on. Call this on any rank, from within the progress
  /// function or between two runs, on the thread of the run.
  void steer(Steering steering);

  /// The space so far. If there is a file it has all of this, and others may read it until the next
  /// run. The report is that of this rank, see combine().
  /// @note Collective
  [[nodiscard]] PrecomputeResult publish();
  /// Ends the session.
  /// @returns The space. The report is that of this rank, see combine().
  /// @note Collective
  [[nodiscard]] PrecomputeResult finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
