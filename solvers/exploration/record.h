// SPDX-License-Identifier: BSD-3-Clause
// Where an exploration keeps what it finds.
#pragma once

#include <filesystem>
#include <memory>

#include "schedule/communicator.h"
#include "state_space/state_space_file.h"
#include "state_space/touch_space.h"

namespace palpate {

class Record {
 public:
  virtual ~Record() = default;
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

  /// Whether a configuration is there from an earlier run. Asked on rank 0.
  [[nodiscard]] virtual bool contains(Index active_node, const CheckPoint& check_point) const = 0;
  /// One that is there, with its fields. Asked on rank 0.
  [[nodiscard]] virtual Configuration load(Index active_node,
                                           const CheckPoint& check_point) const = 0;
  /// Told on the rank that found the configuration, before anyone else hears of it.
  virtual void keep(Index active_node, const Configuration& found) = 0;
  /// Told on rank 0 of every configuration, as soon as it hears of it.
  virtual void share(Index active_node, const Configuration& found) = 0;
  /// All that was found and is known, for touching; whole on rank 0, empty elsewhere.
  /// @param complete Nothing is left to find.
  /// @note Collective
  [[nodiscard]] virtual TouchSpace finish(bool complete, double bound) = 0;

 protected:
  Record() = default;
};

/// In the memory of rank 0.
[[nodiscard]] std::unique_ptr<Record> make_memory_record(const Scene& scene,
                                                         const std::vector<Site>& sites,
                                                         double solver_tolerance,
                                                         Communicator& communicator);

/// In a state-space file, which may hold part of it already. Each rank writes a file of its own
/// beside it (<path>.rank<r>); they are merged at the end, or by the next run after a kill.
/// @throws InputError a file of another scene, tolerance or grid.
/// @note Collective
[[nodiscard]] std::unique_ptr<Record> make_file_record(const std::filesystem::path& path,
                                                       const Scene& scene,
                                                       const std::vector<Site>& sites,
                                                       double solver_tolerance,
                                                       Communicator& communicator);

}  // namespace palpate
