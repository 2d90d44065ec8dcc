// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/hermite_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "interpolation/extrapolated_node.h"

namespace palpate {
namespace {

constexpr int kStencil = kHermiteStencil;

using Order = std::array<int, 3>;

/// The difference at a node along an axis; size 1: there is none.
struct Stencil {
  int size = 1;
  std::array<std::int32_t, kStencil> nodes{};
  std::array<double, kStencil> weights{};
};

/// The next node along each edge that begins at a node: [axis][0: downwards, 1: upwards]; −1: none.
using Links = std::array<std::array<std::int32_t, 2>, 3>;

std::vector<Links> find_links(const CheckPointGrid& grid) {
  constexpr Links none{{{-1, -1}, {-1, -1}, {-1, -1}}};
  std::vector<Links> links(static_cast<std::size_t>(grid.num_nodes()), none);
  std::vector<Links> lengths(links.size());
  const auto add = [&](std::int32_t from, std::int32_t to, int axis, int up, std::int32_t length) {
    std::int32_t& known = links[from][axis][up];
    if (known >= 0 && lengths[from][axis][up] <= length) return;
    known = to;
    lengths[from][axis][up] = length;
  };
  for (const CellTree::Leaf& leaf : grid.tree().leaves()) {
    for (int axis = 0; axis < 3; ++axis) {
      const int step = 4 >> axis;
      for (int corner = 0; corner < 8; ++corner) {
        if ((corner & step) != 0) continue;
        const std::int32_t low = leaf.corners[corner];
        const std::int32_t high = leaf.corners[corner + step];
        add(low, high, axis, 1, leaf.cell.side);
        add(high, low, axis, 0, leaf.cell.side);
      }
    }
  }
  return links;
}

/// The weights of the derivative at x[p] of the polynomial through x[0 … n − 1].
void fill_weights(const double* x, int n, int p, double* weights) {
  for (int j = 0; j < n; ++j) {
    weights[j] = 0;
    if (j == p) {
      for (int i = 0; i < n; ++i) {
        if (i != p) weights[j] += 1.0 / (x[p] - x[i]);
      }
      continue;
    }
    weights[j] = 1.0 / (x[j] - x[p]);
    for (int i = 0; i < n; ++i) {
      if (i != j && i != p) weights[j] *= (x[p] - x[i]) / (x[j] - x[i]);
    }
  }
}

/// Finds the differences at the nodes, of at most `most` nodes. A row that ends at the side of a
/// larger leaf is continued into it by inserted points, at which the leaf gives the data.
class StencilFinder {
 public:
  /// @param growth What has changed in a grid that has grown; null: all of it is new.
  StencilFinder(const CheckPointGrid& grid, const HermiteDataOptions& options,
                const CellTree::Growth* growth)
      : grid_(grid),
        links_(find_links(grid)),
        most_(options.most),
        fewer_in_short_rows_(options.fewer_in_short_rows) {
    const char all = growth == nullptr ? 1 : 0;
    is_anew_.assign(static_cast<std::size_t>(grid.num_nodes()), all);
    is_leaf_anew_.assign(grid.tree().leaves().size(), 1);
    if (growth == nullptr) return;
    for (const std::int32_t n : growth->nodes_anew) is_anew_[n] = 1;
    for (const std::int32_t l : growth->leaves) {
      if (l >= 0) is_leaf_anew_[l] = 0;
    }
  }

  /// Whether the neighbourhood of a node has changed.
  [[nodiscard]] bool is_anew(std::int32_t node) const { return is_anew_[node] != 0; }
  /// Whether find() has met a node or a leaf that has changed, since begin() was called.
  [[nodiscard]] bool has_met_change() const { return has_met_change_; }
  void begin() { has_met_change_ = false; }

