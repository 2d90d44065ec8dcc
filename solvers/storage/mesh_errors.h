// SPDX-License-Identifier: BSD-3-Clause
// The table mesh_error: what the size of the cells does to configurations, where it was estimated.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/tool_space_rows.h"

namespace palpate::storage {

class MeshErrors : private ToolSpaceRows {
 public:
  MeshErrors(Connection& connection, const ToolSpaces& tool_spaces)
      : ToolSpaceRows(connection, tool_spaces, "mesh_error") {}

  /// Stores the error of a configuration in place of the one that is there; where it is not known,
  /// there is none afterwards.
  void add(const ToolSpaceKey& key, const ConfigurationSummary& configuration);
  /// Gives the error of a candidate the level of the candidate, or removes it.
  /// @param level Below zero: it is removed.
  void settle(const ToolSpaceKey& key, const ConfigurationSummary& candidate, std::int32_t level);
  /// Sets the errors of configurations of a tool space, as far as they are known.
  /// @param configurations In the order of operator<.
  void set(const ToolSpaceKey& key, std::vector<Configuration>& configurations) const;

 private:
  [[nodiscard]] bool is_there() const;
  void remove(const ToolSpaceKey& key, const ConfigurationSummary& configuration);
};

}  // namespace palpate::storage
