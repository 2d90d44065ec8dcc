// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/shell_rounds.h"

#include <memory>
#include <utility>
#include <vector>

#include "exploration/contact_shell.h"
#include "exploration/level_round.h"
#include "exploration/shell_cells.h"
#include "exploration/shell_levels.h"
#include "exploration/transfer.h"

namespace palpate {

ShellRounds::ShellRounds(PlannedSpace& space, std::shared_ptr<const ToolClearance> clearance,
                         const ShellOptions& options)
    : space_(space),
      clearance_(std::move(clearance)),
      options_(options),
      halvings_(space.setup.grid.reach()) {
  take(static_cast<const StartGraph&>(*space.plan));
}

bool ShellRounds::plan(Engine& engine, Communicator& communicator, PrecomputeReport& report) {
  gather_known(engine, communicator);
  bool goes_on = false;
  agree(communicator, [&] { goes_on = (!search_ && halve(engine, report)) || search(engine); });
  return goes_on;
}

std::vector<ConfigurationSummary> ShellRounds::flat() const {
  std::vector<ConfigurationSummary> found;
  for (const auto& [p, c] : known_) {
    if (asked_.count(p) > 0) found.push_back(c);
  }
  return found;
}

bool ShellRounds::halve(Engine& engine, PrecomputeReport& report) {
  const ToolSpaceSetup& setup = space_.setup;
  const std::vector<ConfigurationSummary> found = flat();
  const double tolerance = force_tolerance(setup.policy, found);
  if (!(tolerance > 0)) return false;
  const CellRefinement refinement = halvings_.plan(setup.grid, found, tolerance, *clearance_);
  std::map<CheckPoint, ConfigurationSummary> known;
  for (const ConfigurationSummary& c : found) known.emplace(c.check_point, c);
  auto graph = std::make_shared<const StartGraph>(
      setup.key(), refined_targets(*clearance_, setup.grid, refinement.to_split, known, options_));
  if (graph->targets().empty()) return false;
  take(*graph);
  space_.plan = std::move(graph);
  engine.plan_anew(setup.key());
  report.num_rounds = ++num_rounds_;
  return true;
}

bool ShellRounds::search(Engine& engine) {
  const ToolSpaceSetup& setup = space_.setup;
  if (setup.policy.history == History::flat) return false;
  if (!search_) {
    const std::vector<ConfigurationSummary> found = flat();
    search_ = begin_level_search(setup, found, EdgeFit(found));
    for (const LevelTransition& transition : recalled_) search_->recall(transition);
  }
  for (const ConfigurationSummary& c : std::exchange(of_levels_, {})) search_->recall(c);
  std::vector<Transition> transitions = search_->next();
  std::vector<Settlement> settlements = search_->settled();
  if (transitions.empty() && settlements.empty()) return false;
  const auto distance = [clearance = clearance_, options = options_,
                         grid = setup.grid](const CheckPoint& p) {
    return shell_distance(*clearance, clearance->approach(grid.place(p)), options);
  };
  space_.plan = std::make_shared<const LevelRound>(setup.key(), std::move(transitions),
                                                   std::move(settlements), distance);
  engine.plan_anew(setup.key());
  return true;
}

void ShellRounds::take(const StartGraph& graph) {
  for (const StartGraph::Target& target : graph.targets()) asked_.insert(target.check_point);
}

void ShellRounds::gather_known(const Engine& engine, Communicator& communicator) {
  const ToolSpaceKey key = space_.setup.key();
  const std::vector<ConfigurationSummary>& here = engine.known_here(key);
  const std::vector<LevelTransition>& recalled = engine.recalled_here(key);
  Packer mine;
  mine.put_list(std::vector<ConfigurationSummary>(
      here.begin() + static_cast<std::ptrdiff_t>(num_told_), here.end()));
  mine.put_list(std::vector<LevelTransition>(
      recalled.begin() + static_cast<std::ptrdiff_t>(num_recalled_), recalled.end()));
  num_told_ = here.size();
  num_recalled_ = recalled.size();
  for (const Bytes& bytes : communicator.all_gather(mine.take())) {
    Unpacker content(bytes);
    for (const auto& c : content.take_list<std::vector<ConfigurationSummary>>()) {
      if (c.level == 0) {
        known_[c.check_point] = c;
      } else {
        of_levels_.push_back(c);
      }
    }
    for (const auto& transition : content.take_list<std::vector<LevelTransition>>()) {
      recalled_.push_back(transition);
    }
  }
}

}  // namespace palpate