  [[nodiscard]] Stencil find(std::int32_t node, int axis, bool with_inserted) {
    Row row;
    row.nodes[kMiddle] = node;
    has_met_change_ = has_met_change_ || is_anew(node);
    const CheckPoint origin = grid_.tree().point(node);
    std::array<bool, 2> ends_in_leaf{};
    for (int up = 0; up < 2; ++up) {
      for (std::int32_t n = node; row.count[up] + 1 < most_;) {
        n = links_[n][axis][up];
        ends_in_leaf[up] = n < 0;
        has_met_change_ = has_met_change_ || (n >= 0 && is_anew(n));
        if (n < 0 || !grid_.usable(n) || (grid_.is_marking(n) && !grid_.is_marking(node))) break;
        row.add(up, n, grid_.tree().point(n)[axis] - origin[axis]);
      }
    }
    for (int up = 0; up < 2 && with_inserted; ++up) {
      while (ends_in_leaf[up] && row.count[up] < kStencil / 2 && row.size() < most_) {
        const double x = row.next(up);
        CheckPoint p = origin;
        p[axis] += static_cast<std::int32_t>(x);
        const std::int32_t inserted = x == 0 ? -1 : find_inserted(p);
        if (inserted < 0) break;
        row.add(up, inserted, x);
      }
    }
    return best_of(row);
  }

  struct Inserted {
    CheckPoint check_point{};
    CellTree::Place place;
    /// Whether the leaf has changed.
    bool is_anew = false;
  };
  /// The inserted points, which are numbered after the nodes. A point may occur several times.
  [[nodiscard]] const std::vector<Inserted>& inserted() const { return inserted_; }

 private:
  static constexpr int kMiddle = kStencil - 1;

  /// Nodes along an axis in ascending order, the node itself in the middle, and their distances
  /// from it.
  struct Row {
    std::array<std::int32_t, 2 * kStencil - 1> nodes{};
    std::array<double, 2 * kStencil - 1> x{};
    /// The numbers of nodes before and after the middle.
    std::array<int, 2> count{};

    [[nodiscard]] int size() const { return count[0] + 1 + count[1]; }
    void add(int up, std::int32_t node, double at) {
      ++count[up];
      const int place = up == 1 ? kMiddle + count[up] : kMiddle - count[up];
      nodes[place] = node;
      x[place] = at;
    }
    /// The position of the next node, if it is as far as the last two are apart; 0: there is none.
    [[nodiscard]] double next(int up) const {
      const int sign = up == 1 ? 1 : -1;
      const int end = kMiddle + sign * count[up];
      return count[up] > 0 ? 2 * x[end] - x[end - sign] : -x[kMiddle - sign];
    }
  };

  /// The stencil of a row for which the product of the distances is least.
  [[nodiscard]] Stencil best_of(const Row& row) const {
    Stencil stencil;
    stencil.size = std::min(most_, row.size());
    if (fewer_in_short_rows_ && row.size() <= most_ && row.size() > 1) --stencil.size;
    int best = 0;
    double least = 0;
    for (int first = std::max(kMiddle - row.count[0], kMiddle + 1 - stencil.size);
         first <= kMiddle && first + stencil.size - 1 <= kMiddle + row.count[1]; ++first) {
      double product = 1;
      for (int i = first; i < first + stencil.size; ++i) {
        if (i != kMiddle) product *= std::abs(row.x[i]);
      }
      if (least > 0 && product >= least) continue;
      least = product;
      best = first;
    }
    std::copy_n(row.nodes.begin() + best, stencil.size, stencil.nodes.begin());
    fill_weights(row.x.data() + best, stencil.size, kMiddle - best, stencil.weights.data());
    return stencil;
  }

