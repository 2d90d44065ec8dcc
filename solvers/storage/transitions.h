// SPDX-License-Identifier: BSD-3-Clause
// What leads from one configuration to another: the tables transition, between levels, and
// intermediate, the states on the way.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "storage/tool_space_rows.h"

namespace palpate::storage {

class Transitions : private ToolSpaceRows {
 public:
  Transitions(Connection& connection, const ToolSpaces& tool_spaces)
      : ToolSpaceRows(connection, tool_spaces, "transition") {}

  /// Adds a transition, in place of the one between the same ends.
  void add(const ToolSpaceKey& key, const LevelTransition& transition);
  /// In the order of their ends.
  [[nodiscard]] std::vector<LevelTransition> read(const ToolSpaceKey& key) const;
  /// The transitions of which both ends are among the configurations: others may have been lost.
  /// @param configurations Those of the tool space, in the order of operator<.
  [[nodiscard]] std::vector<LevelTransition> read_linked(
      const ToolSpaceKey& key, const std::vector<Configuration>& configurations) const;

  /// Takes over those of another file; one that is here stays.
  /// @param there Which tool space it is there.
  void merge(const ToolSpaceKey& key, const Transitions& other, const ToolSpaceKey& there);

 private:
  /// @param where_there_is_one What SQLite does where there is one already: REPLACE or IGNORE.
  void insert(const ToolSpaceKey& key, const LevelTransition& transition,
              const std::string& where_there_is_one);
};

class IntermediateStates : private ToolSpaceRows {
 public:
  IntermediateStates(Connection& connection, const ToolSpaces& tool_spaces)
      : ToolSpaceRows(connection, tool_spaces, "intermediate") {}

  /// Adds an intermediate state, in place of one of the same number on the same way.
  void add(const ToolSpaceKey& key, const IntermediateState& state);
  /// In the order of operator<.
  [[nodiscard]] std::vector<IntermediateState> read(const ToolSpaceKey& key) const;
  /// Marks those that are beyond the force limit, and no others.
  void mark(const ToolSpaceSetup& setup);

  /// Takes over those of another file on the way to some check-points.
  void merge(const ToolSpaceKey& key, const IntermediateStates& other, const ToolSpaceKey& there,
             const std::set<CheckPoint>& targets);
  /// Reads what a conversion of the file writes again: those of which the checksum was another.
  [[nodiscard]] std::function<void()> read_for_conversion();

 private:
  void write(const ToolSpaceKey& key, const IntermediateState& state);
};

}  // namespace palpate::storage
