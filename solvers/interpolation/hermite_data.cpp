// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/hermite_data.h"

#include <algorithm>
#include <array>
#include <cmath>

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
  StencilFinder(const CheckPointGrid& grid, const std::vector<ConfigurationSummary>& configurations,
                const HermiteDataOptions& options)
      : grid_(grid),
        links_(find_links(grid)),
        most_(options.most),
        fewer_in_short_rows_(options.fewer_in_short_rows) {
    for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
      marked_.push_back(grid.usable(n) &&
                        (configurations[grid.configuration(n)].flags & kMarking) != 0);
    }
  }

  [[nodiscard]] Stencil find(std::int32_t node, int axis, bool with_inserted) {
    Row row;
    row.nodes[kMiddle] = node;
    const CheckPoint origin = grid_.tree().point(node);
    std::array<bool, 2> ends_in_leaf{};
    for (int up = 0; up < 2; ++up) {
      for (std::int32_t n = node; row.count[up] + 1 < most_;) {
        n = links_[n][axis][up];
        ends_in_leaf[up] = n < 0;
        if (n < 0 || !grid_.usable(n) || (marked_[n] && !marked_[node])) break;
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

  /// The places of the inserted points, which are numbered after the nodes.
  [[nodiscard]] const std::vector<CellTree::Place>& inserted() const { return inserted_; }

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
    if (node >= 0) return grid_.usable(node) ? node : -1;
    const std::int32_t reach = grid_.reach();
    if (std::any_of(p.begin(), p.end(), [&](std::int32_t x) { return std::abs(x) > reach; })) {
      return -1;
    }
    const CellTree::Place place =
        grid_.tree().locate(Vec3(p[0] + reach, p[1] + reach, p[2] + reach));
    if (place.leaf >= CellTree::kFree || !grid_.is_complete(place.leaf)) return -1;
    inserted_.push_back(place);
    return grid_.num_nodes() + static_cast<std::int32_t>(inserted_.size()) - 1;
  }

  const CheckPointGrid& grid_;
  const std::vector<Links> links_;
  /// Whether the configuration of a node is marked, by node.
  std::vector<bool> marked_;
  const int most_;
  const bool fewer_in_short_rows_;
  std::vector<CellTree::Place> inserted_;
};

void fill_known(const NodeData& node, double h, double* d) {
  d[hermite_index(0, 0, 0)] = node.energy;
  d[hermite_index(1, 0, 0)] = h * node.force[0];
  d[hermite_index(0, 1, 0)] = h * node.force[1];
  d[hermite_index(0, 0, 1)] = h * node.force[2];
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
};

void fill_missing(const std::vector<Incomplete>& nodes, std::vector<HermiteNode>& data) {
  for (int total = 3; total <= 6; ++total) {
    for (int a = 0; a <= 2; ++a) {
      for (int b = 0; b <= 2; ++b) {
        const int c = total - a - b;
        if (c < 0 || c > 2) continue;
        const Order order{a, b, c};
        for (const Incomplete& to_fill : nodes) {
          if (total <= to_fill.known) continue;
          double sum = 0;
          int num_axes = 0;
          for (int axis = 0; axis < 3; ++axis) {
            const Stencil& stencil = to_fill.stencils[axis];
            if (order[axis] == 0 || stencil.size == 1) continue;
            Order lower = order;
            --lower[axis];
            const int entry = hermite_index(lower[0], lower[1], lower[2]);
            for (int j = 0; j < stencil.size; ++j) {
              sum += stencil.weights[j] * data[stencil.nodes[j]].of[entry];
            }
            ++num_axes;
          }
          if (num_axes > 0) data[to_fill.node].of[hermite_index(a, b, c)] = sum / num_axes;
        }
      }
    }
  }
}

}  // namespace

std::vector<HermiteNode> hermite_data(const CheckPointGrid& grid,
                                      const std::vector<ConfigurationSummary>& configurations,
                                      const HermiteDataOptions& options) {
  const auto num_nodes = static_cast<std::size_t>(grid.num_nodes());
  std::vector<HermiteNode> data(num_nodes);
  if (!grid.any_usable()) return data;
  StencilFinder finder(grid, configurations, options);
  std::vector<Incomplete> nodes;
  for (std::int32_t n = 0; n < grid.num_nodes(); ++n) {
    if (grid.is_free(n) || (!grid.usable(n) && !options.extrapolated_nodes)) continue;
    const NodeData known = node_data(grid, configurations, n, options.third_derivatives);
    fill_known(known, grid.spacing(), data[n].of);
    if (!grid.usable(n)) continue;
    Incomplete& node = nodes.emplace_back();
    node.node = n;
    node.known = known.has_third_derivative() ? 3 : 2;
    for (int axis = 0; axis < 3; ++axis) node.stencils[axis] = finder.find(n, axis, false);
  }
  fill_missing(nodes, data);

  // Do it once more with inserted points, whose data follow from the present ones.
  for (Incomplete& node : nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      Stencil& stencil = node.stencils[axis];
      if (stencil.size < options.most) stencil = finder.find(node.node, axis, true);
    }
  }
  if (!finder.inserted().empty()) {
    for (const CellTree::Place& place : finder.inserted()) {
      data.push_back(hermite_node_at(data.data(), grid.leaf(place.leaf), place.s));
    }
    fill_missing(nodes, data);
    data.resize(num_nodes);
  }

  const auto& hanging_nodes =
      options.extrapolated_nodes ? grid.hanging_nodes() : grid.hanging_on_complete();
  for (const CheckPointGrid::HangingNode& hanging : hanging_nodes) {
    data[hanging.node] = hermite_node_at(data.data(), grid.leaf(hanging.leaf), hanging.s);
  }
  return data;
}

}  // namespace palpate