  /// The node at a point, or a new inserted one; −1: no usable node and no complete leaf is there.
  [[nodiscard]] std::int32_t find_inserted(const CheckPoint& p) {
    const std::int32_t node = grid_.tree().find(p);
    if (node >= 0) {
      has_met_change_ = has_met_change_ || is_anew(node);
      return grid_.usable(node) ? node : -1;
    }
    const std::int32_t reach = grid_.reach();
    if (std::any_of(p.begin(), p.end(), [&](std::int32_t x) { return std::abs(x) > reach; })) {
      return -1;
    }
    const CellTree::Place place =
        grid_.tree().locate(Vec3(p[0] + reach, p[1] + reach, p[2] + reach));
    if (place.leaf >= CellTree::kFree) return -1;
    const bool is_leaf_anew = is_leaf_anew_[place.leaf] != 0;
    has_met_change_ = has_met_change_ || is_leaf_anew;
    if (!grid_.is_complete(place.leaf)) return -1;
    inserted_.push_back({p, place, is_leaf_anew});
    return grid_.num_nodes() + static_cast<std::int32_t>(inserted_.size()) - 1;
  }

  const CheckPointGrid& grid_;
  const std::vector<Links> links_;
  const int most_;
  const bool fewer_in_short_rows_;
  std::vector<Inserted> inserted_;
  std::vector<char> is_anew_;
  std::vector<char> is_leaf_anew_;
  bool has_met_change_ = false;
};

void fill_known(const NodeData& node, double h, int known, double* d) {
  d[hermite_index(0, 0, 0)] = node.energy;
  if (known < 1) return;
  d[hermite_index(1, 0, 0)] = h * node.force[0];
  d[hermite_index(0, 1, 0)] = h * node.force[1];
  d[hermite_index(0, 0, 1)] = h * node.force[2];
  if (known < 2) return;
  const Mat3 k = 0.5 * h * h * (node.stiffness + node.stiffness.transpose());
  d[hermite_index(2, 0, 0)] = k(0, 0);
  d[hermite_index(0, 2, 0)] = k(1, 1);
  d[hermite_index(0, 0, 2)] = k(2, 2);
  d[hermite_index(1, 1, 0)] = k(0, 1);
  d[hermite_index(1, 0, 1)] = k(0, 2);
  d[hermite_index(0, 1, 1)] = k(1, 2);
  if (!node.has_third_derivative()) return;
  const ThirdDerivative t = h * h * h * node.third_derivative;
  d[hermite_index(2, 1, 0)] = t[kThirdIndex[0][0][1]];
  d[hermite_index(2, 0, 1)] = t[kThirdIndex[0][0][2]];
  d[hermite_index(1, 2, 0)] = t[kThirdIndex[0][1][1]];
  d[hermite_index(1, 1, 1)] = t[kThirdIndex[0][1][2]];
  d[hermite_index(1, 0, 2)] = t[kThirdIndex[0][2][2]];
  d[hermite_index(0, 2, 1)] = t[kThirdIndex[1][1][2]];
  d[hermite_index(0, 1, 2)] = t[kThirdIndex[1][2][2]];
}

/// A node whose missing derivatives are to be filled in.
struct Incomplete {
  std::int32_t node = 0;
  /// Derivatives with a + b + c up to this are known.
  int known = 2;
  std::array<Stencil, 3> stencils;
  /// Whether a stencil may differ from the earlier one.
  bool is_anew = true;
};

constexpr int total_of(int entry) { return entry / 9 + entry / 3 % 3 + entry % 3; }
constexpr int kMostTotal = 6;
constexpr unsigned kAllTotals = ~0U;

/// Which data of a node have changed: bit t stands for the derivatives with a + b + c = t.
unsigned changes(const HermiteNode& a, const HermiteNode& b) {
  unsigned mask = 0;
  for (int entry = 0; entry < 27; ++entry) {
    // Compare the bits, so that 0 and −0 differ.
    if (std::memcmp(a.of + entry, b.of + entry, sizeof(double)) != 0) mask |= 1U << total_of(entry);
  }
  return mask;
}

/// Fills in the missing derivatives of a grid, from the lower ones at other nodes. They keep their
/// earlier values where nothing has changed on which they depend.
/// @param changed What has changed at each node and inserted point; the missing totals are added.
/// @param before The earlier data of each node; null: there are none.
void fill_missing(const std::vector<Incomplete>& nodes,
                  const std::vector<const HermiteNode*>& before, std::vector<unsigned>& changed,
                  std::vector<HermiteNode>& data) {
  for (int total = 1; total <= kMostTotal; ++total) {
    const unsigned lower_bit = 1U << (total - 1);
    for (const Incomplete& to_fill : nodes) {
      if (total <= to_fill.known) continue;
      const HermiteNode* old = before[to_fill.node];
      bool is_anew = to_fill.is_anew || old == nullptr;
      for (const Stencil& stencil : to_fill.stencils) {
        for (int j = 0; j < stencil.size && stencil.size > 1 && !is_anew; ++j) {
          is_anew = (changed[stencil.nodes[j]] & lower_bit) != 0;
        }
      }
      if (!is_anew) continue;
      bool has_changed = false;
      for (int a = 0; a <= 2; ++a) {
        for (int b = 0; b <= 2; ++b) {
          const int c = total - a - b;
          if (c < 0 || c > 2) continue;
          const int index = hermite_index(a, b, c);
          double& entry = data[to_fill.node].of[index];
          const Order order{a, b, c};
          double sum = 0;
          int num_axes = 0;
          for (int axis = 0; axis < 3; ++axis) {
            const Stencil& stencil = to_fill.stencils[axis];
            if (order[axis] == 0 || stencil.size == 1) continue;
            Order lower = order;
            --lower[axis];
            const int of_lower = hermite_index(lower[0], lower[1], lower[2]);
            for (int j = 0; j < stencil.size; ++j) {
              sum += stencil.weights[j] * data[stencil.nodes[j]].of[of_lower];
            }
            ++num_axes;
          }
          entry = num_axes > 0 ? sum / num_axes : 0;
          has_changed = has_changed || old == nullptr ||
                        std::memcmp(&entry, old->of + index, sizeof entry) != 0;
        }
      }
      if (has_changed) changed[to_fill.node] |= 1U << total;
    }
  }
}

/// The earlier data of each node; null: there are none.
std::vector<const HermiteNode*> data_before(std::size_t num_nodes, const HermiteBefore* before,
                                            const std::vector<HermiteNode>* data) {
  std::vector<const HermiteNode*> of_node(num_nodes, nullptr);
  if (before == nullptr || data->size() != before->growth.nodes.size()) return of_node;
  for (std::size_t n = 0; n < data->size(); ++n) {
    of_node[before->growth.nodes[n]] = data->data() + n;
  }
  return of_node;
}

}  // namespace

std::vector<HermiteNode> hermite_data(const CheckPointGrid& grid,
                                      const std::vector<ConfigurationSummary>& configurations,
                                      const HermiteDataOptions& options,
                                      const HermiteBefore* before, HermiteMemory* memory) {
  const auto num_nodes = static_cast<std::size_t>(grid.num_nodes());
  std::vector<HermiteNode> data(num_nodes);
  if (memory != nullptr) *memory = {};
  if (!grid.any_usable()) return data;
  const auto first = data_before(num_nodes, before, before ? &before->memory.first : nullptr);
  StencilFinder finder(grid, options, before ? &before->growth : nullptr);
  std::vector<unsigned> changed(num_nodes, kAllTotals);
  std::vector<Incomplete> nodes;
  for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
    if (!grid.is_free(n) && (grid.usable(n) || options.extrapolated_nodes)) {
      const NodeData known = node_data(grid, configurations, n, options.third_derivatives);
      if (grid.usable(n) && first[n] != nullptr) data[n] = *first[n];
      fill_known(known, grid.spacing(), options.known, data[n].of);
      if (grid.usable(n)) {
        Incomplete& node = nodes.emplace_back();
        node.node = n;
        node.known = known.has_third_derivative() ? 3 : options.known;
        finder.begin();
        for (int axis = 0; axis < 3; ++axis) node.stencils[axis] = finder.find(n, axis, false);
        node.is_anew = finder.has_met_change();
      }
    }
    if (first[n] == nullptr) continue;
    changed[n] = changes(data[n], *first[n]);
    // Missing derivatives are compared when they are filled in.
    if (!nodes.empty() && nodes.back().node == n) changed[n] &= (2U << nodes.back().known) - 1;
  }
  std::vector<unsigned> of_second = changed;
  fill_missing(nodes, first, changed, data);
  if (memory != nullptr) memory->first = data;

