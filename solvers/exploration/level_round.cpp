// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/level_round.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "schedule/owner.h"

namespace palpate {
namespace {

/// What one rank does in a round.
class OwnedRound final : public ExplorationStrategy {
 public:
  OwnedRound(std::vector<Transition> transitions, std::vector<Settlement> settlements)
      : transitions_(std::move(transitions)), settlements_(std::move(settlements)) {
    num_expected_ = static_cast<std::int64_t>(transitions_.size());
    num_expected_ += std::count_if(settlements_.begin(), settlements_.end(),
                                   [](const Settlement& settlement) { return settlement.is_new; });
  }

  void recall(const ConfigurationSummary& /*found*/) override {}
  void accept(const ConfigurationSummary& found) override {
    if (found.level < 0) --num_expected_;
  }
  [[nodiscard]] std::vector<Transition> next() override { return std::exchange(transitions_, {}); }
  [[nodiscard]] std::vector<CheckPoint> given_up() override { return {}; }
  [[nodiscard]] std::vector<Settlement> settled() override {
    return std::exchange(settlements_, {});
  }
  [[nodiscard]] std::int64_t num_expected() const override { return num_expected_; }

 private:
  std::vector<Transition> transitions_;
  std::vector<Settlement> settlements_;
  std::int64_t num_expected_ = 0;
};

}  // namespace

LevelRound::LevelRound(ToolSpaceKey tool_space, std::vector<Transition> transitions,
                       std::vector<Settlement> settlements,
                       std::function<double(const CheckPoint&)> distance)
    : tool_space_(tool_space),
      transitions_(std::move(transitions)),
      settlements_(std::move(settlements)),
      distance_(std::move(distance)) {}

std::unique_ptr<ExplorationStrategy> LevelRound::make_strategy(int rank, int num_ranks) const {
  const auto owns = [&](const CheckPoint& p) {
    return owner_of(owner_key(tool_space_, p), num_ranks) == rank;
  };
  std::vector<Transition> transitions;
  std::copy_if(transitions_.begin(), transitions_.end(), std::back_inserter(transitions),
               [&](const Transition& transition) { return owns(transition.start); });
  std::vector<Settlement> settlements;
  std::copy_if(settlements_.begin(), settlements_.end(), std::back_inserter(settlements),
               [&](const Settlement& settlement) { return owns(settlement.transition.target); });
  return std::make_unique<OwnedRound>(std::move(transitions), std::move(settlements));
}

}  // namespace palpate
