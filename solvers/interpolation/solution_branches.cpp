// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/solution_branches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <utility>

#include "interpolation/branch_test.h"

namespace palpate {
namespace {

/// A displacement nearer than this to the border of a cell, as a share of its side, is on the
/// border.
constexpr double kOnBorder = 1e-9;

/// A straight movement is followed in steps of this share of a cell's side, but in at most
/// kMostSteps steps.
constexpr double kStep = 0.5;
constexpr double kMostSteps = 4096;

/// The level that the transition from a to the check-point of b has reached.
std::int32_t reached(const ConfigurationSummary& a, const ConfigurationSummary& b) {
  return a.reached[neighbour_number(a.check_point, b.check_point)];
}

/// The configurations of a tool space. The transitions that the flat space has made are added to
/// those between levels.
std::vector<ConfigurationSummary> with_flat_transitions(const TouchToolSpace& tool_space) {
  std::vector<ConfigurationSummary> all = tool_space.configurations;
  for (const ConfigurationSummary& c : tool_space.configurations) {
    const int number = neighbour_number(c.parent, c.check_point);
    if (c.level != 0 || !c.usable() || number < 0 || c.parent == c.check_point) continue;
    ConfigurationSummary parent;
    parent.check_point = c.parent;
    const auto here = std::lower_bound(all.begin(), all.end(), parent);
    if (here == all.end() || here->check_point != c.parent || here->level != 0) continue;
    here->reached[number] = 0;
  }
  return all;
}

enum class Way { unknown, smooth, broken };

Way way_between(const ConfigurationSummary& a, const ConfigurationSummary& b) {
  const std::int32_t there = reached(a, b);
  const std::int32_t back = reached(b, a);
  // No configuration is reached from one beyond the force limit, which only bounds the cells before
  // it.
  if (!a.leads_on() || !b.leads_on()) {
    return there == b.level || back == a.level ? Way::smooth : Way::unknown;
  }
  if ((there != not_tried && there != b.level) || (back != not_tried && back != a.level)) {
    return Way::broken;
  }
  if (there != not_tried && back != not_tried) return Way::smooth;
  // A transition in one direction alone may have been a jump.
  const auto jumped = [](const ConfigurationSummary& from, const ConfigurationSummary& to) {
    return to.parent == from.check_point && to.parent_level == from.level &&
           (to.flags & flags::near_fold) != 0;
  };
  if (jumped(a, b) || jumped(b, a)) return Way::broken;
  if (there != not_tried || back != not_tried) return Way::smooth;
  const bool same_flags = ((a.flags ^ b.flags) & flags::near_fold) == 0;
  return a.level == 0 && b.level == 0 && same_flags ? Way::smooth : Way::unknown;
}

/// Finds the branches of a tool space with levels.
class Builder {
 public:
  explicit Builder(const TouchToolSpace& tool_space) : all_(with_flat_transitions(tool_space)) {
    for (std::size_t i = 0; i < all_.size(); ++i) {
      if (!all_[i].usable() || (all_[i].flags & flags::unstable) != 0) continue;
      at_[all_[i].check_point].push_back(static_cast<std::int32_t>(i));
    }
  }

  std::vector<std::vector<std::int32_t>> find() {
    std::vector<std::int32_t> seeds;
    for (const auto& [p, here] : at_) {
      std::copy_if(here.begin(), here.end(), std::back_inserter(seeds),
                   [&](std::int32_t i) { return all_[i].leads_on(); });
    }
    const auto from_rest = [&](std::int32_t i) {
      std::int64_t squared = 0;
      for (std::int32_t x : all_[i].check_point) squared += std::int64_t{x} * x;
      return std::pair(all_[i].level, squared);
    };
    std::stable_sort(seeds.begin(), seeds.end(),
                     [&](std::int32_t a, std::int32_t b) { return from_rest(a) < from_rest(b); });
    std::vector<char> covered(all_.size(), 0);
    std::vector<std::vector<std::int32_t>> branches;
    constexpr std::size_t kMost = std::numeric_limits<std::int16_t>::max();
    for (std::int32_t seed : seeds) {
      if (covered[seed] != 0 || branches.size() == kMost) continue;
      Branch branch = grow(seed);
      std::vector<std::int32_t> members;
      for (const auto& [p, i] : branch) {
        covered[i] = 1;
        members.push_back(i);
      }
      // A branch that spans no cell is of no use, except that of rest, where the body begins.
      const std::vector<CheckPoint> cells = cells_of(branch);
      if (!branches.empty() && cells.empty()) continue;
      for (const CheckPoint& first : cells) branches_at_[first].push_back(branches_.size());
      std::sort(members.begin(), members.end());
      branches.push_back(std::move(members));
      branches_.push_back(std::move(branch));
    }
    return branches;
  }

