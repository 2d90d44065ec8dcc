// SPDX-License-Identifier: BSD-3-Clause
// Where an exploration keeps what it finds: each rank what it has found itself, until the end.
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

/// What earlier runs have left of an active node.
struct Known {
  /// Candidates too, see candidate_level().
  std::vector<ConfigurationSummary> configurations;
  std::vector<LevelTransition> transitions;
};

class Record {
 public:
  virtual ~Record() = default;
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

  /// On rank 0, empty elsewhere.
  [[nodiscard]] virtual Known known(Index active_node) const = 0;
  /// What of earlier runs was damaged and is not known, see StateSpaceFile::left_out(); on rank 0.
  [[nodiscard]] virtual std::vector<std::string> damaged() const = 0;
  /// Told on the rank that found the configuration, before anyone else hears of it.
  /// @param way The intermediate states on the way to it: they are kept with it, or neither is.
  virtual void keep(Index active_node, const Configuration& found,
                    const std::vector<IntermediateState>& way) = 0;
  /// On any rank, before the candidate that it has found is settled.
  virtual void keep(Index active_node, const LevelTransition& transition) = 0;
  /// Gives a candidate that was kept or is known here its level, or removes it.
  /// @param level Below zero: it is one that is known.
  virtual void settle(Index active_node, const ConfigurationSummary& candidate,
                      std::int32_t level) = 0;
  /// One that was kept on this rank or is known here, with its fields.
  [[nodiscard]] virtual Configuration load(Index active_node,
                                           const ConfigurationSummary& summary) const = 0;
  /// All that was found and is known, for touching; whole on rank 0, empty elsewhere.
  /// @param complete Nothing is left to find.
  /// @note Collective
  [[nodiscard]] virtual TouchSpace finish(bool complete, double bound) = 0;

 protected:
  Record() = default;
};

/// In memory.
[[nodiscard]] std::unique_ptr<Record> make_memory_record(const Scene& scene,
                                                         const std::vector<Site>& sites,
                                                         double solver_tolerance,
                                                         Communicator& communicator);

/// In a state-space file, which may hold part of it already, see rank_files.h.
/// @throws InputError a file of another scene, tolerance, tip or grid, with another number of
///   intermediate states, or where third derivatives are there or asked for alone.
/// @note Collective
[[nodiscard]] std::unique_ptr<Record> make_file_record(const std::filesystem::path& path,
                                                       const Scene& scene,
                                                       const std::vector<Site>& sites,
                                                       double solver_tolerance,
                                                       Communicator& communicator);

}  // namespace palpate
