// SPDX-License-Identifier: BSD-3-Clause
#include "storage/stored_touch_space.h"

#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "fields/make_touch_space.h"

namespace palpate {
namespace {

/// The reduced fields of the configurations, by index, empty for damaged ones; nothing if any
/// configuration has its fields whole.
std::optional<std::vector<ReducedFields>> read_reduced(
    const StateSpaceFile& file, const ToolSpaceKey& key,
    const std::vector<ConfigurationSummary>& summaries) {
  std::vector<ReducedFields> reduced(summaries.size());
  for (std::size_t s = 0; s < summaries.size(); ++s) {
    StoredFields stored;
    if (!summaries[s].usable() || !file.read_stored(key, summaries[s], stored)) continue;
    if (stored.basis == nullptr) return std::nullopt;
    reduced[s] = std::move(stored.reduced);
  }
  return reduced;
}

std::vector<ConfigurationSummary> summaries_of(const std::vector<Configuration>& configurations) {
  return {configurations.begin(), configurations.end()};
}

}  // namespace

TouchSpace make_touch_space(const StateSpaceFile& file, double bound) {
  validate_pod_bound(bound);
  const std::vector<SpaceBody> bodies = file.read_bodies();
  const ShownSurface shown(bodies);
  TouchSpace space = make_empty_touch_space(shown);
  std::vector<std::string> without_fields;
  for (const ToolSpace& tool_space : file.read_tool_spaces()) {
    const ToolSpaceKey key = tool_space.setup.key();
    const SpaceBody& body = find_body(bodies, key.body);
    const std::vector<ConfigurationSummary> summaries = summaries_of(file.read_summaries(key));
    std::vector<IntermediateState> states = file.read_intermediate_states(key);
    if (tool_space.setup.presses()) {
      add_tool_space(body, shown, tool_space.setup, summaries, std::move(states), nullptr, {},
                     space);
      continue;
    }
    // An active node has one basis at the most.
    const auto bases = file.bases().list(key);
    const auto basis = bases.empty() ? nullptr : file.bases().read(key, bases.front().number);
    if (const auto reduced = basis == nullptr ? std::nullopt : read_reduced(file, key, summaries)) {
      std::vector<const ReducedFields*> fields;
      for (const ReducedFields& of : *reduced) fields.push_back(of.v.cols() > 0 ? &of : nullptr);
      add_tool_space(body, shown, tool_space.setup, summaries, std::move(states), basis.get(),
                     fields, space);
      // Forget these bases, so that those of many active nodes are not in memory twice.
      file.bases().forget();
      continue;
    }
    Configuration current;
    std::set<std::size_t> damaged;
    reduce_and_add(
        body, shown, tool_space.setup, summaries, std::move(states), bound,
        [&](std::size_t c) -> const Configuration* {
          static_cast<ConfigurationSummary&>(current) = summaries[c];
          if (damaged.count(c) > 0) return nullptr;
          if (!file.read_fields(key, current)) {
            damaged.insert(c);
            return nullptr;
          }
          if (has_fields(current, body.mesh().num_points())) return &current;
          damaged.insert(c);
          without_fields.push_back(describe(current, tool_space.setup.name()) +
                                   ", whose fields are not whole");
          return nullptr;
        },
        space);
    // Displacements that are made of modes have the error of the modes in addition.
    if (basis != nullptr) {
      space.displacement_error += basis->displacement_error;
      space.sensitivity_error += basis->sensitivity_error;
    }
  }
  add_clearances(bodies, space);
  space.left_out = file.left_out();
  space.left_out.insert(space.left_out.end(), without_fields.begin(), without_fields.end());
  space.file = file.path().string();
  return space;
}

TouchSpace make_touch_space_without_modes(const StateSpaceFile& file) {
  const std::vector<SpaceBody> bodies = file.read_bodies();
  const ShownSurface shown(bodies);
  TouchSpace space = make_empty_touch_space(shown);
  space.file = file.path().string();
  for (const ToolSpace& from : file.read_tool_spaces()) {
    const ToolSpaceKey key = from.setup.key();
    add_tool_space(find_body(bodies, key.body), shown, from.setup,
                   summaries_of(file.read_summaries(key)), file.read_intermediate_states(key),
                   nullptr, {}, space);
  }
  add_clearances(bodies, space);
  space.left_out = file.left_out();
  return space;
}

}  // namespace palpate