  /// The first corners of the cells that a branch spans, ascending.
  [[nodiscard]] std::vector<CheckPoint> cells() const {
    std::vector<CheckPoint> all;
    for (const auto& [first, branches] : branches_at_) all.push_back(first);
    return all;
  }

  /// For each of these cells and each branch, the branch that the body goes on with.
  [[nodiscard]] std::vector<std::int16_t> next() const {
    std::vector<std::int16_t> all;
    all.reserve(branches_at_.size() * branches_.size());
    for (const auto& [first, branches] : branches_at_) {
      for (std::size_t s = 0; s < branches_.size(); ++s) {
        all.push_back(next_of(s, first, branches));
      }
    }
    return all;
  }

 private:
  using Branch = std::map<CheckPoint, std::int32_t>;

  [[nodiscard]] Branch grow(std::int32_t seed) const {
    Branch branch{{all_[seed].check_point, seed}};
    std::deque<std::int32_t> border{seed};
    while (!border.empty()) {
      const ConfigurationSummary& from = all_[border.front()];
      border.pop_front();
      for_each_neighbour(from, [&](std::int32_t i) {
        const ConfigurationSummary& c = all_[i];
        if (branch.count(c.check_point) > 0 || way_between(from, c) != Way::smooth) return;
        if (is_broken(branch, c)) return;
        branch.emplace(c.check_point, i);
        if (c.leads_on()) border.push_back(i);
      });
    }
    return branch;
  }

  template <class F>
  void for_each_neighbour(const ConfigurationSummary& c, F&& f) const {
    for (int number = 0; number < num_neighbours; ++number) {
      const CheckPoint q = neighbour(c.check_point, number);
      const auto here = q == c.check_point ? at_.end() : at_.find(q);
      if (here == at_.end()) continue;
      for (std::int32_t i : here->second) f(i);
    }
  }

  [[nodiscard]] bool is_broken(const Branch& branch, const ConfigurationSummary& c) const {
    bool broken = false;
    for_each_neighbour(c, [&](std::int32_t i) {
      const auto here = branch.find(all_[i].check_point);
      broken = broken || (here != branch.end() && here->second == i &&
                          way_between(all_[i], c) == Way::broken);
    });
    return broken;
  }

  static CheckPoint corner(const CheckPoint& first, int c) {
    return {first[0] + (c >> 2), first[1] + (c >> 1 & 1), first[2] + (c & 1)};
  }

  /// The first corners of the cells whose corners are all on the branch.
  static std::vector<CheckPoint> cells_of(const Branch& branch) {
    std::vector<CheckPoint> cells;
    for (const auto& [first, i] : branch) {
      int corners = 0;
      while (corners < 8 && branch.count(corner(first, corners)) > 0) ++corners;
      if (corners == 8) cells.push_back(first);
    }
    return cells;
  }

  /// The number of transitions from corners on one branch that have reached another branch.
  [[nodiscard]] int votes(const Branch& from, const Branch& to, const CheckPoint& first) const {
    int sum = 0;
    for (int a = 0; a < 8; ++a) {
      const auto start = from.find(corner(first, a));
      if (start == from.end()) continue;
      for (int b = 0; b < 8; ++b) {
        const ConfigurationSummary& target = all_[to.at(corner(first, b))];
        if (a == b || from.count(corner(first, b)) > 0) continue;
        if (reached(all_[start->second], target) == target.level) ++sum;
      }
    }
    return sum;
  }

  [[nodiscard]] double energy(const Branch& branch, const CheckPoint& first) const {
    double sum = 0;
    for (int c = 0; c < 8; ++c) sum += all_[branch.at(corner(first, c))].energy;
    return sum / 8;
  }

  /// @param here The branches that span the cell.
  [[nodiscard]] std::int16_t next_of(std::size_t branch, const CheckPoint& first,
                                     const std::vector<std::size_t>& here) const {
    std::size_t best = branch;
    std::pair<int, double> most{0, std::numeric_limits<double>::infinity()};
    for (std::size_t s : here) {
      if (s == branch) return static_cast<std::int16_t>(branch);
      // More votes come first, then less energy.
      const std::pair<int, double> of_s{-votes(branches_[branch], branches_[s], first),
                                        energy(branches_[s], first)};
      if (of_s < most) {
        most = of_s;
        best = s;
      }
    }
    return static_cast<std::int16_t>(best);
  }

