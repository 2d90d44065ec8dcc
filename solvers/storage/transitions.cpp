// SPDX-License-Identifier: BSD-3-Clause
#include "storage/transitions.h"

#include <algorithm>
#include <map>
#include <utility>

#include "storage/rows.h"

namespace palpate::storage {

void Transitions::add(const ToolSpaceKey& key, const LevelTransition& transition) {
  connection_.before_change();
  insert(key, transition, "REPLACE");
}

void Transitions::insert(const ToolSpaceKey& key, const LevelTransition& transition,
                         const std::string& where_there_is_one) {
  Statement statement(connection_.database(), table_.insert(where_there_is_one));
  bind(key, statement);
  for_each_number_of_transition(transition, rows::Bind{statement});
  statement.bind(rows::checksum(key, transition));
  statement.run();
}

std::vector<LevelTransition> Transitions::read(const ToolSpaceKey& key) const {
  const std::optional<ToolSpace> space = tool_spaces_.find(key);
  if (!space) return {};
  return read_rows<LevelTransition>(
      key, table_.columns("i", "checksum") + ", checksum", "true",
      [&](Statement& select, LevelTransition& transition) {
        bool sound = true;
        for_each_number_of_transition(transition, rows::Take{select, sound});
        return sound && select.take_integer() == rows::checksum(key, transition) &&
               rows::is_possible(space->setup.grid, transition);
      },
      [&](const LevelTransition& t) { return rows::describe(t, space->setup.name()); });
}

std::vector<LevelTransition> Transitions::read_linked(
    const ToolSpaceKey& key, const std::vector<Configuration>& configurations) const {
  const auto is_there = [&](const CheckPoint& check_point, std::int32_t level) {
    Configuration wanted;
    wanted.check_point = check_point;
    wanted.level = level;
    return std::binary_search(configurations.begin(), configurations.end(), wanted);
  };
  std::vector<LevelTransition> transitions = read(key);
  const auto loose = [&](const LevelTransition& t) {
    return !is_there(t.start, t.start_level) || (t.reached >= 0 && !is_there(t.target, t.reached));
  };
  transitions.erase(std::remove_if(transitions.begin(), transitions.end(), loose),
                    transitions.end());
  return transitions;
}

void Transitions::merge(const ToolSpaceKey& key, const Transitions& other,
                        const ToolSpaceKey& there) {
  for (const LevelTransition& transition : other.read(there)) insert(key, transition, "IGNORE");
}

void IntermediateStates::add(const ToolSpaceKey& key, const IntermediateState& state) {
  connection_.before_change();
  write(key, state);
}

void IntermediateStates::write(const ToolSpaceKey& key, const IntermediateState& state) {
  Statement insert(connection_.database(), table_.insert());
  bind(key, insert);
  for_each_number_of_intermediate(state, rows::Bind{insert});
  insert.bind(rows::checksum(key, state));
  insert.run();
}

std::vector<IntermediateState> IntermediateStates::read(const ToolSpaceKey& key) const {
  const std::optional<ToolSpace> space = tool_spaces_.find(key);
  if (!space) return {};
  return read_rows<IntermediateState>(
      key, table_.columns("i", "checksum") + ", checksum", "true",
      [&](Statement& select, IntermediateState& state) {
        bool sound = true;
        for_each_number_of_intermediate(state, rows::Take{select, sound});
        return sound &&
               select.take_integer() == rows::checksum(key, state, connection_.checked()) &&
               rows::is_possible(space->setup.grid, state);
      },
      [&](const IntermediateState& state) { return rows::describe(state, space->setup.name()); });
}

void IntermediateStates::mark(const ToolSpaceSetup& setup) {
  for (IntermediateState& state : read(setup.key())) {
    const Flags flags = setup.policy.marked(state.flags, state.force);
    if (flags == state.flags) continue;
    state.flags = flags;
    write(setup.key(), state);
  }
}

void IntermediateStates::merge(const ToolSpaceKey& key, const IntermediateStates& other,
                               const ToolSpaceKey& there, const std::set<CheckPoint>& targets) {
  for (const IntermediateState& state : other.read(there)) {
    if (targets.count(state.target) > 0) write(key, state);
  }
}

std::function<void()> IntermediateStates::read_for_conversion() {
  std::vector<std::pair<ToolSpaceKey, IntermediateState>> states;
  if (connection_.checked() == rows::Checked::as_version_5) {
    for (const ToolSpace& space : tool_spaces_.read_all()) {
      for (const IntermediateState& state : read(space.setup.key())) {
        states.emplace_back(space.setup.key(), state);
      }
    }
  }
  return [this, states = std::move(states)] {
    for (const auto& [key, state] : states) write(key, state);
  };
}

}  // namespace palpate::storage
