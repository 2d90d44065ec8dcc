// SPDX-License-Identifier: BSD-3-Clause
// What of storing a tool space depends on the kind of its tool.
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
  /// Whether number, tool and grid are what those of a tool of this kind may be.
  /// @param num_points Of the body.
  [[nodiscard]] virtual bool is_possible(const ToolSpaceSetup& setup,
                                         std::int64_t num_points) const = 0;
  /// Whether a tool space with this tolerance may become one with another.
  [[nodiscard]] virtual bool may_change_tolerance(double there, double asked) const = 0;
  /// Its tool and the extent of its grid, for a message.
  [[nodiscard]] virtual std::string describe(const ToolSpaceSetup& setup) const = 0;
  /// What of a tool space may change, as the end of a sentence: "only … may change".
  [[nodiscard]] virtual const char* what_may_change() const = 0;
};

[[nodiscard]] const StoredKind& kind_of(const ToolSpaceSetup& setup);
[[nodiscard]] const StoredKind& kind_of(ToolSpaceId id);

/// All that tells a tool space from others with the same tool, for a message.
[[nodiscard]] std::string figures_of(const ToolSpaceSetup& setup);

/// What a tool space is called of which no more than its number is known.
[[nodiscard]] std::string number_of(const ToolSpaceKey& key);

/// Whether a tool space that is there may become the one that is asked for.
[[nodiscard]] bool may_become(const ToolSpaceSetup& there, const ToolSpaceSetup& asked);

/// The shortest text that reads back as the same number.
[[nodiscard]] std::string shortest(double value);

}  // namespace palpate::storage