  std::vector<ConfigurationSummary> all_;
  /// The usable and stable configurations, by check-point.
  std::map<CheckPoint, std::vector<std::int32_t>> at_;
  std::vector<Branch> branches_;
  /// The branches that span a cell, by its first corner.
  std::map<CheckPoint, std::vector<std::size_t>> branches_at_;
};

/// Whether a space of a rigid tool has an edge that a search for levels would try.
/// @param all They are in the order of operator<.
bool is_torn(const Grid& grid, const std::vector<ConfigurationSummary>& all) {
  const EdgeFit fit(all);
  const auto find = [&](const CheckPoint& p) -> const ConfigurationSummary* {
    const auto at = std::lower_bound(
        all.begin(), all.end(), p,
        [](const ConfigurationSummary& c, const CheckPoint& q) { return c.check_point < q; });
    return at != all.end() && at->check_point == p ? &*at : nullptr;
  };
  const auto is_torn_at = [&](const ConfigurationSummary& c, int axis) {
    for (std::int32_t steps = 1; steps <= grid.coarsest; steps *= 2) {
      CheckPoint next = c.check_point;
      next[axis] += steps;
      const ConfigurationSummary* other = find(next);
      if (other == nullptr) continue;
      return other->usable() && fit.force_misfit(c, *other) > kForceMisfitAcross;
    }
    return false;
  };
  return std::any_of(all.begin(), all.end(), [&](const ConfigurationSummary& c) {
    return c.usable() && (is_torn_at(c, 0) || is_torn_at(c, 1) || is_torn_at(c, 2));
  });
}

}  // namespace

SolutionBranches::SolutionBranches(const TouchToolSpace& tool_space)
    : spacing_(tool_space.setup.grid.spacing()),
      reach_(tool_space.setup.grid.reach()),
      origin_(tool_space.setup.grid.origin) {
  const auto& all = tool_space.configurations;
  const auto has_history = [](const ConfigurationSummary& c) { return c.has_history(); };
  const bool has_levels = std::any_of(all.begin(), all.end(), has_history);
  const bool is_shell = tool_space.setup.grid.sparse;
  const bool may_have = is_shell && tool_space.setup.policy.history != History::flat;
  if (is_shell && (has_levels || (may_have && is_torn(tool_space.setup.grid, all)))) {
    ShellBranches found = find_shell_branches(tool_space.setup.grid, all);
    configurations_ = std::move(found.configurations);
    if (found.any_end) {
      leaves_ = std::move(found.tree);
      next_ = std::move(found.next);
      ends_ = std::move(found.ends);
      parts_ = std::move(found.parts);
    }
  } else if (has_levels) {
    Builder builder(tool_space);
    configurations_ = builder.find();
    if (configurations_.size() > 1) {
      cells_ = builder.cells();
      next_ = builder.next();
    }
  }
  if (configurations_.empty()) {
    configurations_.emplace_back(all.size());
    std::iota(configurations_.front().begin(), configurations_.front().end(), 0);
  }
}

int SolutionBranches::move(int branch, const Vec3& from, const Vec3& to) const noexcept {
  return move(OnBranch{branch}, from, to).number;
}

OnBranch SolutionBranches::move(const OnBranch& branch, const Vec3& from,
                                const Vec3& to) const noexcept {
  OnBranch on = branch;
  if (next_.empty() || !from.allFinite() || !to.allFinite()) return on;
  const Vec3 way = to - from;
  const double steps =
      std::clamp(std::ceil(way.lpNorm<Eigen::Infinity>() / (kStep * spacing_)), 1.0, kMostSteps);
  for (double step = 1; step <= steps; ++step) {
    const Vec3 t = from + (step / steps) * way;
    if (leaves_) {
      on = follow_in_leaves(on, t);
    } else {
      on.number = follow(on.number, t);
    }
  }
  return on;
}

int SolutionBranches::next(int branch, const CheckPoint& cell) const noexcept {
  const auto found = std::lower_bound(cells_.begin(), cells_.end(), cell);
  if (found == cells_.end() || *found != cell) return branch;
  const auto at = static_cast<std::size_t>(found - cells_.begin()) * configurations_.size();
  return next_[at + static_cast<std::size_t>(branch)];
}

std::int32_t SolutionBranches::leaf_at(const Vec3& t) const noexcept {
  Vec3 x = (t - origin_) / spacing_ + Vec3::Constant(reach_);
  x = x.cwiseMax(0).cwiseMin(2.0 * reach_);
  const std::int32_t leaf = leaves_->locate(x).leaf;
  return leaf < CellTree::kFree ? leaf : -1;
}

bool SolutionBranches::ends_at(int branch, const Vec3& t) const noexcept {
  if (!leaves_ || !t.allFinite()) return false;
  const std::int32_t leaf = leaf_at(t);
  return leaf >= 0 && ends_[place_of(leaf, branch)] != BranchEnd::none;
}

bool SolutionBranches::may_be_on_left(std::int32_t leaf, const OnBranch& branch) const noexcept {
  if (branch.left < 0) return false;
  const auto find = [&](std::int32_t of) {
    const LeafOfBranch sought{leaf, of, {}};
    const auto found = std::lower_bound(parts_.begin(), parts_.end(), sought);
    return found != parts_.end() && !(sought < *found) ? &*found : nullptr;
  };
  const LeafOfBranch* own = find(branch.left);
  if (own == nullptr || branch.left == branch.number) return branch.is_untried;
  const LeafOfBranch* others = find(branch.number);
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::int32_t here = own->configurations[corner];
    if (here < 0 || others == nullptr || others->configurations[corner] != here) return true;
  }
  return false;
}

