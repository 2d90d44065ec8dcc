// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/shell_branches.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "interpolation/branch_test.h"
#include "interpolation/error_estimate.h"
#include "interpolation/leaf_edges.h"

namespace palpate {
namespace {

/// The number of layers of cells around what is new on a branch that it has too, and how many of
/// them the body stays on it.
constexpr int kMargin = 5;
constexpr int kReturns = 3;

/// The number of layers of cells beside a break whose mixed derivatives depend on differences
/// across it or up to it; and the error, as a share of a large force, that is too large in the
/// first of them, twice that in the second, and so on.
constexpr int kLayers = 3;
constexpr double kLargeErrorALayer = 0.008;

class ShellBuilder {
 public:
  ShellBuilder(const Grid& grid, const std::vector<ConfigurationSummary>& all)
      : all_(all),
        grid_(grid),
        tree_(grid, all),
        edges_(tree_),
        fit_(all),
        covered_(all.size(), 0) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!all[i].usable() || (all[i].flags & flags::unstable) != 0) continue;
      at_[all[i].check_point].push_back(static_cast<std::int32_t>(i));
    }
  }

  ShellBranches find() {
    grow_first();
    for (const std::int32_t seed : seeds()) {
      if (covered_[seed] == 0 && branches_.size() < kMost) grow_further(seed);
    }
    ShellBranches result{{}, tree_, next(), {}, parts(), branches_.size() > 1};
    for (const Branch& branch : branches_) {
      std::vector<std::int32_t>& members = result.configurations.emplace_back();
      for (const auto& [p, member] : branch) members.push_back(member.configuration);
    }
    std::vector<std::int32_t>& flat = result.configurations.front();
    flat.clear();
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (all_[i].level == 0) flat.push_back(static_cast<std::int32_t>(i));
    }
    for (std::vector<std::int32_t>& members : result.configurations) {
      std::sort(members.begin(), members.end());
    }
    result.ends = ends(result);
    result.any_end = result.any_end || std::find(result.ends.begin(), result.ends.end(),
                                                 BranchEnd::untried) != result.ends.end();
    for (std::size_t l = 0; l < tree_.leaves().size() && !result.any_end; ++l) {
      const bool is_spanned = branches_at_.count(static_cast<std::int32_t>(l)) > 0;
      result.any_end = !is_spanned && is_complete(tree_.leaves()[l].cell);
    }
    return result;
  }

 private:
  static constexpr std::size_t kMost = std::numeric_limits<std::int16_t>::max();

  struct Member {
    std::int32_t configuration = 0;
    /// The number of layers of cells from what is new on the branch.
    int layer = 0;
  };
  using Branch = std::map<CheckPoint, Member>;

  [[nodiscard]] bool touches_nothing(std::int32_t i) const {
    return all_[i].level == 0 && (all_[i].flags & flags::touches_nothing) != 0;
  }
  /// All configurations from which others may be reached: those where the tool touches nothing
  /// first, then by level and check-point.
  [[nodiscard]] std::vector<std::int32_t> seeds() const {
    std::vector<std::int32_t> seeds;
    for (const auto& [p, here] : at_) {
      for (const std::int32_t i : here) {
        if (all_[i].leads_on()) seeds.push_back(i);
      }
    }
    const auto rank = [&](std::int32_t i) {
      return std::pair(touches_nothing(i) ? 0 : 1, all_[i].level);
    };
    std::stable_sort(seeds.begin(), seeds.end(),
                     [&](std::int32_t a, std::int32_t b) { return rank(a) < rank(b); });
    return seeds;
  }

  [[nodiscard]] const std::vector<std::int32_t>& list_at(const CheckPoint& p) const {
    static const std::vector<std::int32_t> none;
    const auto here = at_.find(p);
    return here == at_.end() ? none : here->second;
  }

  /// Whether there are configurations at all corners of a cell.
  [[nodiscard]] bool is_complete(const Cell& cell) const {
    int corner = 0;
    while (corner < 8 && at_.count(corner_of(cell, corner)) > 0) ++corner;
    return corner == 8;
  }

  /// The number of the configurations at a check-point that fit one.
  [[nodiscard]] std::ptrdiff_t num_fitting(const CheckPoint& p,
                                           const ConfigurationSummary& to_fit) const {
    const std::vector<std::int32_t>& here = list_at(p);
    return std::count_if(here.begin(), here.end(),
                         [&](std::int32_t i) { return fit_.fits(all_[i], to_fit); });
  }

  enum class Way { unknown, smooth, broken };
  [[nodiscard]] Way way_between(const ConfigurationSummary& a,
                                const ConfigurationSummary& b) const {
    const std::int32_t there = a.reached[neighbour_number(a.check_point, b.check_point)];
    const std::int32_t back = b.reached[neighbour_number(b.check_point, a.check_point)];
    const bool has_gone = there == b.level;
    const bool has_come = back == a.level;
    const bool is_tried = there != not_tried || back != not_tried;
    if (has_gone && has_come) return Way::smooth;
    if (has_gone || has_come) return fit_.fits(a, b) ? Way::smooth : Way::broken;
    if (is_tried) return Way::broken;
    const bool is_only = list_at(a.check_point).size() == 1 && list_at(b.check_point).size() == 1;
    if (is_only) return Way::smooth;
    if (!fit_.fits(a, b)) return Way::unknown;
    const bool fits_only = num_fitting(a.check_point, b) == 1 && num_fitting(b.check_point, a) == 1;
    return fits_only ? Way::smooth : Way::unknown;
  }

  template <class Visit>
  void for_each_neighbour(const ConfigurationSummary& c, Visit&& visit) const {
    for (const CheckPoint& q : edges_.neighbours(c.check_point)) {
      for (const std::int32_t i : list_at(q)) visit(i);
    }
  }

  /// Whether a configuration may join a branch beside another one of it.
  [[nodiscard]] bool may_join(const Branch& branch, const ConfigurationSummary& from,
                              const ConfigurationSummary& c) const {
    if (branch.count(c.check_point) > 0 || way_between(from, c) != Way::smooth) return false;
    return !is_broken(branch, c);
  }
  [[nodiscard]] bool is_broken(const Branch& branch, const ConfigurationSummary& c) const {
    bool broken = false;
    for_each_neighbour(c, [&](std::int32_t i) {
      const auto here = branch.find(all_[i].check_point);
      broken = broken || (here != branch.end() && here->second.configuration == i &&
                          way_between(all_[i], c) == Way::broken);
    });
    return broken;
  }

  /// Adds to a branch what is connected with its border.
  /// @param is_wanted Of the configurations that may join. @param layer That of those that do.
  template <class Wanted>
  void spread(Branch& branch, std::deque<std::int32_t> border, int layer, bool goes_on,
              std::vector<std::int32_t>& joined, Wanted&& is_wanted) const {
    while (!border.empty()) {
      const ConfigurationSummary& from = all_[border.front()];
      border.pop_front();
      if (!from.leads_on()) continue;
      for_each_neighbour(from, [&](std::int32_t i) {
        if (!is_wanted(i) || !may_join(branch, from, all_[i])) return;
        branch.emplace(all_[i].check_point, Member{i, layer});
        joined.push_back(i);
        if (goes_on) border.push_back(i);
      });
    }
  }

  void grow_first() {
    Branch branch;
    const auto is_flat = [&](std::int32_t i) { return all_[i].level == 0; };
    std::vector<std::int32_t> joined;
    std::deque<std::int32_t> border;
    for (const std::int32_t seed : seeds()) {
      if (!touches_nothing(seed)) continue;
      branch.emplace(all_[seed].check_point, Member{seed, 0});
      border.push_back(seed);
    }
    spread(branch, border, 0, true, joined, is_flat);
    // What is connected with no place where the tool touches nothing.
    for (const std::int32_t seed : seeds()) {
      const ConfigurationSummary& c = all_[seed];
      if (c.level != 0 || branch.count(c.check_point) > 0 || is_broken(branch, c)) continue;
      branch.emplace(c.check_point, Member{seed, 0});
      spread(branch, {seed}, 0, true, joined, is_flat);
    }
    for (const auto& [p, member] : branch) covered_[member.configuration] = 1;
    take(std::move(branch));
  }

  void grow_further(std::int32_t seed) {
    Branch branch;
    branch.emplace(all_[seed].check_point, Member{seed, 0});
    std::vector<std::int32_t> joined{seed};
    spread(branch, {seed}, 0, true, joined, [&](std::int32_t i) { return covered_[i] == 0; });
    for (const std::int32_t i : joined) covered_[i] = 1;
    for (int layer = 1; layer <= kMargin; ++layer) {
      std::vector<std::int32_t> margin;
      spread(branch, {joined.begin(), joined.end()}, layer, false, margin,
             [](std::int32_t /*i*/) { return true; });
      joined = std::move(margin);
    }
    take(std::move(branch));
  }

  /// The leaves around the check-points of a branch, ascending.
  [[nodiscard]] std::vector<std::int32_t> leaves_at(const Branch& branch) const {
    std::vector<std::int32_t> leaves;
    for (const auto& [p, member] : branch) {
      tree_.for_each_leaf_around(p, [&](std::int32_t l) { leaves.push_back(l); });
    }
    std::sort(leaves.begin(), leaves.end());
    leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
    return leaves;
  }

  /// Keeps a branch, unless it is a further one that spans no leaf.
  void take(Branch branch) {
    std::vector<std::int32_t> spanned;
    for (const std::int32_t l : leaves_at(branch)) {
      if (num_shared(branch, branch, tree_.leaves()[l].cell) == 8) spanned.push_back(l);
    }
    if (!branches_.empty() && spanned.empty()) return;
    for (const std::int32_t l : spanned) branches_at_[l].push_back(branches_.size());
    branches_.push_back(std::move(branch));
  }

  [[nodiscard]] std::vector<std::int16_t> next() const {
    std::vector<std::int16_t> all;
    const std::size_t num_leaves = tree_.leaves().size();
    all.reserve(num_leaves * branches_.size());
    for (std::size_t l = 0; l < num_leaves; ++l) {
      const auto here = branches_at_.find(static_cast<std::int32_t>(l));
      for (std::size_t s = 0; s < branches_.size(); ++s) {
        all.push_back(here == branches_at_.end()
                          ? std::int16_t{0}
                          : next_of(s, tree_.leaves()[l].cell, here->second));
      }
    }
    return all;
  }

  /// Where a branch has nothing at the corners of a leaf, it ends.
  [[nodiscard]] std::vector<BranchEnd> ends(const ShellBranches& found) const {
    std::vector<BranchEnd> all(found.next.size(), BranchEnd::tried);
    std::vector<std::set<std::int32_t>> wrong;
    for (std::size_t s = 0; s < branches_.size(); ++s) wrong.push_back(may_be_wrong(s, found));
    for (const LeafOfBranch& part : found.parts) {
      const auto s = static_cast<std::size_t>(part.branch);
      const auto at = static_cast<std::size_t>(part.leaf) * branches_.size() + s;
      const Cell& cell = tree_.leaves()[part.leaf].cell;
      const int num_own = num_shared(branches_[s], branches_[s], cell);
      const Branch& other = branches_[static_cast<std::size_t>(found.next[at])];
      const bool goes_on = num_shared(branches_[s], other, cell) == num_own;
      const bool is_spanned = branches_at_.count(part.leaf) > 0;
      const bool ends = num_own < 8 ? !(goes_on && is_spanned) : wrong[s].count(part.leaf) > 0;
      all[at] = !ends                            ? BranchEnd::none
                : is_untried(branches_[s], cell) ? BranchEnd::untried
                                                 : BranchEnd::tried;
    }
    return all;
  }

  /// Whether along an edge of a cell no transition was tried where a branch ends, or where its
  /// energy does not fit its forces.
  [[nodiscard]] bool is_untried(const Branch& branch, const Cell& cell) const {
    for (int corner = 0; corner < 8; ++corner) {
      const CheckPoint p = corner_of(cell, corner);
      const auto here = branch.find(p);
      if (here == branch.end() || here->second.layer == kMargin) continue;
      const ConfigurationSummary& from = all_[here->second.configuration];
      for (int axis = 0; axis < 3; ++axis) {
        const CheckPoint q = corner_of(cell, corner ^ (1 << axis));
        const auto beside = branch.find(q);
        const bool goes_on =
            beside != branch.end() &&
            !(fit_.force_misfit(from, all_[beside->second.configuration]) > kForceMisfitAcross);
        if (goes_on || at_.count(q) == 0 || !from.leads_on()) continue;
        if (from.reached[neighbour_number(p, q)] == not_tried) return true;
      }
    }
    return false;
  }

  /// How many layers of cells a check-point is away from where the energy of a branch does not fit
  /// its forces along an edge, or where the branch ends.
  using Layers = std::map<CheckPoint, int>;
  [[nodiscard]] Layers layers_from_breaks(const Branch& branch,
                                          const std::vector<std::int32_t>& leaves) const {
    Layers layers;
    for (const auto& [p, member] : branch) {
      for (const CheckPoint& q : edges_.neighbours(p)) {
        const auto beside = branch.find(q);
        // Beyond its margin a branch is not continued.
        const bool ends_here = at_.count(q) > 0 && member.layer < kMargin;
        const bool is_break = beside == branch.end() ? ends_here : !fits(member, beside->second);
        if (is_break) layers[p] = 0;
      }
    }
    for (int layer = 1; layer < kLayers; ++layer) {
      Layers further = layers;
      for (const std::int32_t l : leaves) {
        const Cell& cell = tree_.leaves()[l].cell;
        if (layer_of(cell, layers) == kLayers) continue;
        for (int corner = 0; corner < 8; ++corner) further.emplace(corner_of(cell, corner), layer);
      }
      layers = std::move(further);
    }
    return layers;
  }
  /// kLayers: far away.
  [[nodiscard]] static int layer_of(const Cell& cell, const Layers& layers) {
    int nearest = kLayers;
    for (int corner = 0; corner < 8; ++corner) {
      const auto here = layers.find(corner_of(cell, corner));
      if (here != layers.end()) nearest = std::min(nearest, here->second);
    }
    return nearest;
  }

  /// The leaves of those that a branch spans in which its force may be wrong.
  [[nodiscard]] std::set<std::int32_t> may_be_wrong(std::size_t branch,
                                                    const ShellBranches& found) const {
    const Branch& own = branches_[branch];
    std::vector<std::int32_t> spanned;
    for (const auto& [leaf, branches] : branches_at_) {
      if (std::find(branches.begin(), branches.end(), branch) != branches.end()) {
        spanned.push_back(leaf);
      }
    }
    const Layers layers = layers_from_breaks(own, spanned);
    std::set<std::int32_t> wrong;
    std::vector<std::int32_t> doubtful;
    std::vector<Cell> cells;
    std::vector<double> most;
    for (const std::int32_t l : spanned) {
      const Cell& cell = tree_.leaves()[l].cell;
      const int layer = layer_of(cell, layers);
      if (layer == kLayers) continue;
      if (layer == 0 && has_misfit(own, cell)) {
        wrong.insert(l);
        continue;
      }
      doubtful.push_back(l);
      cells.push_back(cell);
      most.push_back(kLargeErrorALayer * (1 + layer) * fit_.large_force());
    }
    if (cells.empty()) return wrong;
    std::vector<ConfigurationSummary> of_branch;
    for (const std::int32_t i : found.configurations[branch]) {
      of_branch.push_back(all_[i]);
      of_branch.back().flags &= ~flags::near_fold;  // As restricted() does.
    }
    const std::vector<double> errors = estimate_errors_in(grid_, of_branch, cells);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (errors[c] > most[c]) wrong.insert(doubtful[c]);
    }
    return wrong;
  }

  [[nodiscard]] bool has_misfit(const Branch& branch, const Cell& cell) const {
    for (int corner = 0; corner < 8; ++corner) {
      const Member& member = branch.at(corner_of(cell, corner));
      for (const CheckPoint& q : edges_.neighbours(corner_of(cell, corner))) {
        const auto beside = branch.find(q);
        if (beside != branch.end() && !fits(member, beside->second)) return true;
      }
    }
    return false;
  }
  [[nodiscard]] bool fits(const Member& a, const Member& b) const {
    return fit_.fits(all_[a.configuration], all_[b.configuration]);
  }

  [[nodiscard]] std::vector<LeafOfBranch> parts() const {
    std::vector<LeafOfBranch> all;
    for (std::size_t s = 0; s < branches_.size(); ++s) {
      for (const std::int32_t l : leaves_at(branches_[s])) {
        LeafOfBranch part{l, static_cast<std::int32_t>(s), {}};
        bool is_any = false;
        for (int corner = 0; corner < 8; ++corner) {
          const auto here = branches_[s].find(corner_of(tree_.leaves()[l].cell, corner));
          const bool has = here != branches_[s].end();
          part.configurations[corner] = has ? here->second.configuration : -1;
          is_any = is_any || has;
        }
        if (is_any) all.push_back(part);
      }
    }
    std::sort(all.begin(), all.end());
    return all;
  }

  /// The number of corners of a cell at which two branches have the same configuration.
  [[nodiscard]] int num_shared(const Branch& a, const Branch& b, const Cell& cell) const {
    int shared = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const CheckPoint p = corner_of(cell, corner);
      const auto of_a = a.find(p);
      const auto of_b = b.find(p);
      if (of_a != a.end() && of_b != b.end() &&
          of_a->second.configuration == of_b->second.configuration) {
        ++shared;
      }
    }
    return shared;
  }

  [[nodiscard]] double energy(const Branch& branch, const Cell& cell) const {
    double sum = 0;
    for (int corner = 0; corner < 8; ++corner) {
      sum += all_[branch.at(corner_of(cell, corner)).configuration].energy;
    }
    return sum / 8;
  }

  /// Whether the body goes back from a cell of a further branch to an earlier one.
  [[nodiscard]] static bool returns(const Branch& branch, const Cell& cell) {
    for (int corner = 0; corner < 8; ++corner) {
      if (branch.at(corner_of(cell, corner)).layer < kReturns) return false;
    }
    return true;
  }

  /// @param here The branches that span the cell.
  [[nodiscard]] std::int16_t next_of(std::size_t branch, const Cell& cell,
                                     const std::vector<std::size_t>& here) const {
    const Branch& own = branches_[branch];
    if (std::find(here.begin(), here.end(), branch) != here.end()) {
      const bool stays = branch == 0 || !returns(own, cell);
      for (const std::size_t s : here) {
        if (!stays && s < branch && num_shared(own, branches_[s], cell) == 8) {
          return static_cast<std::int16_t>(s);
        }
      }
      return static_cast<std::int16_t>(branch);
    }
    // The branch with which more corners are shared comes first, then that of less energy.
    const auto rank = [&](std::size_t s) {
      return std::pair(-num_shared(own, branches_[s], cell), energy(branches_[s], cell));
    };
    return static_cast<std::int16_t>(*std::min_element(
        here.begin(), here.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); }));
  }

  const std::vector<ConfigurationSummary>& all_;
  const Grid& grid_;
  CellTree tree_;
  LeafEdges edges_;
  EdgeFit fit_;
  /// The usable and stable configurations, by check-point.
  std::map<CheckPoint, std::vector<std::int32_t>> at_;
  /// Whether each configuration is new on a branch that was found.
  std::vector<char> covered_;
  std::vector<Branch> branches_;
  /// The branches that span a leaf, by its number.
  std::map<std::int32_t, std::vector<std::size_t>> branches_at_;
};

}  // namespace

ShellBranches find_shell_branches(const Grid& grid,
                                  const std::vector<ConfigurationSummary>& configurations) {
  return ShellBuilder(grid, configurations).find();
}

}  // namespace palpate
