// SPDX-License-Identifier: BSD-3-Clause
// The table turn_derivative: of the configurations of a tool that is turned, the derivatives by all
// its coordinates.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/tool_space_rows.h"

namespace palpate::storage {

class TurnDerivatives : private ToolSpaceRows {
 public:
  TurnDerivatives(Connection& connection, const ToolSpaces& tool_spaces)
      : ToolSpaceRows(connection, tool_spaces, "turn_derivative") {}

  /// Stores those of a configuration in place of those that are there; where it has none, there are
  /// none afterwards.
  void add(const ToolSpaceKey& key, const ConfigurationSummary& configuration);
  /// Sets those of the configurations of a tool space that have them.
  /// @param configurations In the order of operator<.
  void set(const ToolSpaceKey& key, std::vector<Configuration>& configurations) const;

 private:
  [[nodiscard]] bool is_there() const;
};

}  // namespace palpate::storage