OnBranch SolutionBranches::follow_in_leaves(OnBranch branch, const Vec3& t) const noexcept {
  const std::int32_t leaf = leaf_at(t);
  if (leaf < 0) return branch;
  const std::size_t place = place_of(leaf, branch.number);
  const std::int32_t before = branch.number;
  branch.number = next_[place];
  if (ends_[place] != BranchEnd::none) {
    branch.left = before;
    branch.is_untried = branch.is_untried || ends_[place] == BranchEnd::untried;
  }
  if (!may_be_on_left(leaf, branch)) {
    branch.left = -1;
    branch.is_untried = false;
  }
  return branch;
}

int SolutionBranches::follow(int branch, const Vec3& t) const noexcept {
  const std::int32_t n = 2 * reach_;
  CheckPoint cell{};
  /// −1 or 1 along an axis: t lies on the border with the cell before or after.
  CheckPoint beside{};
  for (int k = 0; k < 3; ++k) {
    const double x =
        std::clamp((t[k] - origin_[k]) / spacing_ + reach_, 0.0, static_cast<double>(n));
    cell[k] = std::min(static_cast<std::int32_t>(x), n - 1);
    const double s = x - cell[k];
    if (s < kOnBorder && cell[k] > 0) beside[k] = -1;
    if (s > 1 - kOnBorder && cell[k] + 1 < n) beside[k] = 1;
    cell[k] -= reach_;
  }
  const int here = next(branch, cell);
  if (here == branch || beside == CheckPoint{}) return here;
  for (int across = 1; across < 8; ++across) {
    CheckPoint other = cell;
    for (int k = 0; k < 3; ++k) other[k] += (across >> k & 1) * beside[k];
    if (next(branch, other) == branch) return branch;
  }
  return here;
}

TouchToolSpace on_branch(const TouchToolSpace& tool_space, const SolutionBranches& branches,
                         int branch) {
  TouchToolSpace part = restricted(tool_space, branches.configurations(branch));
  if (branch > 0 && tool_space.setup.grid.sparse) part.clearance = {};
  return part;
}

TouchToolSpace restricted(const TouchToolSpace& tool_space,
                          const std::vector<std::int32_t>& configurations) {
  TouchToolSpace part;
  part.setup = tool_space.setup;
  part.clearance = tool_space.clearance;
  const auto size = static_cast<Eigen::Index>(configurations.size());
  part.coefficients.resize(tool_space.coefficients.rows(), size);
  part.coefficient_gradients.resize(tool_space.coefficient_gradients.rows(), size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const std::int32_t of_space = configurations[static_cast<std::size_t>(i)];
    ConfigurationSummary& c = part.configurations.emplace_back(
        tool_space.configurations[static_cast<std::size_t>(of_space)]);
    // The jump that led to this configuration is not on the branch.
    if (configurations.size() < tool_space.configurations.size()) c.flags &= ~flags::near_fold;
    part.coefficients.col(i) = tool_space.coefficients.col(of_space);
    part.coefficient_gradients.col(i) = tool_space.coefficient_gradients.col(of_space);
  }
  // Keep the intermediate states on the way to a first level; those of other levels do not exist.
  const auto leads_here = [&](const IntermediateState& state) {
    ConfigurationSummary target;
    target.check_point = state.target;
    return std::binary_search(part.configurations.begin(), part.configurations.end(), target);
  };
  std::copy_if(tool_space.intermediate_states.begin(), tool_space.intermediate_states.end(),
               std::back_inserter(part.intermediate_states), leads_here);
  return part;
}

}  // namespace palpate
