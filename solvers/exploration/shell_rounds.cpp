// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/shell_rounds.h"

#include <memory>
#include <utility>
#include <vector>

#include "exploration/contact_shell.h"
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
  agree(communicator, [&] {
    const ToolSpaceSetup& setup = space_.setup;
    // Configurations of earlier runs that belong to later rounds do not count yet.
    std::map<CheckPoint, ConfigurationSummary> known;
    std::vector<ConfigurationSummary> found;
    for (const auto& [p, c] : known_) {
      if (asked_.count(p) == 0) continue;
      known.emplace(p, c);
      found.push_back(c);
    }
    const double tolerance = force_tolerance(setup.policy, found);
    if (!(tolerance > 0)) return;
    const CellRefinement refinement = halvings_.plan(setup.grid, found, tolerance, *clearance_);
    auto graph = std::make_shared<const StartGraph>(
        setup.key(),
        refined_targets(*clearance_, setup.grid, refinement.to_split, known, options_));
    if (graph->targets().empty()) return;
    take(*graph);
    space_.plan = std::move(graph);
    engine.plan_anew(setup.key());
    report.num_rounds = ++num_rounds_;
    goes_on = true;
  });
  return goes_on;
}

void ShellRounds::take(const StartGraph& graph) {
  for (const StartGraph::Target& target : graph.targets()) asked_.insert(target.check_point);
}

void ShellRounds::gather_known(const Engine& engine, Communicator& communicator) {
  const std::vector<ConfigurationSummary>& here = engine.known_here(space_.setup.key());
  Packer mine;
  mine.put_list(std::vector<ConfigurationSummary>(
      here.begin() + static_cast<std::ptrdiff_t>(num_told_), here.end()));
  num_told_ = here.size();
  for (const Bytes& bytes : communicator.all_gather(mine.take())) {
    for (const auto& c : Unpacker(bytes).take_list<std::vector<ConfigurationSummary>>()) {
      known_[c.check_point] = c;
    }
  }
}

}  // namespace palpate
