// SPDX-License-Identifier: BSD-3-Clause
// The tables of what leads from one configuration to another: transition, between levels, and
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
  /// All transitions of a tool space, in the order of their ends.
  [[nodiscard]] std::vector<LevelTransition> read(const ToolSpaceKey& key) const;
  /// The transitions of which both ends are among the configurations: others may have been lost.
  /// @param configurations Those of the tool space, in the order of operator<.
  [[nodiscard]] std::vector<LevelTransition> read_linked(
      const ToolSpaceKey& key, const std::vector<Configuration>& configurations) const;

  /// Takes over the transitions of another file, except those that are here already.
  /// @param there The key of the tool space in that file.
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
  /// All intermediate states of a tool space, in the order of operator<.
  [[nodiscard]] std::vector<IntermediateState> read(const ToolSpaceKey& key) const;
  /// Sets the flag of the states that are beyond the force limit, and clears it in all others.
  void mark(const ToolSpaceSetup& setup);

  /// Takes over the states of another file that are on the way to some check-points.
  void merge(const ToolSpaceKey& key, const IntermediateStates& other, const ToolSpaceKey& there,
             const std::set<CheckPoint>& targets);
  /// Reads the states whose checksum differs between the versions of the schema.
  /// @returns A function that writes them again, after the schema of the file was converted.
  [[nodiscard]] std::function<void()> read_for_conversion();

 private:
  void write(const ToolSpaceKey& key, const IntermediateState& state);
};

}  // namespace palpate::storage
