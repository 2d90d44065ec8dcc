// SPDX-License-Identifier: BSD-3-Clause
// The flat space on a uniform grid, in layers around rest [P07b]: layer l holds the check-points
// whose largest index is l in magnitude, and each is reached from the usable ones of layer l − 1
// that touch it, the nearest to the straight way from rest first: the next is tried where the step
// from one fails. By this rule another number of ranks, or a run that was resumed, finds the same
// branch.
//
// A check-point beyond the force limit, or whose solve failed, is no start: where that leaves none,
// the check-point is not computed.
//
// [P07b] Peterlík, Distributed Precomputation of State-space…, MEMICS 2007.
#pragma once

#include <map>

#include "exploration/frontier.h"

namespace palpate {

class LayeredGrid final : public Frontier {
 public:
  explicit LayeredGrid(const std::vector<Site>& sites);

  [[nodiscard]] std::vector<Transition> next() override;
  [[nodiscard]] std::vector<Transition> following(
      Index active_node, const ConfigurationSummary& found) const override;
  [[nodiscard]] std::int64_t num_following(const Transition& transition) const override;
  void accept(Index active_node, const ConfigurationSummary& found) override;
  [[nodiscard]] bool is_settled(Index active_node, const CheckPoint& target) const override;
  [[nodiscard]] std::int64_t num_expected() const override;

 private:
  enum class Status : char {
    /// Not found yet.
    open,
    /// Found, and others may be reached from it.
    start,
    /// Others may not be reached from it: it failed, is beyond the force limit or is not reached.
    no_start,
  };

  struct SiteGrid {
    explicit SiteGrid(const Site& site);
    [[nodiscard]] Status& at(const CheckPoint& p) { return status[index(p)]; }
    [[nodiscard]] Status at(const CheckPoint& p) const { return status[index(p)]; }
    [[nodiscard]] std::size_t index(const CheckPoint& p) const;

    std::int32_t reach;
    /// [resolution³], k fastest.
    std::vector<Status> status;
    /// Where the last step to an open check-point began, that failed.
    std::map<CheckPoint, CheckPoint> failed_from;
  };

  /// Settles those that nothing leads to, and adds the others whose start is known.
  static void add_layer(Index active_node, SiteGrid& grid, std::int32_t layer,
                        std::vector<Transition>& transitions);
  [[nodiscard]] static std::vector<CheckPoint> following(const SiteGrid& grid,
                                                         const CheckPoint& start);
  [[nodiscard]] static std::int64_t num_following(const SiteGrid& grid, const CheckPoint& start);

  /// By active node.
  std::map<Index, SiteGrid> grids_;
};

}  // namespace palpate