  // Do it once more with inserted points, whose data follow from the present ones.
  for (Incomplete& node : nodes) {
    finder.begin();
    for (int axis = 0; axis < 3; ++axis) {
      Stencil& stencil = node.stencils[axis];
      if (stencil.size < options.most) stencil = finder.find(node.node, axis, true);
    }
    node.is_anew = node.is_anew || finder.has_met_change();
  }
  const bool has_inserted = !finder.inserted().empty();
  const bool had_inserted = before != nullptr && !before->memory.inserted.empty();
  const auto second = data_before(num_nodes, has_inserted == had_inserted ? before : nullptr,
                                  before ? &before->memory.second : nullptr);
  if (has_inserted) {
    std::map<CheckPoint, HermiteNode> inserted;
    for (const StencilFinder::Inserted& point : finder.inserted()) {
      const CellTree::Leaf& leaf = grid.leaf(point.place.leaf);
      const auto [here, is_new] = inserted.try_emplace(point.check_point);
      const auto old = had_inserted ? before->memory.inserted.find(point.check_point)
                                    : std::map<CheckPoint, HermiteNode>::const_iterator();
      const bool is_known = had_inserted && old != before->memory.inserted.end();
      if (is_new) {
        const bool is_same = is_known && !point.is_anew &&
                             std::all_of(leaf.corners.begin(), leaf.corners.end(),
                                         [&](std::int32_t corner) { return changed[corner] == 0; });
        here->second = is_same ? old->second : hermite_node_at(data.data(), leaf, point.place.s);
      }
      of_second.push_back(is_known ? changes(here->second, old->second) : kAllTotals);
    }
    // Add the points only after the loop, in which the leaves have the data of nodes alone.
    for (const StencilFinder::Inserted& point : finder.inserted()) {
      data.push_back(inserted.at(point.check_point));
    }
    for (const Incomplete& node : nodes) {
      if (second[node.node] == nullptr) continue;
      const HermiteNode known = std::exchange(data[node.node], *second[node.node]);
      for (int entry = 0; entry < 27; ++entry) {
        if (total_of(entry) <= node.known) data[node.node].of[entry] = known.of[entry];
      }
    }
    fill_missing(nodes, second, of_second, data);
    data.resize(num_nodes);
    if (memory != nullptr) memory->inserted = std::move(inserted);
  } else {
    for (std::size_t n = 0; n < num_nodes; ++n) {
      of_second[n] = second[n] != nullptr ? changes(data[n], *second[n]) : kAllTotals;
    }
  }
  if (memory != nullptr) memory->second = data;

  const auto final = data_before(num_nodes, before, before ? &before->data : nullptr);
  const auto& hanging_nodes =
      options.extrapolated_nodes ? grid.hanging_nodes() : grid.hanging_on_complete();
  for (const CheckPointGrid::HangingNode& hanging : hanging_nodes) {
    const CellTree::Leaf& leaf = grid.leaf(hanging.leaf);
    const HermiteNode* old = final[hanging.node];
    const bool is_same = old != nullptr && !finder.is_anew(hanging.node) &&
                         std::all_of(leaf.corners.begin(), leaf.corners.end(),
                                     [&](std::int32_t corner) { return of_second[corner] == 0; });
    data[hanging.node] = is_same ? *old : hermite_node_at(data.data(), leaf, hanging.s);
    of_second[hanging.node] = old != nullptr ? changes(data[hanging.node], *old) : kAllTotals;
  }
  return data;
}

}  // namespace palpate
