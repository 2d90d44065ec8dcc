// SPDX-License-Identifier: BSD-3-Clause
// Where an exploration keeps what it finds. Until the end of a run, each rank keeps its own
// results.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "schedule/communicator.h"
#include "state_space/touch_space.h"
#include "storage/state_space_file.h"

namespace palpate {

/// What earlier runs have found in a tool space.
struct Known {
  /// All configurations, without fields; candidates too, see candidate_level().
  std::vector<ConfigurationSummary> configurations;
  std::vector<LevelTransition> transitions;
};

class Record {
 public:
  virtual ~Record() = default;
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

  /// What earlier runs have found of a tool space; empty on ranks other than 0.
  [[nodiscard]] virtual Known known(ToolSpaceKey tool_space) const = 0;
  /// The intermediate states of a tool space that earlier runs have found; empty on ranks other
  /// than 0.
  [[nodiscard]] virtual std::vector<IntermediateState> known_intermediate_states(
      ToolSpaceKey /*tool_space*/) const {
    return {};
  }
  /// Damaged parts of what earlier runs have left, see StateSpaceFile::left_out(); empty on ranks
  /// other than 0.
  [[nodiscard]] virtual std::vector<std::string> damaged() const = 0;
  /// Keeps a configuration. The rank that found it calls this before it tells any other rank.
  /// @param way The intermediate states on the way to it. Either all of this is kept or nothing.
  virtual void keep(ToolSpaceKey tool_space, const Configuration& found,
                    const std::vector<IntermediateState>& way) = 0;
  /// Keeps a transition between levels. Call this on any rank, before its candidate is settled.
  virtual void keep(ToolSpaceKey tool_space, const LevelTransition& transition) = 0;
  /// Settles a candidate that was kept on this rank, or by an earlier run: gives it a level, or
  /// removes it.
  /// @param level Below zero: the candidate is removed, since it is a known configuration.
  virtual void settle(ToolSpaceKey tool_space, const ConfigurationSummary& candidate,
                      std::int32_t level) = 0;
  /// A configuration with its fields, which was kept on this rank or by an earlier run.
  [[nodiscard]] virtual Configuration load(ToolSpaceKey tool_space,
                                           const ConfigurationSummary& summary) const = 0;
  /// The part of the fields that load() gives; less than all if an earlier run has reduced them.
  [[nodiscard]] virtual Keep kept(ToolSpaceKey /*tool_space*/,
                                  const ConfigurationSummary& /*summary*/) const {
    return Keep::all;
  }
  /// The space so far, as finish() gives it. Others may read the file, if there is one, until
  /// resume().
  /// @note Collective
  [[nodiscard]] virtual TouchSpace publish(double bound) = 0;
  /// Goes on after publish(). Call this before any other function.
  /// @note Collective
  virtual void resume() = 0;
  /// Whether publish() has moved the results of all ranks to rank 0 for good.
  [[nodiscard]] virtual bool has_moved() const = 0;
  /// Joins what all ranks have kept. The result is complete on rank 0, and empty elsewhere.
  /// @param complete Whether the whole space was explored.
  /// @param bound The largest error of a displacement that is reduced to modes, as a share of the
  ///   largest displacement.
  /// @note Collective
  [[nodiscard]] virtual TouchSpace finish(bool complete, double bound) = 0;

 protected:
  Record() = default;
};

/// A record in memory.
/// @param bodies Those of the run, in the order of their numbers. They must outlive the record.
[[nodiscard]] std::unique_ptr<Record> make_memory_record(const std::vector<SpaceBody>& bodies,
                                                         const std::vector<ToolSpaceSetup>& setups,
                                                         Communicator& communicator);

/// A record in a state-space file, which may have a part of the space already, see rank_files.h.
/// @param bodies As those of make_memory_record().
/// @param keep The part of the fields that the file keeps once the space is complete.
/// @param bound The largest error of these fields, as a share of the largest displacement.
/// @throws InputError the file is of another scene, tolerance, tip or grid; it has the bodies in
///   another order; it has another number of intermediate states; third derivatives are in the file
///   but not asked for, or the reverse; or it keeps less than is asked for, or with a larger error.
/// @note Collective
[[nodiscard]] std::unique_ptr<Record> make_file_record(const std::filesystem::path& path,
                                                       const std::vector<SpaceBody>& bodies,
                                                       const std::vector<ToolSpaceSetup>& setups,
                                                       double solver_tolerance, Keep keep,
                                                       double bound, Communicator& communicator);

}  // namespace palpate
