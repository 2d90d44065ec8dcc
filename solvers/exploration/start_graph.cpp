// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/start_graph.h"

#include <algorithm>
#include <map>
#include <utility>

#include "schedule/owner.h"

namespace palpate {
namespace {

/// The targets that one rank owns.
class OwnedTargets final : public ExplorationStrategy {
 public:
  OwnedTargets(const StartGraph& graph, std::vector<const StartGraph::Target*> targets)
      : graph_(graph), order_(std::move(targets)) {
    for (const StartGraph::Target* target : order_) states_[target->check_point].target = target;
  }

  void recall(const ConfigurationSummary& found) override {
    if (found.level == 0) take_in(found);
  }

  void accept(const ConfigurationSummary& found) override {
    if (found.usable()) return take_in(found);
    const auto here = states_.find(found.check_point);
    if (here != states_.end() && !here->second.is_done) go_on(here->second);
  }

  void refuse(const CheckPoint& target, const CheckPoint& start, bool beyond_limit) override {
    const auto here = states_.find(target);
    if (here == states_.end() || here->second.is_done || !is_tried(here->second, start)) return;
    here->second.is_beyond_limit = here->second.is_beyond_limit || beyond_limit;
    go_on(here->second);
  }

  void offer(const CheckPoint& target, const CheckPoint& start) override {
    const auto here = states_.find(target);
    if (here == states_.end() || here->second.is_done || !is_tried(here->second, start)) return;
    pending_.push_back({target, start});
  }

  [[nodiscard]] std::vector<Transition> next() override {
    if (!std::exchange(has_started_, true)) {
      for (const StartGraph::Target* target : order_) begin(*target);
    }
    std::stable_sort(pending_.begin(), pending_.end(),
                     [](const Transition& a, const Transition& b) { return a.start < b.start; });
    return std::exchange(pending_, {});
  }

  [[nodiscard]] std::vector<CheckPoint> given_up() override { return std::exchange(given_up_, {}); }
  [[nodiscard]] bool is_beyond_limit(const CheckPoint& given_up) const override {
    const State& state = states_.at(given_up);
    return state.is_beyond_limit;
  }
  [[nodiscard]] std::int64_t num_expected() const override {
    return static_cast<std::int64_t>(order_.size());
  }

 private:
  struct State {
    const StartGraph::Target* target = nullptr;
    /// The index of the start that is tried now. After the last start the target is tried without
    /// one.
    std::size_t tried = 0;
    bool is_done = false;
    /// One of its starts is beyond the force limit.
    bool is_beyond_limit = false;
  };

  void take_in(const ConfigurationSummary& found) {
    const auto here = states_.find(found.check_point);
    if (here != states_.end()) here->second.is_done = true;
  }

  [[nodiscard]] static bool is_tried(const State& state, const CheckPoint& start) {
    const auto& starts = state.target->starts;
    return state.tried < starts.size() && starts[state.tried] == start;
  }

  void begin(const StartGraph::Target& target) {
    const State& state = states_.at(target.check_point);
    if (state.is_done) return;
    if (target.starts.empty()) return pending_.push_back({target.check_point, target.check_point});
    const CheckPoint& first = target.starts.front();
    // If the first start is sought too, the target follows from it and is not asked for here.
    const bool follows = first != target.check_point && graph_.find(first) != nullptr;
    if (!follows) pending_.push_back({target.check_point, first});
  }

  /// Tries the next start of a target, or gives the target up.
  void go_on(State& state) {
    const StartGraph::Target& target = *state.target;
    const auto& starts = target.starts;
    const bool had_none = state.tried >= starts.size();
    if (!had_none) ++state.tried;
    if (state.tried < starts.size()) {
      return pending_.push_back({target.check_point, starts[state.tried]});
    }
    const bool from_none_failed =
        had_none || std::find(starts.begin(), starts.end(), target.check_point) != starts.end();
    if (!from_none_failed && !state.is_beyond_limit) {
      return pending_.push_back({target.check_point, target.check_point});
    }
    state.is_done = true;
    given_up_.push_back(target.check_point);
  }

  const StartGraph& graph_;
  std::vector<const StartGraph::Target*> order_;
  std::map<CheckPoint, State> states_;
  bool has_started_ = false;
  std::vector<Transition> pending_;
  std::vector<CheckPoint> given_up_;
};

}  // namespace

StartGraph::StartGraph(ToolSpaceKey tool_space, std::vector<Target> targets)
    : tool_space_(tool_space), targets_(std::move(targets)) {
  std::sort(targets_.begin(), targets_.end(),
            [](const Target& a, const Target& b) { return a.check_point < b.check_point; });
  for (const Target& target : targets_) {
    if (target.starts.empty() || target.starts.front() == target.check_point) continue;
    following_[target.starts.front()].push_back(target.check_point);
  }
}

const StartGraph::Target* StartGraph::find(const CheckPoint& p) const {
  const auto found = std::lower_bound(
      targets_.begin(), targets_.end(), p,
      [](const Target& target, const CheckPoint& q) { return target.check_point < q; });
  return found != targets_.end() && found->check_point == p ? &*found : nullptr;
}

std::vector<CheckPoint> StartGraph::following(const ConfigurationSummary& found) const {
  if (!found.leads_on() || found.level != 0 || find(found.check_point) == nullptr) return {};
  const auto here = following_.find(found.check_point);
  return here == following_.end() ? std::vector<CheckPoint>{} : here->second;
}

double StartGraph::distance(const CheckPoint& p) const {
  const Target* target = find(p);
  return target != nullptr ? target->distance : 0;
}

std::unique_ptr<ExplorationStrategy> StartGraph::make_strategy(int rank, int num_ranks) const {
  std::vector<const Target*> own;
  for (const Target& target : targets_) {
    if (owner_of(owner_key(tool_space_, target.check_point), num_ranks) == rank) {
      own.push_back(&target);
    }
  }
  return std::make_unique<OwnedTargets>(*this, std::move(own));
}

}  // namespace palpate
