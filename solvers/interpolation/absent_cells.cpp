// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/absent_cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "interpolation/cell_tree.h"

namespace palpate {
namespace {

double half_diagonal(const Grid& grid, const Cell& cell) {
  return 0.5 * std::sqrt(3.0) * cell.side * grid.spacing();
}

Vec3 centre(const Grid& grid, const Cell& cell) {
  return grid.place(cell.first) + Vec3::Constant(0.5 * cell.side * grid.spacing());
}

class AbsentCells {
 public:
  AbsentCells(const Grid& grid, const Clearance& clearance,
              const std::vector<std::int32_t>& present, std::vector<std::int32_t>& cells)
      : grid_(grid),
        clearance_(clearance),
        num_(grid.coarsest_resolution() - 1),
        smallest_(std::max(grid.coarsest / kAbsentParts, 1)),
        cells_(cells),
        nearest_(cells.size(), -1) {
    for (std::int32_t root : present) nearest_[root] = root;
    find_nearest(present);
  }

  void fill() {
    for (std::size_t root = 0; root < nearest_.size(); ++root) {
      if (is_absent(root)) cells_[root] = touching(root);
    }
    if (!clearance_ || num_ == 0) return;
    Cell box{{-grid_.reach(), -grid_.reach(), -grid_.reach()}, grid_.coarsest};
    while (box.side < 2 * grid_.reach()) box.side *= 2;
    prove(box);
  }

 private:
  using Index = std::array<std::int32_t, 3>;

  [[nodiscard]] bool is_absent(std::size_t root) const {
    return nearest_[root] != static_cast<std::int32_t>(root);
  }
  /// The entry for places that are not proved free: it refers to the nearest existing root cell.
  [[nodiscard]] std::int32_t touching(std::size_t root) const {
    return ~(CellTree::kNearestRoot + std::max(nearest_[root], 0));
  }
  [[nodiscard]] Index index_of(std::int32_t root) const {
    return {root / (num_ * num_), root / num_ % num_, root % num_};
  }
  [[nodiscard]] std::int32_t root_at(const Index& i) const {
    return (i[0] * num_ + i[1]) * num_ + i[2];
  }

  // Root cells pass their nearest existing cell on to their neighbours, until none gets a nearer
  // one.
  void find_nearest(std::vector<std::int32_t> changed) {
    std::vector<std::int32_t> distances2(nearest_.size(), std::numeric_limits<std::int32_t>::max());
    for (std::int32_t root : changed) distances2[root] = 0;
    while (!changed.empty()) {
      std::vector<std::int32_t> next;
      for (std::int32_t root : changed) {
        const std::int32_t offered = nearest_[root];
        const Index at = index_of(root);
        const Index of_offered = index_of(offered);
        for (int side = 0; side < 6; ++side) {
          Index beside = at;
          std::int32_t& i = beside[side / 2];
          i += side % 2 == 0 ? -1 : 1;
          if (i < 0 || i >= num_) continue;
          const std::int32_t other = root_at(beside);
          std::int32_t distance2 = 0;
          for (int k = 0; k < 3; ++k) {
            distance2 += (beside[k] - of_offered[k]) * (beside[k] - of_offered[k]);
          }
          if (distance2 >= distances2[other]) continue;
          distances2[other] = distance2;
          nearest_[other] = offered;
          next.push_back(other);
        }
      }
      changed = std::move(next);
    }
  }

  /// Finds the free parts of a cube of root cells, some of which may lie outside the box.
  void prove(const Cell& cube) {
    Index first;
    Index end;
    for (int k = 0; k < 3; ++k) {
      first[k] = (cube.first[k] + grid_.reach()) / grid_.coarsest;
      end[k] = std::min(first[k] + cube.side / grid_.coarsest, num_);
      if (first[k] >= num_) return;
    }
    if (cube.side == grid_.coarsest) {
      const std::int32_t root = root_at(first);
      if (is_absent(root)) cells_[root] = part(cube, touching(root));
      return;
    }
    const double c = clearance_(centre(grid_, cube));
    const double r = half_diagonal(grid_, cube);
    if (c <= -r) return;
    if (!(c > r)) {
      const Cell half{cube.first, cube.side / 2};
      for (int child = 0; child < 8; ++child) prove({corner_of(half, child), half.side});
      return;
    }
    for (Index i = first; i[0] < end[0]; ++i[0]) {
      for (i[1] = first[1]; i[1] < end[1]; ++i[1]) {
        for (i[2] = first[2]; i[2] < end[2]; ++i[2]) {
          const std::int32_t root = root_at(i);
          if (is_absent(root)) cells_[root] = ~CellTree::kFree;
        }
      }
    }
  }

  /// The entry for a part of an absent root cell.
  [[nodiscard]] std::int32_t part(const Cell& cell, std::int32_t touching) {
    const double c = clearance_(centre(grid_, cell));
    const double r = half_diagonal(grid_, cell);
    if (c > r) return ~CellTree::kFree;
    // The centres of the smallest parts are at most r − s from this centre, so one of them may be
    // free.
    const double s = half_diagonal(grid_, {cell.first, smallest_});
    if (!(c + (r - s) > s)) return touching;
    const Cell half{cell.first, cell.side / 2};
    std::array<std::int32_t, 8> parts{};
    for (int i = 0; i < 8; ++i) parts[i] = part({corner_of(half, i), half.side}, touching);
    if (parts[0] < 0 && std::count(parts.begin(), parts.end(), parts[0]) == 8) return parts[0];
    cells_.insert(cells_.end(), parts.begin(), parts.end());
    return static_cast<std::int32_t>(cells_.size()) - 8;
  }

  const Grid& grid_;
  const Clearance& clearance_;
  /// The number of root cells along an axis.
  const std::int32_t num_;
  const std::int32_t smallest_;
  std::vector<std::int32_t>& cells_;
  /// By root cell: the nearest existing one; −1: there is none.
  std::vector<std::int32_t> nearest_;
};

}  // namespace

bool is_proved_free(const Grid& grid, const Clearance& clearance, const Cell& cell) {
  return clearance && clearance(centre(grid, cell)) > half_diagonal(grid, cell);
}

void fill_absent_cells(const Grid& grid, const Clearance& clearance,
                       const std::vector<std::int32_t>& present, std::vector<std::int32_t>& cells) {
  AbsentCells(grid, clearance, present, cells).fill();
}

}  // namespace palpate
