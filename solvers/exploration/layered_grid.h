// SPDX-License-Identifier: BSD-3-Clause
// The flat space on a uniform grid, built in layers around rest [P07b]: layer l holds the
// check-points whose largest index is l in magnitude, and each is reached from the usable ones of
// layer l − 1 that touch it, the nearest to the straight way from rest first. By this rule another
// number of ranks, or a run that was resumed, finds the same branch.
//
// A check-point beyond the force limit, or whose solve failed, is no start: where that leaves none,
// the check-point is not computed.
//
// [P07b] Peterlík, Distributed Precomputation of State-space…, MEMICS 2007.
#pragma once

#include "exploration/frontier.h"

namespace palpate {

class LayeredGrid final : public Frontier {
 public:
  /// @param sites_at_once Sites whose layers are made together: enough to occupy the ranks.
  LayeredGrid(std::vector<Site> sites, int sites_at_once);

  [[nodiscard]] std::vector<Transition> next() override;
  void accept(Index active_node, const ConfigurationSummary& found) override;
  [[nodiscard]] std::int64_t num_expected() const override;

 private:
  /// Check-points of the layer before that may be started from, by active node.
  using Starts = std::unordered_map<Index, std::vector<CheckPoint>>;

  void add_layer(const Site& site, std::vector<Transition>& transitions) const;

  std::vector<Site> sites_;
  std::size_t sites_at_once_;
  std::size_t first_site_ = 0;
  std::int32_t layer_ = -1;
  Starts starts_;
  Starts found_;
};

}  // namespace palpate
