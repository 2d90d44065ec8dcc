// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/state_space.h"

#include <algorithm>

namespace palpate {
namespace {

/// field += sign · at_rest, where both are there.
void add(double sign, const NodalVector& at_rest, Eigen::VectorXd& field) {
  if (field.size() > 0 && field.size() == at_rest.size()) field += sign * at_rest;
}

}  // namespace

void count_from_rest(const SettledBody& settled, Configuration& configuration) {
  add(-1, settled.u, configuration.u);
  add(-1, settled.p, configuration.p);
}

void count_from_mesh(const SettledBody& settled, Configuration& configuration) {
  add(1, settled.u, configuration.u);
  add(1, settled.p, configuration.p);
}

const Configuration* ToolSpace::find(const CheckPoint& check_point, std::int32_t level) const {
  ConfigurationSummary key;
  key.check_point = check_point;
  key.level = level;
  const auto found = std::lower_bound(configurations.begin(), configurations.end(), key);
  return found != configurations.end() && !(key < *found) ? &*found : nullptr;
}

const ToolSpace* StateSpace::find(const ToolSpaceKey& key) const {
  const auto found = std::lower_bound(
      tool_spaces.begin(), tool_spaces.end(), key,
      [](const ToolSpace& space, const ToolSpaceKey& of) { return space.setup.key() < of; });
  return found != tool_spaces.end() && found->setup.key() == key ? &*found : nullptr;
}

std::string describe(const CheckPoint& c) {
  return '(' + std::to_string(c[0]) + ", " + std::to_string(c[1]) + ", " + std::to_string(c[2]) +
         ')';
}

std::string describe(const ConfigurationSummary& summary, const std::string& tool_space) {
  return "configuration " + describe(summary.check_point) +
         (summary.level != 0 ? " of level " + std::to_string(summary.level) : "") + " of " +
         tool_space;
}

void sort(StateSpace& space) {
  std::sort(space.tool_spaces.begin(), space.tool_spaces.end(),
            [](const ToolSpace& a, const ToolSpace& b) { return a.setup.key() < b.setup.key(); });
  for (ToolSpace& tool_space : space.tool_spaces) {
    std::sort(tool_space.configurations.begin(), tool_space.configurations.end());
    std::sort(tool_space.intermediate_states.begin(), tool_space.intermediate_states.end());
  }
}

}  // namespace palpate
