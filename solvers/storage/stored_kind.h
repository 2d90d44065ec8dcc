// SPDX-License-Identifier: BSD-3-Clause
// The parts of storing a tool space that depend on the kind of its tool.
#pragma once

#include <cstdint>
#include <string>

#include "state_space/tool_space.h"

namespace palpate::storage {

class StoredKind {
 public:
  virtual ~StoredKind() = default;

  /// Whether the fields of configurations are stored in single precision.
  [[nodiscard]] virtual bool has_single_fields() const = 0;
  /// Whether the number, the tool and the grid are possible for a tool of this kind.
  /// @param num_points The number of points of the body.
  [[nodiscard]] virtual bool is_possible(const ToolSpaceSetup& setup,
                                         std::int64_t num_points) const = 0;
  /// Whether a stored tool space may be given another tolerance.
  [[nodiscard]] virtual bool may_change_tolerance(double there, double asked) const = 0;
  /// The tool and the extent of the grid, for a message.
  [[nodiscard]] virtual std::string describe(const ToolSpaceSetup& setup) const = 0;
  /// The settings of a tool space that may change, to be put into the sentence "only … may change".
  [[nodiscard]] virtual const char* what_may_change() const = 0;
};

[[nodiscard]] const StoredKind& kind_of(const ToolSpaceSetup& setup);
[[nodiscard]] const StoredKind& kind_of(ToolSpaceId id);

/// The figures in which tool spaces of the same tool may differ, for a message.
[[nodiscard]] std::string figures_of(const ToolSpaceSetup& setup);

/// The name of a tool space of which only the number is known, for a message.
[[nodiscard]] std::string number_of(const ToolSpaceKey& key);

/// Whether a stored tool space may be extended to the one that is asked for.
[[nodiscard]] bool may_become(const ToolSpaceSetup& there, const ToolSpaceSetup& asked);

/// The shortest text that reads back as the same number.
[[nodiscard]] std::string shortest(double value);

}  // namespace palpate::storage
