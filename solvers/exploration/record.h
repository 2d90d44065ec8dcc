// SPDX-License-Identifier: BSD-3-Clause
// Where an exploration keeps what it finds. Until the end each rank keeps what it has found itself.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "schedule/communicator.h"
#include "state_space/state_space_file.h"
#include "state_space/touch_space.h"

namespace palpate {

/// What earlier runs have left of a tool space.
struct Known {
  /// All configurations without fields, and candidates too, see candidate_level().
  std::vector<ConfigurationSummary> configurations;
  std::vector<LevelTransition> transitions;
};

class Record {
 public:
  virtual ~Record() = default;
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

  /// What earlier runs have left of a tool space; empty on other ranks than 0.
  [[nodiscard]] virtual Known known(ToolSpaceId tool_space) const = 0;
  /// What earlier runs have left but is damaged, see StateSpaceFile::left_out(); empty on other
  /// ranks than 0.
  [[nodiscard]] virtual std::vector<std::string> damaged() const = 0;
  /// Keeps a configuration. The rank that has found it calls this before any other hears of it.
  /// @param way The intermediate states on the way to it. Either all is kept or nothing.
  virtual void keep(ToolSpaceId tool_space, const Configuration& found,
                    const std::vector<IntermediateState>& way) = 0;
  /// Keeps a transition. Call this on any rank, before the candidate that it has found is settled.
  virtual void keep(ToolSpaceId tool_space, const LevelTransition& transition) = 0;
  /// Gives its level to a candidate that was kept on this rank or is known here, or removes it.
  /// @param level Below zero: the candidate is removed, as it is a configuration that is known.
  virtual void settle(ToolSpaceId tool_space, const ConfigurationSummary& candidate,
                      std::int32_t level) = 0;
  /// A configuration that was kept on this rank or is known here, with its fields.
  [[nodiscard]] virtual Configuration load(ToolSpaceId tool_space,
                                           const ConfigurationSummary& summary) const = 0;
  /// What load() gives of the fields: less than all where an earlier run has reduced them.
  [[nodiscard]] virtual Keep kept(ToolSpaceId /*tool_space*/,
                                  const ConfigurationSummary& /*summary*/) const {
    return Keep::all;
  }
  /// Brings together all that was found or was known. The result is whole on rank 0, empty
  /// elsewhere.
  /// @param complete Whether nothing is left to find.
  /// @param bound The largest error of a displacement that modes make, as a share of the largest.
  /// @note Collective
  [[nodiscard]] virtual TouchSpace finish(bool complete, double bound) = 0;

 protected:
  Record() = default;
};

/// A record in memory.
[[nodiscard]] std::unique_ptr<Record> make_memory_record(const Scene& scene,
                                                         const std::vector<ToolSpaceSetup>& setups,
                                                         Communicator& communicator);

/// A record in a state-space file, which may hold a part of the space already, see rank_files.h.
/// @param keep What the file keeps of the fields when nothing is left to find.
/// @param bound Of their error, as a share of the largest displacement.
/// @throws InputError a file of another scene, tolerance, tip or grid, with another number of
///   intermediate states, or where third derivatives are there or asked for alone; one that keeps
///   less than is asked for, or with a larger error.
/// @note Collective
[[nodiscard]] std::unique_ptr<Record> make_file_record(const std::filesystem::path& path,
                                                       const Scene& scene,
                                                       const std::vector<ToolSpaceSetup>& setups,
                                                       double solver_tolerance, Keep keep,
                                                       double bound, Communicator& communicator);

}  // namespace palpate
